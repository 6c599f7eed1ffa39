"""Shortcut hulls (Bonerath et al. 2023) of least area with at most m vertices, each on a vertex of the shape: exact.

A chord of a loop that lies outside of the solid, or along it, cuts off an area. A closed walk of at most k chords, once
around the loop, is a hull of it; the cheapest of each k is found by min-plus products from every possible first vertex,
and a knapsack shares m among the loops. A hull touches the shape. It can touch itself, and loops are looked at one by
one. It has every corner of the convex hull among its vertices, so a round shape has none with few.
"""

from __future__ import annotations

import numpy as np
import shapely

from nestedcages_core import Mesh

MOST_VERTICES = 700
"""Of a loop: chords are its square, and each is tested."""
FEWEST = 3
"""Vertices of a loop."""


def shortcut_hull(fine: Mesh, count: int, solid: shapely.Geometry) -> shapely.Geometry | None:
    """The hull of least area with at most ``count`` vertices; None if a loop is too long, or where there is none."""
    loops = [fine.vertices[loop] for loop in fine.loops]
    most = count - FEWEST * (len(loops) - 1)
    if max(map(len, loops)) > MOST_VERTICES or most < FEWEST:
        return None
    tables = [cheapest(loop, chords(loop, solid), sign > 0, most)
              for loop, sign in zip(loops, fine.loop_signs, strict=True)]  # fmt: skip
    shared = [(0.0, ())] + [(np.inf, ())] * count  # at most so many vertices -> area, vertices of each loop
    for table in tables:
        shared = [
            min(
                ((shared[k - j][0] + table[j][0], (*shared[k - j][1], j)) for j in range(FEWEST, min(k, most) + 1)),
                default=(np.inf, ()),
            )
            for k in range(count + 1)
        ]
    area, shares = shared[count]
    if not np.isfinite(area):
        return None
    rings = [loop[table[j][1]] for loop, table, j in zip(loops, tables, shares, strict=True)]
    outer = [shapely.Polygon(ring) for ring, sign in zip(rings, fine.loop_signs, strict=True) if sign > 0]
    holes = [shapely.Polygon(ring) for ring, sign in zip(rings, fine.loop_signs, strict=True) if sign < 0]
    return shapely.union_all(outer).difference(shapely.union_all(holes))


def chords(loop: np.ndarray, solid: shapely.Geometry) -> np.ndarray:
    """(n, n) area that a chord from vertex i on to j cuts off outside of the solid; infinite if it enters the solid."""
    n = len(loop)
    i, j = (index.ravel() for index in np.indices((n, n)))
    segments = shapely.linestrings(np.stack([loop[i], loop[j]], axis=1))
    shapely.prepare(solid)
    outside = (i != j) & ~shapely.relate_pattern(solid, segments, "T********")
    following = np.roll(loop, -1, axis=0)
    swept = np.concatenate(([0.0], np.cumsum(cross(loop, following))))
    area = 0.5 * (cross(loop[i], loop[j]) - (swept[j] - swept[i] + swept[-1] * (j < i)))
    scale = np.ptp(loop, axis=0).max() ** 2
    return np.where(outside & (area > -1e-12 * scale), np.maximum(area, 0.0), np.inf).reshape(n, n)


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def cheapest(loop: np.ndarray, area: np.ndarray, outer: bool, most: int) -> list[tuple[float, list[int]]]:
    """The cheapest closed walks of at most k chords, k = 0 … most: area and vertices."""
    n = len(loop)
    best: list[tuple[float, list[int]]] = [(np.inf, [])] * (most + 1)
    starts = [int(np.lexsort(loop.T)[0])] if outer else range(n)  # an extreme vertex is on every hull of an outer loop
    for start in starts:
        turned = np.roll(np.roll(area, -start, axis=0), -start, axis=1)
        step = np.where(np.triu(np.ones((n, n), bool), 1), turned, np.inf)
        least, paths = step[0], []
        for k in range(2, most + 1):
            closed = least + turned[:, 0]
            end = int(closed[1:].argmin()) + 1
            if closed[end] < best[k][0]:
                walk = [end]
                for path in reversed(paths):
                    walk.append(int(path[walk[-1]]))
                best[k] = (float(closed[end]), [(start + place) % n for place in (0, *walk[::-1])])
            sums = least[:, None] + step
            paths.append(sums.argmin(axis=0))
            least = sums.min(axis=0)
    for k in range(1, most + 1):
        best[k] = min(best[k - 1], best[k], key=lambda found: found[0])
    return best
