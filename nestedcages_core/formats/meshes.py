"""Shapes of other programs, and what is given to a writer, as meshes."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable
from typing import Any

import numpy as np

from ..errors import InvalidMeshError, NestedCagesWarning
from ..geometry.drawable import Drawable
from ..geometry.mesh import Mesh
from .geometries import Polygon, check_roles, polygons_of

NO_SHAPE = "mesh.empty", "mesh.out_of_range", "mesh.not_finite", "mesh.unreadable"
"""Faults of geometries that no repair mends."""


def mesh_of(geometry: Any, *, strict: bool = False) -> Mesh:
    """The mesh of a geometry with `__geo_interface__`, or of such a mapping; see `Mesh.of`.

    Parameters
    ----------
    geometry : Any
        As `polygons_of` reads it.
    strict : bool, optional
        Reject what touches or repeats points. Default: repair it, with a NestedCagesWarning that names each repair.

    Returns
    -------
    Mesh

    Raises
    ------
    InvalidMeshError
        For what is no geometry, is empty or crosses itself, and where a polygon lies inside another one, or a hole
        outside its polygon.
    """
    if strict:
        return _of_polygons(polygons_of(geometry))
    left_out: list[str] = []
    polygons = polygons_of(geometry, left_out=left_out)
    try:
        mesh = _of_polygons(polygons)
    except InvalidMeshError as error:
        from .repair import repaired_geometry

        repaired = None if error.code in NO_SHAPE else repaired_geometry(polygons)
        if repaired is None:
            raise
        mesh = repaired[0]
        left_out += repaired[1]
    if left_out:
        said = f"The geometry was repaired: {'; '.join(left_out)}."
        warnings.warn(said, NestedCagesWarning, stacklevel=_outside())
    return mesh


def _of_polygons(polygons: list[Polygon]) -> Mesh:
    polygons = [polygon for polygon in polygons if any(map(len, polygon))]
    if not polygons:
        raise InvalidMeshError("The geometry is empty; give at least one polygon.", code="mesh.empty")
    mesh = Mesh.from_loops([ring for polygon in polygons for ring in polygon])
    check_roles(polygons, mesh.loop_signs, mesh.component_of_loop)
    return mesh


def _outside() -> int:
    """The level of the stack, as `warnings.warn` counts it for its caller, of the first frame that is not ours."""
    package, frame, level = f"{__name__.rsplit('.', 2)[0]}.", sys._getframe(1), 1
    while frame.f_back is not None and f"{frame.f_globals.get('__name__')}.".startswith(package):
        frame, level = frame.f_back, level + 1
    return level


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
