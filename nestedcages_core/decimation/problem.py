"""The problem of a decimation: loops in canonical order, and vertices to keep, shared out by length."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import NestingError
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.loops import Loops
from ..geometry.mesh import Mesh, Nesting
from ..geometry.precision import ROUND_OFF
from ..geometry.vectors import cross, norm
from .base import MIN_PER_LOOP, NOTHING_KEPT, Count, Kept

MAX_TIED = 64
"""Number of equally far vertices that are compared: round shapes have more, which differ in nothing."""


@dataclass(frozen=True, eq=False)
class Problem:
    """The loops of a mesh in canonical order, and the number of vertices that its coarse mesh is to have.

    outline: the loops, largest first, each starting with the vertex farthest from its centre, so that nothing depends
    on the numbering of the vertices.
    loop_order: (L,) for each loop of the outline its number in the mesh.
    total: most vertices of the coarse mesh. per_loop: (L,) those of each loop of the outline; None: distributed freely.
    """

    fine: Mesh
    outline: Loops
    loop_order: IntArray
    total: int
    per_loop: IntArray | None
    side: int = 1
    """1 for meshes around the fine one; -1 for meshes inside it, which are around what surrounds it: the loops of the
    outline then have that on their left."""
    kept: Kept = NOTHING_KEPT
    """What the coarse mesh keeps."""
    optional: frozenset[int] = frozenset()
    """Loops of the outline that it may leave out, which are holes."""

    @classmethod
    def of(
        cls, fine: Mesh, count: Count, side: int = 1, kept: Kept = NOTHING_KEPT, optional: Sequence[int] = ()
    ) -> Problem:
        """The request for a count as in `Decimation.decimate`. optional: holes of the mesh. Raises NestingError."""
        total, numbers = checked_count(fine, count, len(optional))
        if numbers is None and not kept.rules:  # along the axes, more than the mesh has are of use
            total = min(total, len(fine.vertices))
        outline, loop_order = canonical_order(fine)
        if side < 0:
            outline = Loops.of(outline.turned(np.ones(len(outline.sizes), bool)).vertices, outline.sizes)
        per_loop = None if numbers is None else np.array(numbers)[loop_order]
        may_miss = frozenset(np.flatnonzero(np.isin(loop_order, optional)).tolist())
        return cls(fine, outline, loop_order, total, per_loop, side, kept, may_miss)

    @property
    def regions(self) -> IntArray:
        """(L,) the region outside the solid, or inside it, that each loop of the outline bounds."""
        fine = self.fine
        outside = np.where(fine.loop_signs > 0, fine.parent_of_loop, np.arange(len(fine.loops)))
        return np.asarray((outside if self.side > 0 else fine.component_of_loop)[self.loop_order])

    def mesh(self, loops: Sequence[FloatArray]) -> Mesh:
        """A mesh of loops (k, 2) in the order of the outline; its loop k stands for loop k of the fine mesh."""
        return Mesh.from_loops([loops[k] for k in np.argsort(self.loop_order)])

    def nests(self, coarse: Mesh) -> bool:
        """Whether each loop of the coarse mesh lies on the right side of its fine one, by exact predicates."""
        outer, inner = (coarse, self.fine) if self.side > 0 else (self.fine, coarse)
        return Nesting(outer, inner).encloses_loop_by_loop()


def _first_of(candidates: IntArray, points: FloatArray, tie: float) -> int:
    """The vertex of some from which the edges of a loop (k, 2) make the least sequence, whatever its direction.

    Only rotations of the loop into itself leave more than one.
    """
    step = np.roll(points, -1, axis=0) - points
    before = np.roll(step, 1, axis=0)
    edges = np.round(np.stack((norm(step), cross(before, step) / norm(before)), axis=1) / tie)
    candidates, first = candidates[:MAX_TIED], 0
    while len(candidates) > 1 and first < len(edges):  # twice as many edges each time
        places = np.arange(first, min(2 * first + 8, len(edges)))
        sequences = edges[(candidates[:, None] + places) % len(edges)].reshape(len(candidates), -1)
        candidates = candidates[(sequences == min(sequences.tolist())).all(axis=1)]
        first = 2 * first + 8
    return int(candidates[0])


def canonical_order(fine: Mesh) -> tuple[Loops, IntArray]:
    """The loops of a mesh, largest first, each from the vertex farthest from its centre; and their numbers (L,)."""
    tie, corner = ROUND_OFF * fine.diagonal, fine.vertices.min(axis=0)
    rings, keys = [], []
    for loop, area in zip(fine.loops, fine.loop_areas, strict=True):
        points = fine.vertices[loop]
        lengths = fine.edge_lengths[loop]
        middles = 0.5 * (points + np.roll(points, -1, axis=0))
        offsets = points - (lengths[:, None] * (middles - points[0])).sum(axis=0) / lengths.sum() - points[0]
        distance = norm(offsets)
        farthest = np.flatnonzero(distance >= distance.max() - tie)
        cells = np.round(offsets[farthest] / tie)
        farthest = farthest[np.lexsort((cells[:, 1], cells[:, 0]))]
        start = farthest[0] if len(farthest) == 1 else _first_of(farthest, points, tie)
        rings.append(np.roll(loop, -start))
        keys.append((-round(abs(area) / (tie * fine.diagonal)), *np.round((points[start] - corner) / tie)))
    order = np.array(sorted(range(len(rings)), key=keys.__getitem__), dtype=np.int64)
    ordered = tuple(rings[k] for k in order)
    return Loops.of(fine.vertices[np.concatenate(ordered)], [len(ring) for ring in ordered]), order


def checked_count(fine: Mesh, count: Count, optional: int = 0) -> tuple[int, tuple[int, ...] | None]:
    """The total, and the numbers per loop in the order of `fine.loops`, if those are given.

    Raises NestingError unless every loop gets 3, but for some that are optional. Numbers per loop may exceed those of
    the fine mesh, as they come from a given coarse mesh.
    """
    loops, per_loop = len(fine.loops), None
    try:
        if isinstance(count, Sequence | np.ndarray):
            per_loop = tuple(operator.index(k) for k in count)
            total = sum(per_loop)
        else:
            total = operator.index(count)
    except TypeError:
        raise NestingError(
            f"A level needs a whole number of vertices, or one per loop, not {count!r}.", code="level.invalid"
        ) from None
    if per_loop is not None and len(per_loop) != loops:
        raise NestingError(
            f"The level lists vertices for {len(per_loop)} loops, but the mesh inside it has {loops}; give one number "
            "per loop, or only their sum.",
            code="count.per_loop",
        )
    least = MIN_PER_LOOP * (loops - optional)
    if total < least or min(per_loop or (total,)) < MIN_PER_LOOP:
        raise NestingError(
            f"A level of {count} vertices is too small: the mesh inside it has {loops} loop{'s' * (loops > 1)} and each"
            f" needs at least {MIN_PER_LOOP}, so ask for at least {least}.",
            code="count.too_small",
            total=total,
            least=least,
        )
    return total, per_loop
