"""The search for cycles around all loops of a mesh: lines of each loop, how many each gets, and crossings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..errors import InvalidMeshError, NestingError
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.convex_hull import convex_hull
from ..geometry.loops import Loops
from ..geometry.mesh import Mesh
from ..geometry.precision import MOST_ROUNDS, NEGLIGIBLE
from ..geometry.vectors import norm
from .base import MIN_PER_LOOP, REACH, Tick, no_tick
from .crossings import Choice
from .outline import Lines, Outline, without_doubles
from .problem import Problem
from .ring_search import RingSearch, allocate, least_sums, run_together
from .sampling import NormalFrame, samples, weights
from .symmetric import Images, MirrorSearch, padded_alike
from .tangents import tangents
from .turns import SLACK
from .visibility import Obstacles

OFFSET = 5e-5
"""Distance of lines from the outline, in diameters, where there is space, unless the clearance is larger."""

SAMPLES_PER_VERTEX, MIN_SAMPLES, MIN_SAMPLES_OF_A_LOOP = 3.0, 80, 12
"""Samples: per vertex of the cage; at least, in all; at least, for each loop
(docs/ablation.md: line cycles: places)."""

LONGEST_STRETCH = 3.0
"""Length of the longest stretches that have tangents, in mean edges of the cage."""

FAR = 40.0
"""How far rays are followed, in mean edges of the cage, or lengths of what a line runs along."""

FULL_SEARCH = 200_000
"""Lines around a loop times edges of its cage squared, up to which a line may be followed by any other: pockets of
spirals hold most of the lines, so that narrower searches made more vertices worse."""

FOLLOWING, SPARE_FOLLOWING, MAX_DEPTH = 3.0, 8, 20.0
"""Otherwise it is followed by a line within this many mean edges of the cage, and this many lines; more where the
outline is longer than its hull, at most so many times."""

USUAL_SHARE, MAX_SHARE, SPARE_SHARE = 1.2, 2.0, 8
"""Lines of a loop: likely ones per deserved one; largest number per likely one, and beyond that."""

ANY_NUMBER = 0.5
"""Lines per vertex of the mesh from which each loop may have any number."""

FEW_LINES = 12
"""Number of lines of each of several loops that is sought in any case, to know the least."""


ALIKE = 0.75
"""Ratio of deserved lines down to which a search serves for another number of them."""


class NoCyclesError(NestingError):
    """No cycles of lines were found."""

    def __init__(self, sentence: str = "There are no such cycles of lines.", **data: Any) -> None:
        super().__init__(sentence, code="count.too_small", **data)


class Tables:
    """Searches around loops that several outlines share, each made once for about as many lines."""

    def __init__(self, frame: NormalFrame) -> None:
        self.frame = frame
        self._known: dict[object, tuple[int, float, RingSearch]] = {}

    def search(self, around: CycleSearch, k: int) -> RingSearch:
        """The search around a loop, for as many lines as it may have there. Raises NoCyclesError."""
        deserved = around.deserved(k)[1]
        most = around.most(k, deserved, len(around.loops.vertices))
        key = around.outlines[k].vertices.tobytes(), float(around.shift[k])
        known = self._known.get(key)
        if known is None or known[0] < most or not ALIKE * known[1] < deserved < known[1] / ALIKE or not known[2].found:
            known = self._known[key] = most, deserved, around.around(k)
        return known[2]


class CycleSearch:
    """The search around all loops of a mesh."""

    def __init__(self, problem: Problem, loops: Loops, shift: FloatArray, tables: Tables | None = None) -> None:
        """loops: as symmetric as what is kept; shift: (L,) of lines from their loops, in diameters; a clearance is
        kept from all loops. tables: searches around loops of other outlines, in whose frame this one is."""
        self.problem, self.kept, self.shift, self.tables = problem, problem.kept, shift, tables
        self.frame = NormalFrame.of(loops) if tables is None else tables.frame
        symmetry = self.kept.symmetry
        self.images = None if symmetry is None else Images.of(loops, symmetry, self.frame)
        self.outlines = self._outlines(loops)
        self.loops = loops.moved(self.frame.into(loops.vertices))
        if min(outline.length for outline in self.outlines) == 0.0:
            raise NoCyclesError("A loop is as small as round-off.")
        self.weights = weights(self.outlines, problem.target)
        sums = np.array([weight.sum() for weight in self.weights])
        lengths = np.array([outline.length for outline in self.outlines])
        self.shares: FloatArray = sums / sums.sum()
        """(L,) part of the samples that each loop deserves."""
        self.lengths: FloatArray = lengths / lengths.sum()
        """(L,) part of the length of all that each has."""
        self.obstacles = Obstacles(self.loops.split(), problem.regions)
        self.searches: dict[int, RingSearch] = {}
        """Of each loop that stands for its images."""
        self.few_turns = False

    def search(self, tick: Tick = no_tick) -> None:
        """Search around each loop that stands for its images. Raises NoCyclesError."""
        loops = [k for k in range(len(self.outlines)) if self.images is None or self.images.loops[k][0] == k]
        for done, k in enumerate(loops):
            tick(done / len(self.outlines))
            self.searches[k] = self.around(k) if self.tables is None else self.tables.search(self, k)
        run_together([search.solve() for search in self.searches.values() if not search.found])
        if not all(search.found for search in self.searches.values()):
            raise NoCyclesError("There are no such cycles around some loops.", total=self.problem.total)

    def best(self, rule: float, tick: Tick = no_tick) -> tuple[float, Mesh, int]:
        """Area and mesh of the best cycles that do not cross, and how often crossings were cleared. rule: which of two
        crossing edges gives way. Raises NoCyclesError."""
        searches = {loop: search.copy() for loop, search in self.searches.items()}
        numbers = self._numbers(searches)
        for rounds in range(MOST_ROUNDS):
            tick(rounds / MOST_ROUNDS)
            run_together([searches[loop].refine(number) for loop, number in numbers.items()])
            numbers = self._numbers(searches)
            choice = Choice.of(searches, numbers, self.images)
            i, j = choice.crossings()
            if len(i) == 0:
                break
            changed = choice.shorten(searches, i, j, rule)
            run_together([searches[k].solve(int(searches[k].cycle(numbers[k])[0])) for k in changed])
            numbers = self._numbers(searches)
        return *self._mesh(choice), rounds

    @property
    def least(self) -> FloatArray:
        """(n,) the least area of cycles of 0, 1, … lines in all, crossings aside, in the input's units."""
        copies = [self._copies(loop) for loop in self.searches]
        totals = [number * search.totals for number, search in zip(copies, self.searches.values(), strict=True)]
        return (least_sums(totals, self.problem.target, copies)[0] + self.loops.area) * self.frame.scale**2

    def _outlines(self, loops: Loops) -> list[Outline]:
        """The loops in the frame of the search, with what matters there."""
        vertices, importance = self.frame.into(loops.vertices), self.kept.importance
        weights, pinned = None, np.zeros(len(vertices), bool)
        if importance is not None:
            pinned = importance.pinned(loops)
            weights = None if importance.weights is None else importance.at(loops.vertices)
        wanted = [rule.turn_limits for rule in self.kept.rules] or [(0.0, 0.0)]
        limits = max(short for short, _ in wanted) / self.frame.scale, max(sharp for _, sharp in wanted)
        parts = [slice(begin, begin + size) for begin, size in zip(loops.begins, loops.sizes, strict=True)]
        return [Outline(vertices[p], None if weights is None else weights[p], pinned[p], limits) for p in parts]

    def _copies(self, loop: int) -> int:
        """Lines of the cage for each one that is counted around a loop."""
        return 1 if self.images is None or self.images.is_halved(loop) else self.images.symmetry.order

    def _numbers(self, searches: Mapping[int, RingSearch]) -> dict[int, int]:
        """Lines of each loop. Raises NoCyclesError."""
        copies = [self._copies(loop) for loop in searches]
        totals = [number * search.totals for number, search in zip(copies, searches.values(), strict=True)]
        numbers = allocate(totals, self.problem.target, copies)
        if numbers is None:
            least = [number * int(np.isfinite(total).argmax()) for number, total in zip(copies, totals, strict=True)]
            known: dict[str, Any] = {"least": sum(least)} if all(least) and sum(least) > self.problem.target else {}
            raise NoCyclesError(total=self.problem.total, **known)
        return dict(zip(searches, numbers, strict=True))

    def deserved(self, k: int) -> tuple[int, float]:
        """Samples and lines that a loop deserves: long edges deserve few samples, but a line each."""
        target = self.problem.target
        share, of_length = float(self.shares[k]), float(self.lengths[k])
        count = max(MIN_SAMPLES_OF_A_LOOP, round(max(MIN_SAMPLES, SAMPLES_PER_VERTEX * target) * share))
        return count, USUAL_SHARE * target * max(share, of_length)

    def _candidates(self, k: int) -> tuple[Lines, IntArray, float, float]:
        """Lines of a loop, its samples, and the likely and the deserved number of lines."""
        outline, shift, (count, deserved) = self.outlines[k], float(self.shift[k]), self.deserved(k)
        at = samples(outline, self.weights[k], min(count, max(outline.size, 6)))
        if len(outline.pins):
            at = np.union1d(at, outline.pins)
        expected = max(float(MIN_PER_LOOP), min(len(at) / SAMPLES_PER_VERTEX, deserved))
        lines = usual = tangents(outline, at, LONGEST_STRETCH * len(at) / expected, shift, corners=self._is_thorough(k))
        for rule in self.kept.rules:
            lines = rule.candidates(outline, at, lines, self.frame, shift)
        self.few_turns = lines is not usual  # those of a few directions
        return lines.shifted(shift), at, expected, deserved

    def around(self, k: int) -> RingSearch:
        """A search around a loop, for symmetric cycles if there are images. Raises NoCyclesError."""
        outline, shift, images = self.outlines[k], float(self.shift[k]), self.images
        lines, at, expected, deserved = self._candidates(k)
        if images is not None:
            lines = images.first_part(k, outline, lines, at, shift)
        # a little less than the shift from what lines touch
        distance = (1.0 - NEGLIGIBLE) * shift if shift > OFFSET else 0.0
        longest = REACH * min(1.0, outline.diameter)
        reach = np.minimum(longest, FAR * np.maximum(lines.span, outline.length / expected))
        free = self.obstacles.free(lines, reach, int(self.problem.regions[k]), distance)
        usable = np.asarray((free > 0.0).all(axis=0))
        if outline.is_hole:  # every ray in a hole ends at it; in the solid around it some end nowhere
            usable &= ((free < reach) | (reach < longest)).all(axis=0)
        for rule in self.kept.rules:
            free = np.minimum(free, np.minimum(rule.free(lines, self.frame), rule.reach(outline, lines, shift)))
            usable &= (free > 0.0).all(axis=0)
        free += SLACK if shift < OFFSET else 0.0
        lines, free = lines.take(usable), free[:, usable]
        if images is not None:
            lines, free = images.all_parts(k, outline, lines, free)
        halved = images is not None and images.is_halved(k)
        parts = 1 if images is None else images.parts(k)
        count, thorough = len(lines), self._is_thorough(k)
        sizes = self._sizes(k, deserved, count, parts)
        if count < 3 or not sizes:  # a symmetry of more parts than there are vertices
            raise NoCyclesError("There are no such cycles around some loops.", total=self.problem.total)
        width = count - 1
        if count * expected**2 > FULL_SEARCH and not self.few_turns:
            around = outline.vertices[at]
            depth = _perimeter(around) / _perimeter(around[convex_hull(around)])  # of pockets, which cycles skip
            width = min(width, int(FOLLOWING * min(depth, MAX_DEPTH) * count / expected) + SPARE_FOLLOWING)
        if halved:
            return MirrorSearch(outline, lines, free, width=width, sizes=sizes)
        known = self.problem.per_loop is not None or len(self.outlines) == 1
        likely = (self.problem.target if len(self.outlines) == 1 else expected) / parts
        return RingSearch(
            outline, lines, free, width=width, sizes=sizes, expected=likely, parts=parts, thorough=thorough, known=known
        )

    def _is_thorough(self, k: int) -> bool:
        """Whether a search around a loop may take long: convex, with one number of lines to seek."""
        return self.problem.per_loop is not None and self.outlines[k].is_convex

    def _sizes(self, loop: int, deserved: float, lines: int, parts: int) -> range:
        """The possible numbers of lines of a part of a loop, and of as many others like it."""
        minimum = self.problem.minimum[loop]
        return range(-(-minimum // parts), self.most(loop, deserved, lines, parts) // parts + 1)

    def most(self, loop: int, deserved: float, lines: int, parts: int = 1) -> int:
        """The largest number of lines that a loop may have, of those that there are."""
        minimum, target, loops = self.problem.minimum, self.problem.target, self._copies(loop) // parts
        if self.problem.per_loop is not None:
            return minimum[loop]
        most = min(lines, (target - sum(minimum) + loops * minimum[loop]) // loops)
        if len(minimum) > 1 and target < ANY_NUMBER * len(self.loops.vertices):
            most = max(minimum[loop], min(most, int(MAX_SHARE * deserved) + SPARE_SHARE), min(lines, FEW_LINES))
        return most

    def _mesh(self, choice: Choice) -> tuple[float, Mesh]:
        """Area and mesh of cycles that do not cross. Raises NoCyclesError."""
        rings = [without_doubles(self.frame.out_of(ring)) for ring in choice.rings]
        if min(map(len, rings)) < 3:
            raise NoCyclesError("A cycle is flat.", total=self.problem.total)
        loops, problem, importance = (
            Loops.of(np.concatenate(rings), list(map(len, rings))),
            self.problem,
            self.kept.importance,
        )
        try:
            if choice.images is not None:
                mesh = problem.mesh(padded_alike(loops, problem.total, choice.images.symmetry))
            else:
                if importance is not None and problem.per_loop is None:  # straight sides have pins too
                    loops = importance.with_vertices(loops, problem.total)
                mesh = problem.coarse(loops)
        except (InvalidMeshError, NestingError) as error:
            raise NoCyclesError(str(error), total=self.problem.total) from error
        if len(rings) > 1 and not problem.nests(mesh):  # the certificate says it of one loop
            raise NoCyclesError("The cycles do not enclose the loops.", total=self.problem.total)
        return loops.area, mesh


def _perimeter(ring: FloatArray) -> float:
    return float(norm(ring - np.roll(ring, 1, axis=0)).sum())
