"""What others make of a shape: shapely's buffer and simplify, GEOS's polygon hull, and shortcut hulls."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely

from nestedcages_core import Mesh, NestedCagesError, verify

HALVINGS = 20  # trials that each recipe gets to come down to a number of vertices
MOST_VERTICES = 700  # of a loop for a shortcut hull: chords are its square, and each is tested
LEAST = 3  # vertices of a loop


class Peer(NamedTuple):
    """What a recipe made of a shape."""

    seconds: float  # CPU seconds
    excess: float  # per cent
    vertices: int
    verdict: str
    """What our certificate says: certified, touching (inside but for touching), other loops, leaking or invalid."""


def solid(mesh: Mesh) -> shapely.Geometry:
    return shapely.normalize(shapely.geometry.shape(mesh.__geo_interface__))


def corners(shape: shapely.Geometry) -> int:
    """Vertices of the rings, each counted once."""
    rings = shapely.get_rings(shapely.get_parts(shape))
    return int(shapely.get_num_coordinates(rings).sum()) - len(rings)


def judged(shape: shapely.Geometry, fine: Mesh, begin: float, *, inside: bool = False) -> Peer:
    """A result with its time, and what our certificate says of it."""
    seconds = time.process_time() - begin
    outer, inner = (solid(fine), shape) if inside else (shape, solid(fine))
    try:
        mesh = Mesh.from_geometry(shape)
        certificate = verify(fine, mesh) if inside else verify(mesh, fine)
        touching = "touching" if certificate.clearance == 0.0 else "other loops"
        verdict = "certified" if certificate.holds else touching if outer.covers(inner) else "leaking"
    except NestedCagesError:
        verdict = "invalid"
    return Peer(seconds, 100.0 * (shape.area / fine.area - 1.0), corners(shape), verdict)


def searched(recipe: Callable[[float], shapely.Geometry], count: int, fine_end: float, coarse_end: float):
    """The recipe's last result with at most so many vertices, or its coarsest one, by bisection on a log scale."""
    best = recipe(coarse_end)
    for _ in range(HALVINGS):
        middle = float(np.sqrt(fine_end * coarse_end))
        result = recipe(middle)
        if corners(result) > count:
            fine_end = middle
        else:
            coarse_end, best = middle, result
    return best


def buffer_and_simplify(fine: Mesh, count: int) -> Peer:
    """Simplify, then grow by what that cut off, until few vertices are left."""
    begin, shape = time.process_time(), solid(fine)

    def recipe(tolerance: float) -> shapely.Geometry:
        simple = shape.simplify(tolerance, preserve_topology=True)
        return simple.buffer(tolerance, join_style="mitre").simplify(tolerance / 10)

    return judged(searched(recipe, count, 1e-5 * fine.diagonal, 0.5 * fine.diagonal), fine, begin)


def polygon_hull(fine: Mesh, count: int, *, inside: bool = False) -> Peer | None:
    """GEOS's outer or inner hull; None where the library that comes with shapely cannot be reached."""
    if geos() is None:
        return None
    begin, shape = time.process_time(), solid(fine)
    best = searched(lambda fraction: _hull(shape, fraction, outer=not inside), count, 1.0, 1e-6)
    return judged(best, fine, begin, inside=inside)


@cache
def geos() -> ctypes.CDLL | None:
    """The C interface of the GEOS library that shapely brings along."""
    folder = Path(shapely.__file__).parent.parent / "shapely.libs"
    for path in sorted(folder.glob("libgeos_c*")):
        library = ctypes.CDLL(str(path))
        if not hasattr(library, "GEOSPolygonHullSimplify_r"):
            continue
        pointer, size = ctypes.c_void_p, ctypes.c_size_t
        for name, result, arguments in (
            ("GEOS_init_r", pointer, []),
            ("GEOSGeomFromWKB_buf_r", pointer, [pointer, ctypes.c_char_p, size]),
            ("GEOSPolygonHullSimplify_r", pointer, [pointer, pointer, ctypes.c_uint, ctypes.c_double]),
            ("GEOSGeomToWKB_buf_r", pointer, [pointer, pointer, ctypes.POINTER(size)]),
            ("GEOSGeom_destroy_r", None, [pointer, pointer]),
            ("GEOSFree_r", None, [pointer, pointer]),
            ("GEOS_finish_r", None, [pointer]),
        ):
            getattr(library, name).restype, getattr(library, name).argtypes = result, arguments
        return library
    return None


