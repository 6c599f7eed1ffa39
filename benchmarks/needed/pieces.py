"""Convex pieces of cages next to one pass of Hertel and Mehlhorn, and to the fewest without new vertices."""

from __future__ import annotations

import time
from collections.abc import Mapping
from math import inf

import numpy as np
import shapely

from nestedcages_core import Mesh, NestedCagesError, convex_pieces, nested_cages
from nestedcages_core.geometry.predicates import orientation
from nestedcages_core.geometry.triangulation import piece_vertices

from .table import Table

COUNTS = (12, 24)
"""Vertices of the cages."""

LIMITS = (8, 1000)
"""Vertices of a piece: Box2D's limit, and none."""

ROUND = 1e-9
"""Distance of a vertex from a diagonal, in diagonals of the cage, up to which it is on it."""


def table(shapes: Mapping[str, Mesh]) -> Table:
    """Numbers of pieces."""
    made = Table(
        [
            "shape, vertices",
            *(f"{_name(most)}: {what}" for most in LIMITS for what in ("ours", "one pass", "fewest")),
            "ms",
        ],
        before="`python benchmarks/needs.py pieces`: convex pieces of cages, of at most 8 vertices and of any number; "
        "one pass that removes diagonals, the longest first (Hertel & Mehlhorn 1983); and the fewest that there can be "
        "without new vertices, by dynamic programming over all partitions, for cages without holes. CPU milliseconds.",
    )
    compared = equal = 0
    for name, fine in shapes.items():
        for count in COUNTS:
            try:
                cage = nested_cages(fine, [count]).cages[0]
            except NestedCagesError:
                continue
            cells: list[str] = []
            begin = time.process_time()
            ours = [convex_pieces(cage, most) for most in LIMITS]
            spent = (time.process_time() - begin) / len(LIMITS)
            for most, pieces in zip(LIMITS, ours, strict=True):
                area = sum(shapely.Polygon(piece).area for piece in pieces)
                made.good = made.good and abs(area / cage.area - 1.0) < 1e-12 and max(map(len, pieces)) <= most
                greedy = len(piece_vertices(cage, most, orders=1))
                least = fewest(cage.vertices[cage.loops[0]], most) if len(cage.loops) == 1 else inf
                compared += least < inf
                equal += len(pieces) == least
                cells += [str(len(pieces)), str(greedy), str(least) if least < inf else "–"]
            made.rows.append([f"{name}, {len(cage.vertices)}", *cells, f"{1e3 * spent:.0f}"])
    made.after = f"{equal} of {compared} that can be compared have the fewest pieces that there can be."
    return made


def _name(most: int) -> str:
    return f"at most {most}" if most == LIMITS[0] else "any"


def fewest(loop: np.ndarray, most: int) -> float:
    """Fewest convex pieces of a polygon (n, 2), counter-clockwise, by its diagonals; O(n^5).

    A piece at the base i-j is a convex chain from i to j; below each of its edges lies a polygon of its own.
    """
    n = len(loop)
    seen = _visible(loop)
    a, b, c = np.meshgrid(*[np.arange(n)] * 3, indexing="ij")
    left = orientation(loop[a.ravel()], loop[b.ravel()], loop[c.ravel()]).reshape(n, n, n) >= 0
    pieces = np.full((n, n), inf)
    pieces[np.arange(n - 1), np.arange(1, n)] = 0
    for gap in range(2, n):
        for i in range(n - gap):
            j = i + gap
            if not seen[i, j]:
                continue
            chains: dict[tuple[int, int, int], float] = {
                (i, k, 2): pieces[i, k] for k in range(i + 1, j) if seen[i, k] and left[j, i, k]
            }
            for end in range(i + 1, j):
                for (before, at, used), cost in [item for item in chains.items() if item[0][1] == end]:
                    for k in range(end + 1, j + 1) if used < most and cost < pieces[i, j] else ():
                        if not seen[end, k] or not left[before, end, k]:
                            continue
                        total = cost + pieces[end, k]
                        if k < j:
                            state = (at, k, used + 1)
                            chains[state] = min(chains.get(state, inf), total)
                        elif left[end, j, i]:
                            pieces[i, j] = min(pieces[i, j], total + 1)
    return float(pieces[0, n - 1]) if pieces[0, n - 1] == inf else int(pieces[0, n - 1])


def _visible(loop: np.ndarray) -> np.ndarray:
    """(n, n) whether two vertices are joined by an edge, or by a diagonal inside that meets no other vertex."""
    n = len(loop)
    polygon, corners = shapely.Polygon(loop), shapely.points(loop)
    first, second = np.triu_indices(n, 1)
    lines = shapely.linestrings(np.stack([loop[first], loop[second]], axis=1))
    inside = shapely.covers(polygon, lines)
    close = shapely.distance(lines[:, None], corners[None]) < ROUND * np.hypot(*np.ptp(loop, axis=0))
    seen = np.zeros((n, n), dtype=bool)
    seen[first, second] = inside & (close.sum(axis=1) == 2)
    seen[np.arange(n - 1), np.arange(1, n)] = seen[0, n - 1] = True
    return seen
