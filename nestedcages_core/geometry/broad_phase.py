"""Broad phase: the point-edge pairs within a radius, without measuring all pairs.

Few pairs are all tested by the bounding boxes of the edges. For more, points sorted along x are looked up in the boxes,
where these are narrow. For many, edges are cut into pieces no longer than a grid cell, so that long coarse edges next
to short fine ones cost no more than their length; each piece looks up the cells around it in the points sorted by cell.
A pair found by several pieces is kept only by the piece that holds its closest point, so no duplicates arise.
"""

from __future__ import annotations

import numpy as np

from .arrays import FloatArray, IntArray
from .distance import SMALLEST_LENGTH
from .predicates.sweep import expanded
from .vectors import bounds

TREE_COST, TREE_START = 80, 20_000
"""Cost of a tree per point or edge, and of starting it, in pairs that could be measured in that time (measured)."""

CACHED_PAIRS = 16_384
"""Pairs measured together: their arrays stay in the processor's cache (measured)."""

IMPORT_PAIRS = 1_000_000
"""Pairs that are measured in less time than it takes to import trees (measured)."""

STRIPS_FROM, STRIPS_LIMIT = 4000, 2_000_000
"""Numbers of pairs between which points are sorted first (measured)."""

STRIP_COST = 5
"""Time for a pair in a strip, in tests of a point against a box (measured)."""

ALL_BOXES_LIMIT = 200_000
"""Number of tests of points against boxes up to which a grid takes longer (measured)."""

PIECES, LEAST_CELLS = 0.25, 16
"""Cells along all edges together, per point and edge, and along the longer side at least (measured)."""

CROWD, FINER = 32, 0.25
"""Tests for each piece of an edge above which cells are made smaller, as where points crowd; how much (measured)."""

CHUNK_PAIRS = 2_000_000
"""Pairs measured together; bounds the memory to about 300 MB."""


def few_pairs(points: int, edges: int) -> bool:
    """Whether measuring all pairs is faster than a tree."""
    return points * edges <= TREE_COST * (points + edges) + TREE_START


