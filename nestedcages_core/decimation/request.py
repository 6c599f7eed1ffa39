"""The request to a decimation: loops in canonical order, and vertices to keep, shared out by length."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heapify, heapreplace

import numpy as np

from ..errors import InvalidMeshError
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.loops import Loops
from ..geometry.mesh import Mesh, Nesting
from ..geometry.precision import ROUND_OFF
from ..geometry.vectors import cross, norm
from .base import NOTHING_KEPT, Count, Kept
from .budget import LEAST_PER_LOOP, checked_budget

MAX_TIED = 64
"""Number of equally far vertices that are compared: round shapes have more, which differ in nothing."""


@dataclass(frozen=True, eq=False)
class Request:
    """The loops of a mesh in canonical order, and the number of vertices that its coarse mesh is to have.

    outline: the loops, largest first, each starting with the vertex farthest from its centre, so that nothing depends
    on the numbering of the vertices.
    loop_order: (L,) for each loop of the outline its number in the mesh.
    total: vertices of the coarse mesh. per_loop: (L,) vertices per loop of the outline; None: distributed freely.
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

    @classmethod
    def of(cls, fine: Mesh, count: Count, side: int = 1, kept: Kept = NOTHING_KEPT) -> Request:
        """The request for a count as in `Decimation.decimate`. Raises NestingError."""
        budget = checked_budget(fine, count)
        outline, loop_order = canonical_order(fine)
        if side < 0:
            outline = Loops.of(outline.turned(np.ones(len(outline.sizes), bool)).vertices, outline.sizes)
        per_loop = None if budget.per_loop is None else np.array(budget.per_loop)[loop_order]
        return cls(fine, outline, loop_order, budget.total, per_loop, side, kept)

    @property
    def minimum(self) -> list[int]:
        """Vertices that each loop keeps: the wanted number, at most its own."""
        sizes = self.outline.sizes
        return [LEAST_PER_LOOP] * len(sizes) if self.per_loop is None else np.minimum(self.per_loop, sizes).tolist()

    @property
    def target(self) -> int:
        """Number of vertices to decimate to. Loops that want more than their own get them by divided edges."""
        return self.total if self.per_loop is None else sum(self.minimum)

    @property
    def regions(self) -> IntArray:
        """(L,) the region outside the solid, or inside it, that each loop of the outline bounds."""
        fine = self.fine
        outside = np.where(fine.loop_signs > 0, fine.parent_of_loop, np.arange(len(fine.loops)))
        return np.asarray((outside if self.side > 0 else fine.component_of_loop)[self.loop_order])

    def coarse(self, outline: Loops) -> Mesh:
        """The coarse mesh of an outline with at most `target` vertices: edges are divided until there are enough.

        Raises InvalidMeshError where loops cross.
        """
        enough = outline.sizes.sum() == self.total if self.per_loop is None else (outline.sizes == self.per_loop).all()
        if enough:
            return self.mesh(outline.split())
        return self.mesh(padded(outline, self.total, self.per_loop))

    def mesh(self, loops: Sequence[FloatArray]) -> Mesh:
        """A mesh of loops (k, 2) in the order of the outline; its loop k stands for loop k of the fine mesh."""
        return Mesh.from_loops([loops[k] for k in np.argsort(self.loop_order)])

    def with_room(self, coarse: Mesh, clearance: float) -> Mesh:
        """The coarse mesh with small polygons in holes that the clearance nearly fills; inside there is space."""
        if self.side < 0 or not (self.fine.loop_signs < 0).any():
            return coarse
        from .hull.small_holes import with_room

        return with_room(coarse, self.fine, clearance)

    def nests(self, coarse: Mesh) -> bool:
        """Whether each loop of the coarse mesh lies on the right side of its fine one, by exact predicates."""
        outer, inner = (coarse, self.fine) if self.side > 0 else (self.fine, coarse)
        return Nesting(outer, inner).encloses_loop_by_loop()

    def same_roles(self, coarse: Mesh) -> Mesh:
        """The coarse mesh. Raises InvalidMeshError if its loops do not lie in each other as those of the fine mesh."""
        fine = self.fine
        changed = (coarse.loop_signs != fine.loop_signs) | (coarse.component_of_loop != fine.component_of_loop)
        if changed.any():
            k = int(np.flatnonzero(changed)[0])
            raise InvalidMeshError(
                f"Loop {k} comes to lie in another loop than in the mesh inside.", code="mesh.nesting"
            )
        return coarse


def _first_of(candidates: IntArray, points: FloatArray, tie: float) -> int:
    """The vertex of some from which the edges of a loop (k, 2) make the least sequence, whatever its direction.

    Only rotations of the loop into itself leave more than one.
    """
    step = np.roll(points, -1, axis=0) - points
    before = np.roll(step, 1, axis=0)
    edges = np.round(np.stack((norm(step), cross(before, step) / norm(before)), axis=1) / tie)
    sequences = [np.roll(edges, -k, axis=0).ravel() for k in candidates[:MAX_TIED].tolist()]
    return int(candidates[min(range(len(sequences)), key=lambda k: tuple(sequences[k]))])


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


def apportioned(total: int, lengths: FloatArray, least: int) -> IntArray:
    """Numbers (K,) in proportion to lengths (K,), at least `least` each, whose sum is `total` or the least possible.

    Each vertex in turn goes where the spacing is longest (D'Hondt's method), which minimises the longest spacing. Ties
    go to the first.
    """
    numbers = np.full(len(lengths), least, dtype=np.int64)
    queue = [(-length / least, k) for k, length in enumerate(lengths.tolist())]
    heapify(queue)
    for _ in range(total - least * len(lengths)):
        k = queue[0][1]
        numbers[k] += 1
        heapreplace(queue, (-float(lengths[k]) / int(numbers[k]), k))
    return numbers


def padded(outline: Loops, total: int, per_loop: IntArray | None) -> list[FloatArray]:
    """The loops (k, 2) of an outline with edges divided evenly until there are enough vertices.

    total: wanted number of vertices. per_loop: (L,) wanted number for each loop, instead of the total.
    """
    steps = outline.vertices[outline.successor] - outline.vertices
    lengths = norm(steps)
    if per_loop is None:
        pieces = apportioned(total, lengths, 1)
    else:
        of_loop = np.split(lengths, outline.begins[1:])
        pieces = np.concatenate([apportioned(k, edges, 1) for k, edges in zip(per_loop.tolist(), of_loop, strict=True)])
    begin = np.cumsum(pieces) - pieces
    fraction = (np.arange(pieces.sum()) - np.repeat(begin, pieces)) / np.repeat(pieces, pieces)
    vertices = np.repeat(outline.vertices, pieces, axis=0) + fraction[:, None] * np.repeat(steps, pieces, axis=0)
    return np.split(vertices, begin[outline.begins[1:]])
