"""Fewest vertices within a distance, next to the lower bound and to what people do without us at the same tolerance."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

import shapely

from nestedcages_core import Mesh, NestedCagesError, Within, nested_cages, verify
from nestedcages_core.cache import forget
from nestedcages_core.tolerance.reach import reach

from .table import Table, per_cent

PARTS = (0.1, 0.03, 0.01, 0.003)
"""Distances, as fractions of the diagonal."""

ROUND = 64
"""Segments of a quarter of a circle around a corner, for the offset that Douglas-Peucker simplifies."""


def table(shapes: Mapping[str, Mesh]) -> Table:
    """Vertices of cages within a distance."""
    made = Table(
        ["shape, distance", "bound", "ours", "excess", "buffer, simplify", "offset, Douglas-Peucker", "seconds"],
        before="`python benchmarks/needs.py within`: vertices of cages within a distance, in diagonals, and the excess "
        "in per cent; no cage within it has fewer than the bound. Buffer and simplify: shapely's mitred buffer by half "
        "the distance, simplified by as much. Offset: the round one by half the distance, simplified by as much. A "
        "result that does not contain the shape, or goes farther than the distance, is marked. CPU seconds.",
    )
    far = close = rows = 0
    for name, fine in shapes.items():
        for part in PARTS:
            distance = part * fine.diagonal
            forget()
            begin = time.process_time()
            try:
                level = nested_cages(fine, [Within(distance=distance)]).levels[0]
            except NestedCagesError as error:
                made.rows.append([f"{name}, {part:g}", "", "none", "", "", "", f"{time.process_time() - begin:.1f}"])
                print(name, part, error)
                continue
            seconds = time.process_time() - begin
            count, bound = len(level.cage.vertices), level.report.fewest
            assert bound is not None
            good = verify(level.cage, fine, level.report.wanted_clearance) and reach(level.cage, fine) <= distance
            made.good = made.good and bool(good)
            rows += 1
            close += count - bound <= len(fine.loops)
            far = max(far, count - bound)
            peers = [by_recipe(fine, distance, recipe) for recipe in (mitred, rounded)]
            cells = [str(bound), str(count), per_cent(level.report.excess), *peers, f"{seconds:.1f}"]
            made.rows.append([f"{name}, {part:g}", *cells])
    made.after = f"{close} of {rows} are within one vertex per loop of the bound; the largest difference is {far}."
    return made


def mitred(shape: shapely.Geometry, distance: float) -> shapely.Geometry:
    """A mitred buffer, simplified."""
    return shape.buffer(0.5 * distance, join_style="mitre").simplify(0.5 * distance, preserve_topology=True)


def rounded(shape: shapely.Geometry, distance: float) -> shapely.Geometry:
    """A round offset, simplified by Douglas and Peucker's method without regard to topology."""
    return shape.buffer(0.5 * distance, quad_segs=ROUND).simplify(0.5 * distance, preserve_topology=False)


def by_recipe(fine: Mesh, distance: float, recipe: Callable[[shapely.Geometry, float], shapely.Geometry]) -> str:
    """The number of vertices, with a mark for what is not held."""
    shape = shapely.geometry.shape(fine.__geo_interface__)
    result = recipe(shape, distance)
    rings = shapely.get_rings(shapely.get_parts(result))
    count = int(shapely.get_num_coordinates(rings).sum()) - len(rings)
    faults = [] if result.is_valid and result.covers(shape) else ["leaks"]
    if not shape.buffer(distance * (1.0 + 1e-4), quad_segs=4 * ROUND).covers(result):
        faults.append("too far")
    if len(rings) != len(fine.loops):
        faults.append("other loops")
    return f"{count}{' (' + ', '.join(faults) + ')' if faults else ''}"
