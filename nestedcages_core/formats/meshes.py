"""Geometries of other programs, and what is given to a writer, as meshes."""

from __future__ import annotations

import math
import re
import sys
import warnings
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ..errors import InvalidMeshError, NestedCagesWarning
from ..geometry.arrays import FloatArray
from ..geometry.drawable import Drawable
from ..geometry.mesh import Mesh
from ..geometry.mesh.closeness import TOUCHING, has_gaps
from ..geometry.vectors import format_point
from .geometries import Polygon, polygons_of, without_repeated_points

SAME_AREA = 1e-6
"""Relative change of area up to which a polygon that touches itself is taken for what it says."""

NO_SHAPE = "mesh.empty", "mesh.out_of_range", "mesh.not_finite", "mesh.unreadable"
"""Faults of geometries that cannot be repaired."""


def mesh_of(geometry: Any, *, strict: bool = False, inside: bool = False) -> Mesh:
    """The mesh of a geometry with `__geo_interface__`, or of such a mapping; see `Mesh.of`.

    Parameters
    ----------
    geometry : Any
        As `polygons_of` reads it.
    strict : bool, optional
        Reject what touches or overlaps. Default: unite it, with a NestedCagesWarning that names each change.
    inside : bool, optional
        For cages inside: the mesh lies in the polygons. Default: the polygons lie in it.

    Raises
    ------
    InvalidMeshError
        For what is no geometry, is empty or crosses itself, and if strict where a polygon lies inside another one, or
        a hole outside its polygon.
    """
    if strict:
        return _of_polygons(polygons_of(geometry))
    left_out: Counter[str] = Counter()
    polygons = polygons_of(geometry, left_out=left_out)
    changes: list[str] = []
    try:
        mesh = _of_polygons([[without_repeated_points(ring) for ring in polygon] for polygon in polygons])
    except InvalidMeshError as error:
        if error.code in NO_SHAPE or any(map(_crosses_itself, polygons)):
            raise
        mesh, changes = mesh_of_polygons(polygons, inside=inside)
    if changes:
        said = f"The geometry was repaired: {'; '.join(changes)}."
        warnings.warn(said, NestedCagesWarning, stacklevel=_outside())
    if left_out:
        warnings.warn(f"{left_out_of(left_out)}.", NestedCagesWarning, stacklevel=_outside())
    return mesh


def mesh_of_polygons(polygons: Sequence[Polygon], *, inside: bool = False, **options: Any) -> tuple[Mesh, list[str]]:
    """The solid of polygons, each an outer ring (k, 2) and its holes, and a sentence on each change.

    Polygons that are apart from each other keep their coordinates, and need no shapely. Others become what GEOS makes
    of them (`shapely.make_valid`, by structure), with thin strips along rings that are not in it.

    options: those of `solids.solid`. Raises as that.
    """
    polygons = [[without_repeated_points(ring) for ring in polygon] for polygon in polygons]
    notes: list[str] = []
    if not options.get("specks"):
        try:
            mesh = _of_polygons(polygons)
            if not has_gaps(mesh, TOUCHING * mesh.diagonal):
                return mesh, []
        except InvalidMeshError as error:
            notes.append(f"{str(error).split(';')[0].rstrip('.').lower()}: united")
    from .solids import shapely, solid, spend

    areas, lines = list[Any](), list[FloatArray]()
    for polygon in polygons:
        loops = [ring for ring in polygon if len(ring) > 2]
        part = shapely.Polygon(polygon[0], loops[1:]) if len(polygon[0]) > 2 else shapely.Polygon()
        if len(loops) < len(polygon) or not part.is_valid:
            notes.append(f"{_fault(shapely, part)}: united" if loops else "a polygon of zero area: a thin strip")
            spend([shapely.boundary(part)], options.get("quota"), own=True)
            whole = shapely.make_valid(part, method="structure", keep_collapsed=False)
            shell = shapely.make_valid(shapely.Polygon(part.exterior), method="structure", keep_collapsed=False)
            part = whole & shell if inside else whole
            lines += [] if inside else [ring for ring in polygon if len(ring)]
        areas.append(part)
    return solid(areas, inside=inside, lines=lines, notes=notes, **options), notes


def _crosses_itself(polygon: Polygon) -> bool:
    """Whether a polygon is invalid and has another area than its rings say."""
    from .solids import shapely

    rings = [ring for ring in polygon if len(ring) > 2]
    part = shapely.Polygon(rings[0], rings[1:]) if rings else shapely.Polygon()
    whole = part if part.is_valid else shapely.make_valid(part, method="structure", keep_collapsed=False)
    return not math.isclose(whole.area, part.area, rel_tol=SAME_AREA)


def _fault(shapely: Any, shape: Any) -> str:
    """What GEOS says of an invalid polygon, and the place in user coordinates."""
    text = shapely.is_valid_reason(shape)
    parts = re.fullmatch(r"(.*)\[(\S+) (\S+).*\]", text)
    return f"{parts[1].lower()} at {format_point((float(parts[2]), float(parts[3])))}" if parts else text.lower()


def _of_polygons(polygons: Sequence[Polygon]) -> Mesh:
    """The mesh of polygons that neither touch nor lie in each other. Raises InvalidMeshError for others."""
    polygons = [polygon for polygon in polygons if any(map(len, polygon))]
    if not polygons:
        raise InvalidMeshError("The geometry is empty; give at least one polygon.", code="mesh.empty")
    mesh = Mesh.from_loops([ring for polygon in polygons for ring in polygon])
    first = 0
    for k, polygon in enumerate(polygons):
        own = slice(first, first + len(polygon))
        roles, owners = mesh.loop_signs[own], mesh.component_of_loop[own]
        if roles[0] < 0:
            raise InvalidMeshError(
                f"Polygon {k} near {format_point(polygon[0][0])} lies inside another one; unite them or remove one.",
                code="mesh.nesting",
            )
        if (roles[1:] > 0).any() or (owners != owners[0]).any():
            raise InvalidMeshError(
                f"A hole of polygon {k} near {format_point(polygon[0][0])} is not directly in it; move or remove it.",
                code="mesh.nesting",
            )
        first += len(polygon)
    return mesh


def meshes_of(shapes: Any) -> list[Mesh]:
    """The meshes of a result, the items of a list of meshes, or one shape as a mesh. Raises InvalidMeshError."""
    if isinstance(shapes, Drawable):
        return list(shapes.meshes)
    if not isinstance(shapes, np.ndarray | str) and isinstance(shapes, Iterable):
        shapes = list(shapes)
        meshes = [item for item in shapes if isinstance(item, Mesh)]
        if len(meshes) == len(shapes):
            return meshes
    return [Mesh.of(shapes)]


def left_out_of(kinds: Mapping[str, int]) -> str:
    """What was left out, in words; kinds: the number of geometries of each type."""
    return f"Left out, without an inside: {', '.join(f'{number} {kind}' for kind, number in kinds.items())}"


def _outside() -> int:
    """The level of the stack, as `warnings.warn` counts it for its caller, of the first frame that is not ours."""
    package, frame, level = f"{__name__.rsplit('.', 2)[0]}.", sys._getframe(1), 1
    while frame.f_back is not None and f"{frame.f_globals.get('__name__')}.".startswith(package):
        frame, level = frame.f_back, level + 1
    return level