def blocks(points: FloatArray, edges: int) -> list[FloatArray]:
    """The points (P, 2) in blocks of about CACHED_PAIRS pairs with the edges each; at least one block."""
    rows = max(1, CACHED_PAIRS // max(1, edges))
    return [points[first : first + rows] for first in range(0, max(len(points), 1), rows)]


def nearest(points: FloatArray, others: FloatArray) -> tuple[FloatArray, IntArray]:
    """(P,) distance of points (P, 2) from the nearest of others (Q, 2), and which that is."""
    if len(points) * len(others) > IMPORT_PAIRS:
        import scipy

        distance, which = scipy.spatial.cKDTree(others).query(points)
        return distance, which.astype(np.int64)
    (x, y), parts = others.T.copy(), []
    for part in blocks(points, len(others)):
        parts.append(((part[:, :1] - x) ** 2 + (part[:, 1:] - y) ** 2).argmin(axis=1))
    which = np.concatenate(parts)
    return np.hypot(*(points - others[which]).T), which


def near_pairs(points: FloatArray, starts: FloatArray, ends: FloatArray, radius: float) -> tuple[IntArray, IntArray]:
    """Indices (point, edge) of all pairs closer than ``radius``.

    points: (P, 2); starts, ends: (E, 2); radius: a length. Returns two (K,) index arrays, in any order.
    """
    if len(points) == 0 or len(starts) == 0:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    # coordinate by coordinate: gathering from columns takes a seventh of the time of gathering rows
    p, a, b = points.T.copy(), starts.T.copy(), ends.T.copy()
    low, high = np.minimum(a, b), np.maximum(a, b)
    low -= radius
    high += radius
    tests = len(points) * len(starts)
    pair = _in_strips(p, low, high) if STRIPS_FROM < tests <= STRIPS_LIMIT else None
    if pair is None:
        if tests > ALL_BOXES_LIMIT:
            return _near_pairs_by_cells(p, a, b, radius)
        pair = _in_boxes(p, low, high)
    j = pair // len(points)
    i = pair - j * len(points)
    close = (_of_pairs(p, a, b, i, j)[0] < radius).nonzero()[0]
    return i.take(close), j.take(close)


def _in_boxes(p: FloatArray, low: FloatArray, high: FloatArray) -> IntArray:
    """The pairs, as numbers edge · P + point, of points (2, P) in boxes (2, E), (2, E); ascending, (K,)."""
    (x, y), (left, down), (right, up) = p, low[:, :, None], high[:, :, None]
    inside = x >= left
    inside &= x <= right
    inside &= y >= down
    inside &= y <= up
    pair: IntArray = inside.ravel().nonzero()[0]
    return pair


def _in_strips(p: FloatArray, low: FloatArray, high: FloatArray) -> IntArray | None:
    """`_in_boxes` by points sorted along x; None where the boxes are too wide for that."""
    order = p[0].argsort()
    x, y = p.take(order, axis=1)
    first = x.searchsorted(low[0])
    count = x.searchsorted(high[0], "right") - first
    if count.sum() * STRIP_COST > min(p.shape[1] * len(first), ALL_BOXES_LIMIT):
        return None
    j, place = expanded(first, count)
    y = y.take(place)
    inside = y >= low[1].take(j)
    inside &= y <= high[1].take(j)
    held = inside.nonzero()[0]
    pair: IntArray = j.take(held) * p.shape[1] + order.take(place.take(held))
    pair.sort()
    return pair


def _of_pairs(p: FloatArray, a: FloatArray, b: FloatArray, i: IntArray, j: IntArray) -> tuple[FloatArray, FloatArray]:
    """(K,), (K,) distance and parameter of `point_edge` between points i and edges j, of coordinates (2, P) and (2, E),
    (2, E)."""
    edge_x, edge_y = b - a
    squared_length = np.maximum(edge_x * edge_x + edge_y * edge_y, SMALLEST_LENGTH**2).take(j)
    edge_x, edge_y = edge_x.take(j), edge_y.take(j)
    x = p[0].take(i) - a[0].take(j)
    y = p[1].take(i) - a[1].take(j)
    parameter = x * edge_x + y * edge_y
    parameter /= squared_length
    np.maximum(parameter, 0.0, out=parameter)
    np.minimum(parameter, 1.0, out=parameter)
    x -= parameter * edge_x
    y -= parameter * edge_y
    x *= x
    y *= y
    x += y
    return np.sqrt(x, out=x), parameter


def _near_pairs_by_cells(p: FloatArray, a: FloatArray, b: FloatArray, radius: float) -> tuple[IntArray, IntArray]:
    """`near_pairs` of coordinates (2, P) and (2, E), (2, E)."""
    points, starts, ends = p.T, a.T, b.T
    low, high = bounds(np.concatenate([points, starts, ends]))
    lengths = np.hypot(*(ends - starts).T)
    pieces = PIECES * (len(points) + len(starts))
    cell = max(radius, min(float(lengths.sum()) / pieces, float((high - low).max()) / LEAST_CELLS), SMALLEST_LENGTH)
    while True:
        columns, rows = (np.floor((high - low) / cell).astype(np.int64) + 1).tolist()

        # points sorted by cell
        cell_of_point = np.floor((points - low) / cell).astype(np.int64)
        code = cell_of_point[:, 0] * rows + cell_of_point[:, 1]
        order = np.argsort(code, kind="stable")
        code = code[order]

        # pieces of edges, and for each the columns that its neighbourhood covers
        piece_count = np.maximum(np.ceil(lengths / cell).astype(np.int64), 1)
        edge = np.repeat(np.arange(len(starts)), piece_count)
        place = position_in_group(piece_count)
        direction = (ends - starts)[edge]
        piece_start = starts[edge] + (place / piece_count[edge])[:, None] * direction
        piece_end = starts[edge] + ((place + 1) / piece_count[edge])[:, None] * direction
        from_cell = np.floor((np.minimum(piece_start, piece_end) - radius - low) / cell).astype(np.int64)
        to_cell = np.floor((np.maximum(piece_start, piece_end) + radius - low) / cell).astype(np.int64)
        np.maximum(from_cell, 0, out=from_cell)
        np.minimum(to_cell, [columns - 1, rows - 1], out=to_cell)
        covered = np.maximum(to_cell[:, 0] - from_cell[:, 0] + 1, 0)
        piece = np.repeat(np.arange(len(edge)), covered)
        column = position_in_group(covered) + from_cell[piece, 0]
        begin = np.searchsorted(code, column * rows + from_cell[piece, 1])
        count = np.maximum(np.searchsorted(code, column * rows + to_cell[piece, 1], "right") - begin, 0)
        if cell <= max(radius, SMALLEST_LENGTH) or count.sum() <= CROWD * len(edge):
            break
        cell = max(radius, FINER * cell, SMALLEST_LENGTH)
    occupied = count > 0
    piece, begin, count = piece[occupied], begin[occupied], count[occupied]

    found: list[tuple[IntArray, IntArray]] = []
    total = np.cumsum(count)
    low_item = 0
    while low_item < len(piece):
        done = total[low_item - 1] if low_item else 0
        high_item = max(low_item + 1, int(np.searchsorted(total, done + CHUNK_PAIRS)))
        counts = count[low_item:high_item]
        item = np.repeat(np.arange(low_item, high_item), counts)
        i = order[position_in_group(counts) + begin[item]]
        j = edge[piece[item]]
        distance, parameter = _of_pairs(p, a, b, i, j)
        close = (distance < radius).nonzero()[0]
        i, j = i.take(close), j.take(close)
        holder = np.minimum((parameter.take(close) * piece_count.take(j)).astype(np.int64), piece_count.take(j) - 1)
        keep = holder == place.take(piece.take(item.take(close)))
        found.append((i[keep], j[keep]))
        low_item = high_item
    if not found:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    return np.concatenate([i for i, _ in found]), np.concatenate([j for _, j in found])


def position_in_group(counts: IntArray) -> IntArray:
    """0, 1, …, counts[0]-1, 0, 1, …, counts[1]-1, …: the position of every member in its group."""
    return np.arange(int(counts.sum())) - np.repeat(np.cumsum(counts) - counts, counts)


def split_by(group: IntArray, count: int) -> list[IntArray]:
    """The indices of each of some groups, ascending; group: (K,) that of each index."""
    return np.split(np.argsort(group, kind="stable"), np.cumsum(np.bincount(group, minlength=count))[:-1])