def _hull(shape: shapely.Geometry, fraction: float, *, outer: bool) -> shapely.Geometry:
    library = geos()
    assert library is not None
    context, text, length = library.GEOS_init_r(), shapely.to_wkb(shape), ctypes.c_size_t()
    geometry = library.GEOSGeomFromWKB_buf_r(context, text, len(text))
    hull = library.GEOSPolygonHullSimplify_r(context, geometry, int(outer), fraction)
    written = library.GEOSGeomToWKB_buf_r(context, hull, ctypes.byref(length))
    result = shapely.from_wkb(ctypes.string_at(written, length.value))
    library.GEOSFree_r(context, written)
    for made in (hull, geometry):
        library.GEOSGeom_destroy_r(context, made)
    library.GEOS_finish_r(context)
    return result


def best_shortcut_hull(fine: Mesh, count: int) -> Peer | None:
    """The shortcut hull of least area; None where there is none."""
    begin = time.process_time()
    hull = shortcut_hull(fine, count, solid(fine))
    return None if hull is None else judged(hull, fine, begin)


def shortcut_hull(fine: Mesh, count: int, shape: shapely.Geometry) -> shapely.Geometry | None:
    """Bonerath et al. (2023), exact: at most so many vertices, each on one of the shape; None where there is none.

    A chord of a loop that lies outside of the solid, or along it, cuts off an area. A closed walk of at most k chords,
    once around the loop, is a hull of it; the cheapest of each k is found by min-plus products from every possible
    first vertex, and a knapsack shares the count among the loops. A hull touches the shape, and may touch itself.
    """
    loops = [fine.vertices[loop] for loop in fine.loops]
    most = count - LEAST * (len(loops) - 1)
    if max(map(len, loops)) > MOST_VERTICES or most < LEAST:
        return None
    tables = [_cheapest(loop, _chords(loop, shape), sign > 0, most)
              for loop, sign in zip(loops, fine.loop_signs, strict=True)]  # fmt: skip
    shared: list[tuple[float, tuple[int, ...]]] = [(0.0, ())] + [(np.inf, ())] * count
    for table in tables:  # at most so many vertices -> area, vertices of each loop
        shared = [
            min(
                ((shared[k - j][0] + table[j][0], (*shared[k - j][1], j)) for j in range(LEAST, min(k, most) + 1)),
                default=(np.inf, ()),
            )
            for k in range(count + 1)
        ]
    area, shares = shared[count]
    if not np.isfinite(area):
        return None
    rings = [shapely.Polygon(loop[table[j][1]]) for loop, table, j in zip(loops, tables, shares, strict=True)]
    outer, holes = ([one for one, sign in zip(rings, fine.loop_signs, strict=True) if sign == s] for s in (1, -1))
    return shapely.union_all(outer).difference(shapely.union_all(holes))


def _chords(loop: np.ndarray, shape: shapely.Geometry) -> np.ndarray:
    """(n, n) area that a chord from vertex i on to j cuts off outside of the solid; infinite if it enters the solid."""
    n = len(loop)
    i, j = (index.ravel() for index in np.indices((n, n)))
    segments = shapely.linestrings(np.stack([loop[i], loop[j]], axis=1))
    shapely.prepare(shape)
    outside = (i != j) & ~shapely.relate_pattern(shape, segments, "T********")
    swept = np.concatenate(([0.0], np.cumsum(_cross(loop, np.roll(loop, -1, axis=0)))))
    area = 0.5 * (_cross(loop[i], loop[j]) - (swept[j] - swept[i] + swept[-1] * (j < i)))
    scale = np.ptp(loop, axis=0).max() ** 2
    return np.where(outside & (area > -1e-12 * scale), np.maximum(area, 0.0), np.inf).reshape(n, n)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _cheapest(loop: np.ndarray, area: np.ndarray, outer: bool, most: int) -> list[tuple[float, list[int]]]:
    """The cheapest closed walks of at most k chords, k = 0 … most: area and vertices."""
    n = len(loop)
    best: list[tuple[float, list[int]]] = [(np.inf, [])] * (most + 1)
    for start in [int(np.lexsort(loop.T)[0])] if outer else range(n):  # an extreme vertex is on every outer hull
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


PEERS: dict[str, Callable[[Mesh, int], Peer | None]] = {
    "buffer, simplify": buffer_and_simplify,
    "GEOS's hull": polygon_hull,
    "shortcut hull": best_shortcut_hull,
}
