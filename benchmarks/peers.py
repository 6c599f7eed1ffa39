"""What people use without us, on the same shapes: their time, their tightness, and whether they really contain.

python benchmarks/peers.py [--page]     # a table, and put into docs/method.md
"""

from __future__ import annotations

import ctypes
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely

import clone
from nestedcages_core import Mesh, NestedCagesError, nested_cages, verify
from shortcut_hulls import shortcut_hull

HALVINGS = 20
"""Trials that each recipe gets to come down to a number of vertices."""


class Peer(NamedTuple):
    """What a recipe made of a shape."""

    seconds: float
    """CPU seconds."""
    excess: float
    """Per cent."""
    vertices: int
    verdict: str
    """What our certificate says of it: certified, touching (inside but for touching), or leaking."""


def polygons(mesh: Mesh) -> shapely.Geometry:
    """The solid of a mesh."""
    return shapely.normalize(shapely.geometry.shape(mesh.__geo_interface__))


def buffer_and_simplify(fine: Mesh, count: int) -> Peer:
    """Simplify, then grow by what that cut off, until few vertices are left."""
    shape = polygons(fine)

    def recipe(tolerance: float) -> shapely.Geometry:
        simple = shape.simplify(tolerance, preserve_topology=True)
        return simple.buffer(tolerance, join_style="mitre").simplify(tolerance / 10)

    return _search(fine, count, 1e-5 * fine.diagonal, 0.5 * fine.diagonal, recipe)


def polygon_hull(fine: Mesh, count: int) -> Peer | None:
    """GEOS's outer hull of a polygon; None where the library that comes with shapely cannot be reached."""
    library = _geos()
    if library is None:
        return None
    shape = polygons(fine)
    return _search(fine, count, 1.0, 1e-6, lambda fraction: _hull(library, shape, fraction))


def best_shortcut_hull(fine: Mesh, count: int) -> Peer | None:
    """The shortcut hull of least area; None where there is none."""
    begin = time.process_time()
    hull = shortcut_hull(fine, count, polygons(fine))
    if hull is None:
        return None
    seconds = time.process_time() - begin
    return Peer(seconds, 100.0 * (hull.area / fine.area - 1.0), _corners(hull), _verdict(hull, fine))


PEERS: dict[str, Callable[[Mesh, int], Peer | None]] = {
    "buffer and simplify": buffer_and_simplify,
    "GEOS's hull": polygon_hull,
    "shortcut hull": best_shortcut_hull,
}
"""Recipes with shapely; hulls of GEOS as JTS has them; shortcut hulls (Bonerath et al. 2023)."""
SHOWN, COUNTS = ("comb", "glyph_B", "glyph_g", "star200"), (32, 64)
"""Shapes and vertex counts of the table."""


def main() -> int:
    from data import shape
    from page import measured

    lines = ["| shape, vertices | ours | " + " | ".join(PEERS) + " |", "| --- " * (2 + len(PEERS)) + "|"]
    for name in SHOWN:
        fine = shape(name)
        for count in COUNTS:
            begin = time.process_time()
            ours = 100.0 * nested_cages(fine, [count]).levels[0].report.excess
            cells = [f"{ours:.2f} %, {time.process_time() - begin:.2f} s"]
            for recipe in PEERS.values():
                peer = recipe(fine, count)
                told = "" if peer is None or peer.verdict == "certified" else f", {peer.verdict}"
                more = "" if peer is None or peer.vertices <= count else f", {peer.vertices} vertices"
                cells.append("none" if peer is None else f"{peer.excess:.2f} %, {peer.seconds:.2f} s{told}{more}")
            lines.append(f"| {name}, {len(fine.vertices)} in {count} | " + " | ".join(cells) + " |")
    table = "\n".join(lines)
    print(table)
    if "--page" in sys.argv:
        measured(clone.ROOT / "docs" / "method.md", "peers", "python benchmarks/peers.py --page", table, table)
    return 0


