"""Loops that cross: cut where they meet, and what bounds the painted places linked into loops that do not."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.spatial import cKDTree

from ..errors import InvalidMeshError
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.mesh.validation import place
from ..geometry.predicates import ON_BOUNDARY, BoxTree, crossing_pairs, orientation, winding_number

SNAP = 1e-12
"""Distance, in diagonals, within which places where edges meet are one: some thousand roundings."""

GRIDS = (0.0, 2.0**-30, 2.0**-24)
"""Spacings, in diagonals rounded to a power of two, of the grids that all points are rounded to, one after the other:
none, unless edges are too close to tell; the coarsest is a ten-thousandth of the usual tolerance of curves."""

PASSES = 12
"""Rounds of cutting; rounding a cut may make new crossings, which are rare and short."""

PULLED = 1e-3
"""Distance by which loops that touch in a point are pulled apart there, by the shorter edge at the point."""

FARTHEST_PULLED = 1e-6
"""The same, at the most, in diagonals."""

FIRST_OFFSET, OFFSET_SHRINK, OFFSETS = 1e-3, 0.03, 7
"""Places beside an edge at which windings are counted: its length times this, smaller while the counts disagree."""

Rule = Callable[[IntArray], BoolArray]


def arranged(loops: Sequence[FloatArray], owner: IntArray, painted: Sequence[Rule]) -> Mesh:
    """The solid of all places that any area paints.

    loops: (k, 2) each; owner: (L,) area of each; painted: for each area, whether winding numbers are inside.
    Raises InvalidMeshError where coordinates are too coarse to tell.
    """
    diagonal = float(np.hypot(*np.ptp(np.concatenate(loops), axis=0)))
    unit = 2.0 ** np.ceil(np.log2(diagonal))
    failed: InvalidMeshError | None = None
    for grid in GRIDS:
        try:
            return Mesh.from_loops(_apart(*_rim(loops, owner, painted, grid * unit), diagonal))
        except InvalidMeshError as error:
            failed = failed or error
    assert failed is not None
    raise failed


def _rim(
    loops: Sequence[FloatArray], owner: IntArray, painted: Sequence[Rule], grid: float
) -> tuple[FloatArray, list[IntArray]]:
    """Points, and the loops around all painted places as indices of them; `grid`: spacing of the points, 0 for none."""
    if grid:
        loops = [_rounded(loop, grid) for loop in loops]
    points, starts, ends, area = _joined(loops, owner)
    for _ in range(PASSES):
        cut = _cut(points, starts, ends, area, grid)
        if cut is None:
            break
        points, starts, ends, area = cut
    else:
        raise InvalidMeshError("The shapes cross too often within rounding; simplify them or scale them up.")
    low, high, net = _counted(starts, ends, area, len(points), len(painted))
    left, right = _windings(points, starts, ends, area, low, high, net)
    inside_left = np.any([rule(left[:, k]) for k, rule in enumerate(painted)], axis=0)
    inside_right = np.any([rule(right[:, k]) for k, rule in enumerate(painted)], axis=0)
    forth, back = inside_left & ~inside_right, inside_right & ~inside_left
    tails, heads = np.concatenate((low[forth], high[back])), np.concatenate((high[forth], low[back]))
    if not len(tails):
        raise InvalidMeshError("The shapes have no inside.")
    return points, _linked(points, tails, heads)


def _rounded(points: FloatArray, grid: float) -> FloatArray:
    """Points on a grid; 0.0 for -0.0."""
    return np.asarray(np.round(points / grid) * grid + 0.0)


def _joined(loops: Sequence[FloatArray], owner: IntArray) -> tuple[FloatArray, IntArray, IntArray, IntArray]:
    """Different points, and the edges between them with their areas."""
    sizes = np.array([len(loop) for loop in loops])
    begins = np.cumsum(sizes) - sizes
    starts = np.arange(sizes.sum())
    ends = starts + 1
    ends[begins + sizes - 1] = begins
    points, index = np.unique(np.concatenate(loops), axis=0, return_inverse=True)
    starts, ends = index.ravel()[starts], index.ravel()[ends]
    kept = starts != ends  # the grid may join the ends of a short edge
    return points, starts[kept], ends[kept], np.repeat(owner, sizes)[kept]


def _cut(
    points: FloatArray, starts: IntArray, ends: IntArray, area: IntArray, grid: float
) -> tuple[FloatArray, IntArray, IntArray, IntArray] | None:
    """The edges cut wherever they meet others; None if they meet in common ends only."""
    pairs = np.unique(np.sort(np.stack((starts, ends), axis=1), axis=1), axis=0)
    a, b = points[pairs[:, 0]], points[pairs[:, 1]]
    i, j = crossing_pairs(BoxTree(a, b))
    # where edges meet: an end of one on the other, or a crossing of both
    edge, where = [np.zeros(0, dtype=np.int64)], [np.zeros((0, 2))]
    on_edge = np.zeros(len(i), dtype=bool)
    shared = (pairs[i][:, :, None] == pairs[j][:, None, :]).any(axis=(1, 2))
    for one, other in ((i, j), (j, i)):
        for corner in (0, 1):
            vertex = pairs[other, corner]
            p = points[vertex]
            apart = (vertex != pairs[one, 0]) & (vertex != pairs[one, 1])
            flat = orientation(a[one], b[one], p) == 0
            within = ((p >= np.minimum(a[one], b[one])) & (p <= np.maximum(a[one], b[one]))).all(axis=1)
            touching = apart & flat & within
            on_edge |= touching
            edge.append(one[touching])
            where.append(p[touching])
    crossing = ~shared & ~on_edge
    i, j = i[crossing], j[crossing]
    new = _meeting_points(a[i], b[i], a[j], b[j])
    if grid:
        new = _rounded(new, grid)
    edge += [i, j]
    where += [new, new]
    cut_edge, cut_point = np.concatenate(edge), np.concatenate(where)
    if not len(cut_edge):
        return None
    diagonal = float(np.hypot(*np.ptp(points, axis=0)))
    joined, index = _snapped(np.concatenate((points, cut_point)), len(points), SNAP * diagonal)
    cut_at = index[len(points) :]
    # every edge as a chain through its cuts, in order
    along = b - a
    every_edge = np.concatenate((np.arange(len(pairs)), cut_edge, np.arange(len(pairs))))
    every_point = np.concatenate((index[pairs[:, 0]], cut_at, index[pairs[:, 1]]))
    parameter = ((joined[every_point] - a[every_edge]) * along[every_edge]).sum(axis=1)
    rank = np.concatenate((np.full(len(pairs), -1), np.zeros(len(cut_edge)), np.ones(len(pairs))))
    order = np.lexsort((parameter, rank, every_edge))
    chain_edge, chain_point = every_edge[order], every_point[order]
    link = (chain_edge[1:] == chain_edge[:-1]) & (chain_point[1:] != chain_point[:-1])
    tail, head, parent = chain_point[:-1][link], chain_point[1:][link], chain_edge[:-1][link]
    # back from different edges to the directed ones of each area
    key = {(int(u), int(v)): k for k, (u, v) in enumerate(pairs)}
    pieces = np.split(np.arange(len(parent)), np.flatnonzero(np.diff(parent)) + 1)
    of_parent = {int(parent[piece[0]]): piece for piece in pieces if len(piece)}
    new_starts, new_ends, new_area = [], [], []
    for start, end, k in zip(starts.tolist(), ends.tolist(), area.tolist(), strict=True):
        piece = of_parent.get(key[(start, end) if start < end else (end, start)])
        if piece is None:
            continue
        forward = start < end
        new_starts.append(tail[piece] if forward else head[piece])
        new_ends.append(head[piece] if forward else tail[piece])
        new_area.append(np.full(len(piece), k))
    return joined, np.concatenate(new_starts), np.concatenate(new_ends), np.concatenate(new_area)


def _meeting_points(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> FloatArray:
    """(K, 2) where segments a-b and c-d cross, rounded."""
    along, across, gap = b - a, d - c, c - a
    determinant = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (gap[:, 0] * across[:, 1] - gap[:, 1] * across[:, 0]) / determinant
    share = np.where(np.isfinite(share), share, 0.5).clip(0.0, 1.0)
    return np.asarray(a + share[:, None] * along)


def _snapped(points: FloatArray, first: int, radius: float) -> tuple[FloatArray, IntArray]:
    """Different points, those after the first `first` moved onto a close earlier one, and the index of each."""
    target = np.arange(len(points))
    for i, j in sorted(cKDTree(points).query_pairs(radius)):
        if j >= first:
            target[j] = min(target[j], target[i])
    different, index = np.unique(points[target], axis=0, return_inverse=True)
    return different, index.ravel()


def _counted(
    starts: IntArray, ends: IntArray, area: IntArray, count: int, areas: int
) -> tuple[IntArray, IntArray, IntArray]:
    """Undirected edges low < high, (K,), (K,), and how often each area runs from low to high less back, (K, areas)."""
    low, high = np.minimum(starts, ends), np.maximum(starts, ends)
    keys, index = np.unique(low * count + high, return_inverse=True)
    net = np.zeros((len(keys), areas), dtype=np.int64)
    np.add.at(net, (index.ravel(), area), np.where(starts < ends, 1, -1))
    used = net.any(axis=1)
    return keys[used] // count, keys[used] % count, net[used]


def _windings(
    points: FloatArray, starts: IntArray, ends: IntArray, area: IntArray, low: IntArray, high: IntArray, net: IntArray
) -> tuple[IntArray, IntArray]:
    """Winding numbers (K, areas) to the left and to the right of the edges low -> high.

    Counted close beside each edge's middle, closer until both sides differ by what the edge itself contributes.
    """
    a, b = points[low], points[high]
    middle, normal = 0.5 * (a + b), np.stack((a[:, 1] - b[:, 1], b[:, 0] - a[:, 0]), axis=1)
    left, right = np.zeros_like(net), np.zeros_like(net)
    open_ = np.arange(len(low))
    offset = FIRST_OFFSET
    for _ in range(OFFSETS):
        for side, sign in ((left, offset), (right, -offset)):
            beside = middle[open_] + sign * normal[open_]
            for k in range(net.shape[1]):
                own = area == k
                side[open_, k] = 0
                if not own.any():  # its edges went to and fro
                    continue
                a, b = points[starts[own]], points[ends[own]]
                around = ((beside >= a.min(axis=0)) & (beside <= a.max(axis=0))).all(axis=1)  # elsewhere it is 0
                side[open_[around], k] = winding_number(beside[around], a, b)
        fits = (left - right == net).all(axis=1) & (left != ON_BOUNDARY).all(axis=1)
        open_ = np.flatnonzero(~fits)
        if not len(open_):
            return left, right
        offset *= OFFSET_SHRINK
    raise InvalidMeshError(
        f"Edges near {place(middle[open_[0]])} are too close to tell which side is inside; move them apart."
    )


def _linked(points: FloatArray, tails: IntArray, heads: IntArray) -> list[IntArray]:
    """Loops of indices from directed edges with the inside to their left.

    Where several leave a point the sharpest right turn is taken: a loop goes around one empty place.
    """
    leaving: dict[int, list[int]] = {}
    for edge, tail in enumerate(tails.tolist()):
        leaving.setdefault(tail, []).append(edge)
    onward = np.empty(len(tails), dtype=np.int64)
    for edge, head in enumerate(heads.tolist()):
        choices = leaving.get(head, [])
        if not choices:
            raise InvalidMeshError(f"The shapes' outline is open near {place(points[head])}; move its points apart.")
        sharpest = 0
        if len(choices) > 1:
            angles = _empty_angle(points, np.full(len(choices), tails[edge]), head, heads[choices])
            sharpest = int(angles.argmin())
        onward[edge] = choices[sharpest]
    loops = []
    open_ = set(range(len(tails)))
    while open_:
        edge = open_.pop()
        loop = [edge]
        while onward[loop[-1]] in open_:
            loop.append(int(onward[loop[-1]]))
            open_.discard(loop[-1])
        if onward[loop[-1]] != edge:
            raise InvalidMeshError(f"The shapes' outline branches near {place(points[tails[edge]])}; move it apart.")
        loops.append(tails[loop])
    return loops


def _empty_angle(points: FloatArray, before: IntArray, at: int | IntArray, after: IntArray) -> FloatArray:
    """Radians in (0, 2π] from the way back around to the way on, on the right of a path through points."""
    back, on = points[before] - points[at], points[after] - points[at]
    turn = np.arctan2(back[:, 0] * on[:, 1] - back[:, 1] * on[:, 0], (back * on).sum(axis=1))
    return np.asarray(np.where(turn > 0.0, turn, turn + 2.0 * np.pi))


def _apart(points: FloatArray, loops: list[IntArray], diagonal: float) -> list[FloatArray]:
    """The loops (k, 2); where they touch in a point each is pulled off it, into the empty place that it goes around.

    What touches becomes one by a neck as thin as a hair, so that nothing is cut off.
    """
    crowded = np.bincount(np.concatenate(loops)) > 1
    found = []
    for loop in loops:
        moved = points[loop].copy()
        place = np.flatnonzero(crowded[loop])
        before, at, after = np.roll(loop, 1)[place], loop[place], np.roll(loop, -1)[place]
        back, on = points[before] - points[at], points[after] - points[at]
        half = _empty_angle(points, before, at, after) / 2.0
        length = np.hypot(*back.T)
        along = back / length[:, None]
        reach = np.minimum(PULLED * np.minimum(length, np.hypot(*on.T)), FARTHEST_PULLED * diagonal)[:, None]
        across = np.stack((-along[:, 1], along[:, 0]), axis=1)
        moved[place] += reach * (np.cos(half)[:, None] * along + np.sin(half)[:, None] * across)
        found.append(moved)
    return found
