"""Which loops of a drawing are worth their vertices: the decimation that keeps a number of vertices in any case.

Loops may be filled or joined, the cheapest ones first. Line cycles know what each number of vertices around each
outline costs, so the best split of the vertices over the tree of these choices is a knapsack.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from ...errors import Fault, InvalidMeshError, NestedCagesError, NestingError, note
from ...geometry.arrays import FloatArray
from ...geometry.convex_hull import convex_hull
from ...geometry.group import Symmetry
from ...geometry.mesh import Mesh
from ...geometry.solids import overlay
from ...parameters import check_part
from ...tasks import Stage, drain
from ..base import NOTHING_KEPT, Count, Decimation, KeepingStarts, Kept, SeveralStarts, Start, in_words
from ..budget import LEAST_PER_LOOP
from ..line_cycles import LineCycles
from ..line_cycles.least_areas import least_areas
from .joining import Joins, WorkLeft
from .knapsack import Tree
from .parts import Hole, Kind, OpenRegion, open_regions, outermost_parts, outlines

COMFORTABLE = 0.05
"""Excess with all loops up to which no others are looked for: none could make the cage smaller by more than that."""

VERTICES_PER_LOOP = 2
"""Of the cage, for each loop that is looked at: with more loops than that, the cheapest to lose are lost at once."""

LOST_AT_ONCE = 4
"""Part of the loops to lose, 1 in this many, that are lost before the others are looked at again."""

PRICES = (0.0, 0.1, 1.0)
"""Of each loop, in parts of the least excess, at which loops are chosen again where the first choice has no cage: loops
close to each other cross, which their costs do not show."""

WORTHWHILE = 0.5
"""Part of the excess below which a choice of loops is named in a note."""

MOST_JOINS = 24
"""Joins that are looked at beyond those."""

JOINED_AT_ONCE = 16
"""Part of the loops, 1 in this many, that are joined before the others are looked at again."""

WORTH_OF_A_LOOP = 3.0
"""Area saved by losing a loop, at most, in parts of what it costs: k vertices cost about c / k², and k more elsewhere
save about 2 c / k²."""


@dataclass(frozen=True)
class FewerLoops:
    """Meshes that never have more vertices than asked for, with all loops where that costs little area."""

    decimation: Decimation = field(default_factory=LineCycles)
    """Makes the mesh around the drawing with the loops chosen."""

    def __post_init__(self) -> None:
        check_part(self, "decimation", "decimate", "LineCycles()")

    @property
    def on_curve(self) -> bool:
        """Whether the start comes with a mesh on the fine one, from which the flow leads to a cage."""
        return bool(getattr(self.decimation, "on_curve", False))

    @property
    def outside(self) -> FewerLoops:
        """The same without meshes on the curve."""
        return replace(self, decimation=getattr(self.decimation, "outside", self.decimation))

    def fewest(self, fine: Mesh, most: int, area: float) -> Stage[float, int | None]:
        """About how many vertices a mesh of at most an area needs with all loops; None if more than most."""
        method = self.decimation if isinstance(self.decimation, LineCycles) else LineCycles()
        return (yield from method.fewest(fine, most, area))

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """The mesh of least area; see `starts`."""
        return drain(self.starts(fine, count, clearance=clearance))[0].coarse

    def starts(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Stage[float, list[Start]]:
        """See `starts_keeping`."""
        return (yield from self.starts_keeping(fine, count, NOTHING_KEPT, clearance=clearance))

    def starts_keeping(
        self, fine: Mesh, count: Count, kept: Kept, *, clearance: float = 0.0
    ) -> Stage[float, list[Start]]:
        """Meshes that enclose the shape, with all loops where that is best. Raises NestingError."""
        if not isinstance(count, int | np.integer) or len(fine.loops) == 1:
            return (yield from self._starts(fine, count, kept, clearance))
        usual: list[Start] = []
        failure: NestedCagesError | None = None
        if count >= LEAST_PER_LOOP * len(fine.loops):
            try:
                usual = yield from self._starts(fine, count, kept, clearance)
            except NestingError as error:
                failure = error
        lost = usual[0].coarse.area - fine.area if usual else np.inf
        if usual and min(lost, _most_saved(fine, usual[0].coarse)) <= COMFORTABLE * fine.area:
            return usual
        symmetry, kept = kept.symmetry, replace(kept, preferred=None)
        choice, chosen = LoopChoice(fine, int(count), replace(kept, symmetry=None), clearance), self.outside
        yield from choice.look(lost)
        for shape in choice.shapes(is_needed=not usual):
            for less in range(1 if symmetry is None else symmetry.order):  # pairs of loops have even numbers
                try:
                    outline = _with_images(shape, symmetry)
                    number = min(count, len(outline.vertices)) - less
                    found = yield from chosen._starts(outline, number, kept, clearance)
                except (NestingError, InvalidMeshError) as error:
                    failure = error
                else:
                    return min(usual or found, found, key=lambda starts: starts[0].coarse.area)
        if not usual:
            raise failure or NestingError("No loops were found for this few vertices.", code="count.too_small")
        return usual

    def _starts(self, shape: Mesh, count: Count, kept: Kept, clearance: float) -> Stage[float, list[Start]]:
        method = self.decimation
        if isinstance(method, KeepingStarts):
            return (yield from method.starts_keeping(shape, count, kept, clearance=clearance))
        if isinstance(method, SeveralStarts):
            return (yield from method.starts(shape, count, clearance=clearance))
        return [Start(method.decimate(shape, count, clearance=clearance), in_words(method))]


def _most_saved(fine: Mesh, coarse: Mesh) -> float:
    """About the most area that fewer loops save: all that lie in holes may go, but others only by a few joins."""
    if len(coarse.loops) != len(fine.loops):  # some methods of decimation change them
        return np.inf
    costs = WORTH_OF_A_LOOP * np.abs(coarse.loop_areas - fine.loop_areas)
    outermost = fine.parent_of_loop < 0
    return float(costs[~outermost].sum() + np.sort(costs[outermost])[-2 * MOST_JOINS :].sum())


def _with_images(shape: Mesh, symmetry: Symmetry | None) -> Mesh:
    """A shape with its images under a symmetry. Raises InvalidMeshError."""
    if symmetry is None:
        return shape
    return overlay([shape.moved(symmetry.image(shape.vertices, k)).validated() for k in range(symmetry.order)])


class Move(NamedTuple):
    """A hole to fill, or parts to join."""

    added: float
    """Area that it adds."""
    saved: int
    """Loops that it saves."""
    apply: Callable[[], None]
    touched: Sequence[object]
    """The outlines and lists of holes that it changes."""
    made: Kind | None
    """The outline that a join makes."""


class LoopChoice:
    """The choice of loops around one drawing."""

    def __init__(self, fine: Mesh, count: int, kept: Kept, clearance: float) -> None:
        self.fine, self.count, self.kept, self.clearance = fine, count, kept, clearance
        self.parts = outermost_parts(fine)
        self.all_loops = set(outlines(self.parts))
        self.filled = 0.0
        """Area of the holes that are filled at once."""
        self.joins: dict[int, Joins] = {}
        """Of each region, by the identity of its hole."""
        self.work = WorkLeft()
        self.missing: NestedCagesError | None = None
        """The error that shapely is missing, without which parts are not joined."""

    def look(self, most: float, at: int | None = None) -> Stage[float, None]:
        """Learn what outlines cost, if some may be worth it: most is the area that a cage with all loops adds.

        at: number of vertices for which they are, if fewer than the count.
        """
        if most < np.inf and min((move.added for move in self._moves()), default=np.inf) >= most:
            return
        self._reduce()
        if self.work.left < 0:
            return
        yield from self._search(list(outlines(self.parts)))
        left = MOST_JOINS
        while left > 0:
            before = [each.added for each in outlines(self.parts)]
            sunk, at_once = self.filled + sum(before), min(left, max(1, len(before) // JOINED_AT_ONCE))
            least = min(most, float(self.costs()[: (self.count if at is None else at) + 1].min()))
            made, gone = list[Kind](), set[int]()
            for move in sorted(self._joining(), key=lambda move: move.added)[:at_once]:
                touched = {id(each) for each in move.touched}
                if sunk + move.added >= least or move.made is None or gone & touched:
                    break
                move.apply()
                made.append(move.made)
                sunk, gone = sunk + move.added, gone | touched
            if not made:
                break
            left -= len(made)
            yield from self._search(made)

    def shapes(self, *, is_needed: bool) -> Iterator[Mesh]:
        """Shapes around the drawing with fewer loops, the best one first; the convex hull last where one is needed.

        Raises NestedCagesError where parts must be joined and shapely is missing.
        """
        least, kept = self._best()
        chosen = [kept]
        for price in PRICES if is_needed else ():
            kept = self._best(price * least)[1]
            chosen += [kept] if kept not in chosen else []
        for kept in chosen:
            if kept and set(kept) != self.all_loops:
                try:
                    shape = Mesh.from_loops([each.ring for each in kept])
                except InvalidMeshError:  # outlines that touch
                    continue
                yield shape
        if is_needed:
            if self.missing is not None:
                raise self.missing
            yield Mesh.from_loops([self.fine.vertices[convex_hull(self.fine.vertices)]])

    def costs(self) -> FloatArray:
        """(K,) about the least area that a cage of 0, 1, … vertices adds."""
        return np.asarray(self.filled + Tree(self.count).of_parts(self.parts).least)

    def _best(self, price: float = 0.0) -> tuple[float, list[Kind]]:
        """The least area that is added at a price of each loop, and the outlines to keep; none if not known."""
        tree = Tree(self.count, price).of_parts(self.parts)
        count = int(tree.least.argmin())
        least = float(tree.least[count])
        return least, tree.chosen(count) if np.isfinite(least) else []

    def _reduce(self) -> None:
        """Lose the cheapest loops until there are few enough to look at, or no work is left for joins."""
        most = max(1, self.count // VERTICES_PER_LOOP)
        while (excess := sum(part.size for part in self.parts) - most) > 0:
            left, gone = max(1, excess // LOST_AT_ONCE), set[int]()
            for move in sorted(self._moves(), key=lambda move: move.added / move.saved):
                touched = {id(each) for each in move.touched}
                if left > 0 and not gone & touched:
                    move.apply()
                    left -= move.saved
                    gone |= touched
            if not gone:
                break

    def _moves(self) -> Iterator[Move]:
        """All that may be done next."""
        for region in list(open_regions(self.parts)):
            if (hole := region.hole) is not None:
                touched = region.siblings, hole, *hole.parts
                yield Move(hole.open_area, hole.size, partial(self._fill, region), touched, None)
        yield from self._joining()

    def _joining(self) -> Iterator[Move]:
        """The joins that may be done next."""
        for region in list(open_regions(self.parts)) if self.missing is None else ():
            if len(region.parts) < (2 if region.hole is None else 1):
                continue
            try:
                joins = self.joins.get(id(region.hole)) or self.joins.setdefault(
                    id(region.hole), Joins(region, self.work)
                )
            except NestedCagesError as error:
                self.missing = error
                return
            joins.siblings = region.siblings
            for made in joins.candidates():
                before: tuple[Kind, ...] = made.joined
                if isinstance(made, Hole) and made.before is not None:
                    before += (made.before,)
                added = made.added - sum(each.added for each in before)
                touched = *before, *(part.holes for part in made.joined)
                yield Move(added, len(before) - 1, partial(joins.apply, made), touched, made)

    def _fill(self, region: OpenRegion) -> None:
        """Fill the hole of a region for good."""
        assert region.hole is not None
        self.filled += region.hole.open_area
        region.siblings[:] = [hole for hole in region.siblings if hole is not region.hole]

    def _search(self, some: Sequence[Kind]) -> Stage[float, None]:
        """Search around some of the outlines, next to all that are there now."""
        every = list(outlines(self.parts))
        try:
            mesh = Mesh.from_loops([each.ring for each in every])
        except InvalidMeshError:  # outlines that touch: what is known suffices
            return
        total = min(max(self.count, LEAST_PER_LOOP * len(every)), len(mesh.vertices))
        numbers = [every.index(each) for each in some]
        found = yield from least_areas(mesh, total, self.kept, numbers, self.clearance)
        for k, areas in found.items():
            every[k].table = areas


def advice(fine: Mesh, cage: Mesh) -> tuple[Fault, ...]:
    """A note where keeping all loops costs a lot of area, and choosing them much less."""
    excess = cage.area / fine.area - 1.0
    if len(fine.loops) == 1 or len(cage.loops) < len(fine.loops):
        return ()
    try:
        mesh = FewerLoops(LineCycles(on_curve=False)).decimate(fine, len(cage.vertices))
    except NestedCagesError:
        return ()
    fewer = mesh.area / fine.area - 1.0
    if fewer > WORTHWHILE * excess:
        return ()
    loops = {"wanted": len(fine.loops), "given": len(mesh.loops)}
    return (note("note.loops", on="keep", excess=excess, better=fewer, **loops),)
