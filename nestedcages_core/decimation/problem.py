"""The problem of a decimation: loops in canonical order, and vertices to keep, shared out by length."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heapreplace

import numpy as np

from ..errors import Fault, InvalidMeshError, NestingError, note
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
    def of(cls, fine: Mesh, count: Count, side: int = 1, kept: Kept = NOTHING_KEPT) -> Problem:
        """The request for a count as in `Decimation.decimate`. Raises NestingError."""
        total, numbers = checked_count(fine, count)
        outline, loop_order = canonical_order(fine)
        if side < 0:
            outline = Loops.of(outline.turned(np.ones(len(outline.sizes), bool)).vertices, outline.sizes)
        per_loop = None if numbers is None else np.array(numbers)[loop_order]
        return cls(fine, outline, loop_order, total, per_loop, side, kept)

    @property
    def minimum(self) -> list[int]:
        """Vertices that each loop keeps: the wanted number, at most its own."""
        sizes = self.outline.sizes
        return [MIN_PER_LOOP] * len(sizes) if self.per_loop is None else np.minimum(self.per_loop, sizes).tolist()

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
        """The coarse mesh of an outline with at most `target` vertices: edges are divided until there are enough or
        constraints allow no more.

        Raises InvalidMeshError where loops cross.
        """
        enough = outline.sizes.sum() == self.total if self.per_loop is None else (outline.sizes == self.per_loop).all()
        if enough:
            return self.mesh(outline.split())
        spacing = max((short for short, _ in (rule.turn_limits for rule in self.kept.rules)), default=0.0)
        return self.mesh(padded(outline, self.total, self.per_loop, (1.0 + ROUND_OFF) * spacing))

    def mesh(self, loops: Sequence[FloatArray]) -> Mesh:
        """A mesh of loops (k, 2) in the order of the outline; its loop k stands for loop k of the fine mesh."""
        return Mesh.from_loops([loops[k] for k in np.argsort(self.loop_order)])

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


def apportioned(total: int, lengths: FloatArray, least: int, spacing: float = 0.0) -> IntArray:
    """Numbers (K,) in proportion to lengths (K,), at least `least` each, whose sum is `total` or the least possible.

    Each vertex in turn goes where the spacing is longest (D'Hondt's method), which minimises the longest spacing. Ties
    go to the first. The sum is smaller where none is left whose spacing would stay above the given one.
    """
    numbers = np.full(len(lengths), least, dtype=np.int64)
    most = np.maximum(least, lengths / spacing) if spacing > 0.0 else np.full(len(lengths), np.inf)
    queue = [(-length / least, k) for k, length in enumerate(lengths.tolist()) if most[k] >= least + 1]
    heapify(queue)
    for _ in range(total - least * len(lengths)):
        if not queue:
            break
        k = queue[0][1]
        numbers[k] += 1
        if most[k] >= numbers[k] + 1:
            heapreplace(queue, (-float(lengths[k]) / int(numbers[k]), k))
        else:
            heappop(queue)
    return numbers


def padded(outline: Loops, total: int, per_loop: IntArray | None, spacing: float = 0.0) -> list[FloatArray]:
    """The loops (k, 2) of an outline with edges divided evenly until there are enough vertices.

    total: wanted number of vertices. per_loop: (L,) wanted number for each loop, instead of the total. spacing: the
    least length of parts of edges.
    """
    steps = outline.vertices[outline.successor] - outline.vertices
    lengths = norm(steps)
    if per_loop is None:
        pieces = apportioned(total, lengths, 1, spacing)
    else:
        of_loop = np.split(lengths, outline.begins[1:])
        pieces = np.concatenate([apportioned(k, edges, 1) for k, edges in zip(per_loop.tolist(), of_loop, strict=True)])
    begin = np.cumsum(pieces) - pieces
    fraction = (np.arange(pieces.sum()) - np.repeat(begin, pieces)) / np.repeat(pieces, pieces)
    vertices = np.repeat(outline.vertices, pieces, axis=0) + fraction[:, None] * np.repeat(steps, pieces, axis=0)
    return np.split(vertices, begin[outline.begins[1:]])


def clamped(count: int, fine: Mesh) -> tuple[int, tuple[Fault, ...]]:
    """A number of vertices, clamped to that of the fine mesh, with a note if it was larger."""
    available = len(fine.vertices)
    if count <= available:
        return count, ()
    return available, (note("note.count", on="mesh", asked=count, given=available),)


def shared_anew(count: Count, coarse: Mesh) -> tuple[Fault, ...]:
    """A note if the numbers of vertices per loop of a coarse mesh differ from the request."""
    if isinstance(count, int | np.integer) or list(count) == [len(loop) for loop in coarse.loops]:
        return ()
    return (note("note.count", on="loops", asked=list(count), given=[len(loop) for loop in coarse.loops]),)


def count_fault(total: int, least: int) -> Fault:
    """The message for a number of vertices below the least for which a coarse mesh was found."""
    return Fault(
        f"A level of {total} vertices is too small for this shape, whose loops block each other: the smallest that was "
        f"found has {least}; ask for at least {least}.",
        "count.too_small",
        total=total,
        least=least,
    )


def checked_count(fine: Mesh, count: Count) -> tuple[int, tuple[int, ...] | None]:
    """The total, and the numbers per loop in the order of `fine.loops`, if those are given.

    Raises NestingError unless every loop gets 3 and the total is at most that of `fine`.

    Numbers per loop may exceed those of the fine mesh, as they come from a given coarse mesh.
    """
    loops, available = len(fine.loops), len(fine.vertices)
    try:
        if isinstance(count, Sequence | np.ndarray):
            per_loop = tuple(operator.index(k) for k in count)
            total = sum(per_loop)
        else:
            per_loop = None
            total = operator.index(count)
    except TypeError:
        raise NestingError(
            f"A level needs a whole number of vertices, or one per loop, not {count!r}.", code="level.invalid"
        ) from None
    if per_loop is not None:
        if len(per_loop) != loops:
            raise NestingError(
                f"The level lists vertices for {len(per_loop)} loops, but the mesh inside it has {loops}; give one "
                "number per loop, or only their sum.",
                code="count.per_loop",
            )
        if min(per_loop) < MIN_PER_LOOP:
            k = int(np.argmin(per_loop))
            raise NestingError(
                f"The level gives {per_loop[k]} vertices to loop {k}, but a loop needs at least {MIN_PER_LOOP}.",
                code="count.too_small",
                total=total,
                least=MIN_PER_LOOP * loops,
            )
    elif total < MIN_PER_LOOP * loops:
        raise NestingError(
            f"A level of {total} vertices is too small: the mesh inside it has {loops} "
            f"loop{'s' if loops > 1 else ''} and each needs at least {MIN_PER_LOOP}, so ask for at least "
            f"{MIN_PER_LOOP * loops}.",
            code="count.too_small",
            total=total,
            least=MIN_PER_LOOP * loops,
        )
    elif total > available:
        raise NestingError(
            f"A level of {total} vertices has more than the {available} of the mesh inside it; ask for at most "
            f"{available}.",
            code="count.too_large",
            total=total,
            largest=available,
        )
    return total, per_loop