def inner_polygon_hull(fine: Mesh, count: int) -> Peer | None:
    """GEOS's inner hull of a polygon; None where the library that comes with shapely cannot be reached."""
    library = _geos()
    if library is None:
        return None
    shape = polygons(fine)
    begin, finest, coarsest = time.process_time(), 1.0, 1e-6
    best = _hull(library, shape, coarsest, outer=False)
    for _ in range(HALVINGS):
        middle = float(np.sqrt(finest * coarsest))
        result = _hull(library, shape, middle, outer=False)
        if _corners(result) > count:
            finest = middle
        else:
            coarsest, best = middle, result
    seconds = time.process_time() - begin
    excess = 100.0 * (best.area / fine.area - 1.0)
    return Peer(seconds, excess, _corners(best), _verdict_inside(best, fine))


def _search(
    fine: Mesh, count: int, fine_end: float, coarse_end: float, recipe: Callable[[float], shapely.Geometry]
) -> Peer:
    """The recipe's last result with at most so many vertices, or its coarsest one, by bisection on a log scale."""
    begin = time.process_time()
    best = recipe(coarse_end)
    for _ in range(HALVINGS):
        middle = float(np.sqrt(fine_end * coarse_end))
        result = recipe(middle)
        if _corners(result) > count:
            fine_end = middle
        else:
            coarse_end, best = middle, result
    seconds = time.process_time() - begin
    return Peer(seconds, 100.0 * (best.area / fine.area - 1.0), _corners(best), _verdict(best, fine))


def _corners(shape: shapely.Geometry) -> int:
    """Vertices of the rings, each counted once."""
    rings = shapely.get_rings(shapely.get_parts(shape))
    return int(shapely.get_num_coordinates(rings).sum()) - len(rings)


def _verdict(shape: shapely.Geometry, fine: Mesh) -> str:
    try:
        certificate = verify(Mesh.from_geometry(shape), fine)
    except NestedCagesError:
        return "invalid"
    if certificate.holds:
        return "certified"
    if not shape.covers(polygons(fine)):
        return "leaking"
    return "touching" if certificate.clearance == 0.0 else "other loops"


def _verdict_inside(shape: shapely.Geometry, fine: Mesh) -> str:
    try:
        certificate = verify(fine, Mesh.from_geometry(shape))
    except NestedCagesError:
        return "invalid"
    if certificate.holds:
        return "certified"
    if not polygons(fine).covers(shape):
        return "leaking"
    return "touching" if certificate.clearance == 0.0 else "other loops"


def _geos() -> ctypes.CDLL | None:
    """The C interface of the GEOS library that shapely brings along."""
    folder = Path(shapely.__file__).parent.parent / "shapely.libs"
    for path in sorted(folder.glob("libgeos_c*")):
        library = ctypes.CDLL(str(path))
        if not hasattr(library, "GEOSPolygonHullSimplify_r"):
            continue
        pointer, size = ctypes.c_void_p, ctypes.c_size_t
        library.GEOS_init_r.restype = pointer
        library.GEOSGeomFromWKB_buf_r.restype = pointer
        library.GEOSGeomFromWKB_buf_r.argtypes = [pointer, ctypes.c_char_p, size]
        library.GEOSPolygonHullSimplify_r.restype = pointer
        library.GEOSPolygonHullSimplify_r.argtypes = [pointer, pointer, ctypes.c_uint, ctypes.c_double]
        library.GEOSGeomToWKB_buf_r.restype = pointer
        library.GEOSGeomToWKB_buf_r.argtypes = [pointer, pointer, ctypes.POINTER(size)]
        library.GEOSGeom_destroy_r.argtypes = [pointer, pointer]
        library.GEOSFree_r.argtypes = [pointer, pointer]
        library.GEOS_finish_r.argtypes = [pointer]
        return library
    return None


def _hull(library: ctypes.CDLL, shape: shapely.Geometry, fraction: float, *, outer: bool = True) -> shapely.Geometry:
    """GEOS's outer or inner hull with a fraction of the vertices."""
    context = library.GEOS_init_r()
    text = shapely.to_wkb(shape)
    geometry = library.GEOSGeomFromWKB_buf_r(context, text, len(text))
    hull = library.GEOSPolygonHullSimplify_r(context, geometry, int(outer), fraction)
    length = ctypes.c_size_t()
    written = library.GEOSGeomToWKB_buf_r(context, hull, ctypes.byref(length))
    result = shapely.from_wkb(ctypes.string_at(written, length.value))
    library.GEOSFree_r(context, written)
    for made in (hull, geometry):
        library.GEOSGeom_destroy_r(context, made)
    library.GEOS_finish_r(context)
    return result


if __name__ == "__main__":
    sys.exit(main())
