"""The search for cycles around all loops of an outline: lines of each loop, how many each gets, and crossings."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from ...errors import InvalidMeshError
from ...geometry.arrays import FloatArray, IntArray
from ...geometry.loops import Loops
from ...geometry.mesh import Mesh
from ...geometry.precision import MOST_ROUNDS, NEGLIGIBLE
from ...tasks import Stage
from ..alike import AsymmetricError, padded_alike
from ..base import REACH
from ..budget import LEAST_PER_LOOP
from ..hull.narrow_gaps import HULL_OFFSET
from ..request import Request
from .candidates import Obstacles, candidates
from .chain import Chain, Lines, without_doubles
from .crossings import Choice, Search, again
from .loop_search import LoopSearch, NoCyclesError, allocation
from .places import NormalFrame, places, weights
from .shortest_cycles import Paths
from .turns import SLACK

if TYPE_CHECKING:
    from .images import Images

PLACES_PER_VERTEX, LEAST_PLACES, LEAST_PLACES_OF_A_LOOP = 3.0, 96, 12
"""Places: per vertex of the cage; at least, in all; at least, for each loop (docs/ablation.md: line cycles: places)."""

LONGEST_STRETCH = 3.0
"""Length of the longest stretches that have tangents, in mean edges of the cage."""

FULL_SEARCH = 200_000
"""Lines around a loop times edges of its cage squared, up to which a line may be followed by any other: pockets of
spirals hold most of the lines, so that narrower searches made more vertices worse."""

FOLLOWING, SPARE_FOLLOWING = 3.0, 8
"""Otherwise it is followed by a line within this many mean edges of the cage, and this many lines."""

USUAL_SHARE, MAX_SHARE, SPARE_SHARE = 1.2, 2.0, 8
"""Lines of a loop: likely ones per deserved one; largest number per likely one, and beyond that."""

MOST_OF_ALL = 0.5
"""Lines per vertex of the outline from which each loop may have any number."""

FEW_LINES = 12
"""Number of lines of each of several loops that is sought in any case, to know the least."""


def together(searches: Sequence[Iterator[list[Paths]]]) -> Iterator[None]:
    """Run what searches around several loops ask for, all at once. Yields in between."""
    while searches:
        asked = [(search, wanted) for search in searches if (wanted := next(search, None)) is not None]
        Paths.run_all([paths for _, wanted in asked for paths in wanted])
        yield
        searches = [search for search, _ in asked]


class Around:
    """A search for cycles around all loops of an outline."""

    def __init__(
        self, request: Request, outline: Loops, shift: FloatArray | float, only: Collection[int] | None = None
    ) -> None:
        """outline: as symmetric as what is kept; shift: of lines from their loops, one for all or each (L,), in
        diameters; a clearance is kept from all loops. only: loops to search around, for `least_areas` alone."""
        self.request, self.kept, self.only = request, request.kept, only
        self.shift = np.broadcast_to(shift, len(outline.sizes))
        self.frame = NormalFrame.of(outline)
        self.images: Images | None = None
        if self.kept.symmetry is not None:
            from .images import Images

            self.images = Images.of(outline, self.kept.symmetry, self.frame)
        self.chains = self._chains(outline)
        self.outline = outline.moved(self.frame.into(outline.vertices))
        self.searches: dict[int, Search] = {}
        """Of each loop that stands for its images."""
        self.rounds = 0
        self.few_turns = False

    def run(self, bias: float) -> Stage[float, tuple[float, Mesh]]:
        """Area and mesh. Raises NoCyclesError."""
        loops = len(self.outline.sizes) + 1
        if not self.searches:
            for _ in self._search(known=self.request.per_loop is not None or len(self.chains) == 1):
                yield len(self.searches) / loops
        searches = {loop: again(search) for loop, search in self.searches.items()}
        self.rounds = 0
        numbers = self._shares(searches)
        for _ in range(MOST_ROUNDS):
            for _ in together([searches[loop].refine(number) for loop, number in numbers.items()]):
                yield len(searches) / loops
            numbers = self._shares(searches)
            choice = Choice.of(searches, numbers, self.images)
            i, j = choice.crossings()
            if len(i) == 0:
                break
            self.rounds += 1
            from .giving_way import give_way  # most cycles do not cross

            changed = give_way(searches, choice, i, j, bias)
            for _ in together([searches[k].solve(int(searches[k].cycle(numbers[k])[0])) for k in changed]):
                yield len(searches) / loops
            numbers = self._shares(searches)
        return self._mesh(choice)

    def fewest(self, area: float) -> Stage[float, int | None]:
        """The fewest lines that enclose at most an area, in the input's units, crossings aside; None if not enough.

        One search knows all numbers of lines up to the wanted one.
        """
        for _ in self._search():
            yield len(self.searches) / (len(self.outline.sizes) + 1)
        totals, room = [search.totals for search in self.searches.values()], area / self.frame.scale**2
        low, high = LEAST_PER_LOOP * len(totals) - 1, self.request.target + 1
        while high - low > 1:
            middle = (low + high) // 2
            numbers = allocation(totals, middle, [1] * len(totals))
            more = sum(float(total[n]) for total, n in zip(totals, numbers or [], strict=bool(numbers)))
            if numbers and self.outline.area + more <= room:
                high = middle
            else:
                low = middle
        return high if high <= self.request.target else None

    def least_areas(self) -> Stage[float, dict[int, FloatArray]]:
        """For each loop with cycles, the least area beyond it for each number of lines, in the input's units."""
        with suppress(NoCyclesError):
            for _ in self._search():
                yield len(self.searches) / (len(self.outline.sizes) + 1)
        return {k: search.totals * self.frame.scale**2 for k, search in self.searches.items() if search.found}

    def _chains(self, outline: Loops) -> list[Chain]:
        """The loops in the frame of the search, with what matters there."""
        vertices, importance = self.frame.into(outline.vertices), self.kept.importance
        weights, pinned = np.ones(len(vertices)), np.zeros(len(vertices), bool)
        if importance is not None:
            weights, pinned = importance.at(outline.vertices), importance.pinned(outline)
        parts = [np.split(each, outline.begins[1:]) for each in (vertices, weights, pinned)]
        weighted = importance is not None and importance.weights is not None
        wanted = [rule.turn_limits for rule in self.kept.rules]
        limits = (
            max((short for short, _ in wanted), default=0.0) / self.frame.scale,
            max((s for _, s in wanted), default=0.0),
        )
        return [Chain(loop, some if weighted else None, pins, limits) for loop, some, pins in zip(*parts, strict=True)]

    def _copies(self, loop: int) -> int:
        """Lines of the cage for each one that is counted around a loop."""
        return 1 if self.images is None or self._is_halved(loop) else self.images.symmetry.order

    def _is_halved(self, loop: int) -> bool:
        """Whether a loop lies across the axis of a mirror."""
        return self.images is not None and self.images.symmetry.reverses and len(self.images.own[loop]) > 1

    def _shares(self, searches: dict[int, Search]) -> dict[int, int]:
        copies = [self._copies(loop) for loop in searches]
        totals = [number * search.totals for number, search in zip(copies, searches.values(), strict=True)]
        numbers = allocation(totals, self.request.target, copies)
        if numbers is None:
            least = [number * int(np.isfinite(total).argmax()) for number, total in zip(copies, totals, strict=True)]
            known = {"least": sum(least)} if all(least) and sum(least) > self.request.target else {}
            raise NoCyclesError(
                "There are no such cycles of lines.", code="count.too_small", total=self.request.total, **known
            )
        return dict(zip(searches, numbers, strict=True))

    def _search(self, *, known: bool = False) -> Iterator[None]:
        """Search around each loop that stands for its images, known: for the largest number of lines alone.

        Yields in between. Raises NoCyclesError.
        """
        target, chains = self.request.target, self.chains
        if any(chain.length == 0.0 for chain in chains):
            raise NoCyclesError("A loop is as small as round-off.", code="count.too_small")
        deserved = weights(chains, target)
        whole, length = sum(float(weight.sum()) for weight in deserved), sum(chain.length for chain in chains)
        found: dict[int, tuple[Lines, IntArray, float, float]] = {}
        for k in range(len(chains)) if self.only is None else self.only:
            chain, weight, shift = chains[k], deserved[k], float(self.shift[k])
            share = float(weight.sum()) / whole
            count = max(LEAST_PLACES_OF_A_LOOP, round(max(LEAST_PLACES, PLACES_PER_VERTEX * target) * share))
            at = places(chain, weight, min(count, max(chain.size, 6)))
            if len(chain.pins):
                at = np.union1d(at, chain.pins)
            # long edges deserve few places, but a line each
            deserved_lines = USUAL_SHARE * target * max(share, chain.length / length)
            expected = max(float(LEAST_PER_LOOP), min(len(at) / PLACES_PER_VERTEX, deserved_lines))
            usual = candidates(chain, at, LONGEST_STRETCH * len(at) / expected, shift, corners=self._is_thorough(chain))
            lines = usual
            for rule in self.kept.rules:
                lines = rule.candidates(chain, at, lines, self.frame, shift)
            self.few_turns = lines is not usual  # those of a few directions
            yield
            found[k] = lines.shifted(shift), at, expected, deserved_lines
        obstacles = Obstacles(self.outline.split(), self.request.regions)
        for k in found:
            if self.images is None or self.images.loops[k][0] == k:
                try:
                    self.searches[k] = self._around(k, *found[k], obstacles, known)
                except NoCyclesError:
                    if self.only is None:
                        raise
                yield
        yield from together([search.solve() for search in self.searches.values()])
        blocked = [k for k, search in self.searches.items() if not search.found]
        if blocked:
            raise NoCyclesError.around(blocked)

    def _around(
        self, k: int, lines: Lines, at: IntArray, expected: float, deserved: float, obstacles: Obstacles, known: bool
    ) -> Search:
        """A search around a loop, for symmetric cycles if there are images. Raises NoCyclesError."""
        chain, halves, parts, shift = self.chains[k], None, 1, float(self.shift[k])
        images = self.images
        if images is not None and self._is_halved(k):
            lines, halves = images.mirrored(k, chain, lines, at, shift)
        elif images is not None and len(images.own[k]) > 1:
            parts = len(images.own[k])
            lines = images.turned(k, chain, lines)
        distance = (1.0 - NEGLIGIBLE) * shift if shift > HULL_OFFSET else 0.0  # a little less from what they touch
        free = obstacles.free(lines, REACH, self.request.regions[k], distance)
        usable = np.asarray((free > 0.0).all(axis=0))
        if chain.swept[-1] < 0.0:  # every ray in a hole ends at it; in the solid around it some end nowhere
            usable &= (free < REACH).all(axis=0)
        for rule in self.kept.rules:
            free = np.minimum(free, np.minimum(rule.free(lines, self.frame), rule.reach(chain, lines, shift)))
            usable &= (free > 0.0).all(axis=0)
        free += SLACK if shift < HULL_OFFSET else 0.0
        if images is not None and halves is not None:
            free = np.minimum(free, images.to_axis(lines, halves) + SLACK)
            usable &= usable[halves.image]
            halves = halves.take(usable)
        elif parts > 1:
            usable = np.tile(usable.reshape(parts, -1).all(axis=0), parts)
        lines, free = lines.take(usable), free[:, usable]
        count = len(lines)
        if count < 3:
            raise NoCyclesError.around([k])
        width = count - 1
        if count * expected**2 > FULL_SEARCH and not self.few_turns:
            width = min(width, int(FOLLOWING * count / expected) + SPARE_FOLLOWING)
        sizes = self._sizes(k, deserved, count, self._copies(k), parts)
        if not sizes:  # a symmetry of more parts than there are vertices
            raise NoCyclesError.around([k])
        if halves is not None:
            from .images import MirrorSearch

            return MirrorSearch(chain, lines, free, width=width, sizes=sizes, halves=halves)
        likely = (self.request.target if len(self.chains) == 1 else expected) / parts
        usual, thorough = {"width": width, "parts": parts}, self._is_thorough(chain)
        return LoopSearch(chain, lines, free, sizes=sizes, expected=likely, thorough=thorough, known=known, **usual)

    def _is_thorough(self, chain: Chain) -> bool:
        """Whether a search around a loop may take long: convex, with one number of lines to seek."""
        return self.request.per_loop is not None and chain.is_convex

    def _sizes(self, loop: int, deserved: float, lines: int, copies: int, parts: int) -> range:
        """The possible numbers of lines of a part of a loop, and of as many others like it."""
        minimum, target, loops = self.request.minimum, self.request.target, copies // parts
        most = minimum[loop]
        if self.request.per_loop is None:
            most = min(lines, (target - sum(minimum) + loops * minimum[loop]) // loops)
            if len(minimum) > 1 and target < MOST_OF_ALL * len(self.outline.vertices):
                most = max(minimum[loop], min(most, int(MAX_SHARE * deserved) + SPARE_SHARE), min(lines, FEW_LINES))
        return range(-(-minimum[loop] // parts), most // parts + 1)

    def _mesh(self, choice: Choice) -> tuple[float, Mesh]:
        """Area and mesh of cycles that do not cross. Raises NoCyclesError."""
        rings = [without_doubles(self.frame.out_of(ring)) for ring in choice.rings]
        if min(map(len, rings)) < 3:
            raise NoCyclesError("A cycle is flat.", code="count.too_small")
        outline = Loops.of(np.concatenate(rings), [len(ring) for ring in rings])
        try:
            if choice.images is None:
                importance = self.kept.importance
                if importance is not None and self.request.per_loop is None:  # straight sides have pins too
                    outline = importance.with_vertices(outline, self.request.total)
                mesh = self.request.coarse(outline)
            else:
                mesh = self.request.mesh(padded_alike(outline, self.request.total, choice.images.symmetry))
        except (InvalidMeshError, AsymmetricError) as error:
            raise NoCyclesError(error.fault) from error
        if not self.request.nests(mesh):
            raise NoCyclesError("The cycles do not enclose the loops.", code="count.too_small")
        return outline.area, mesh
