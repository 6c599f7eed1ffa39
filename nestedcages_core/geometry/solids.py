"""Solids of meshes as polygons of shapely, for what unites or intersects them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..errors import InvalidMeshError
from ..libraries import load_shapely
from .arrays import FloatArray
from .broad_phase import BoxTree
from .distance import point_edge
from .mesh import Mesh
from .precision import INPUT_ROUND_OFF, ROUND_OFF
from .predicates import winding_number
from .vectors import cross, norm

OVERLAID_AT_ONCE = 8
"""Meshes: n that all overlap cross each other in n² places, but the unions of a few in about as many as they have
vertices."""


def mesh_of(solid: Any) -> Mesh:
    """The mesh of a solid. Raises InvalidMeshError."""
    return Mesh.from_loops(_rings(solid))


def overlay(meshes: Sequence[Mesh], *, intersection: bool = False) -> Mesh:
    """The union of the solids of some meshes, or their intersection, accurate to `ROUND_OFF`.

    Raises InvalidMeshError where the result is empty or its loops touch, NestedCagesError where shapely is missing.
    """
    while len(meshes) > 1:
        some = [meshes[k : k + OVERLAID_AT_ONCE] for k in range(0, len(meshes), OVERLAID_AT_ONCE)]
        meshes = [_overlay(few, intersection) for few in some]
    return meshes[0]


def _overlay(meshes: Sequence[Mesh], intersection: bool) -> Mesh:
    """The same at once: all edges cross on a grid, and faces between them are chosen by what is around them."""
    shapely = load_shapely("A symmetric outline")
    points = np.concatenate([mesh.vertices for mesh in meshes])
    origin, diagonal = points.mean(axis=0), float(np.hypot(*np.ptp(points, axis=0)))
    rings = [shapely.LinearRing(ring - origin) for mesh in meshes for ring in mesh.rings]
    lines = shapely.union_all(rings, grid_size=ROUND_OFF * diagonal)
    faces = shapely.polygonize(list(getattr(lines, "geoms", [lines]))).geoms
    probes = np.array([face.representative_point().coords[0] for face in faces]).reshape(-1, 2) + origin
    within = [winding_number(probes, mesh.vertices, mesh.edge_ends) > 0 for mesh in meshes]
    chosen = np.all(within, axis=0) if intersection else np.any(within, axis=0)
    together = shapely.coverage_union_all([face for face, inside in zip(faces, chosen, strict=True) if inside])
    if together.area <= INPUT_ROUND_OFF * diagonal**2:
        raise InvalidMeshError("The shapes have nothing in common.", code="overlay.empty")
    tree, tolerance = BoxTree(points, points), 2.0 * ROUND_OFF * diagonal

    def back(at: FloatArray) -> FloatArray:
        """Places before they were moved to the grid: exactly those of vertices."""
        distance, nearest, _ = tree.closest(at + origin)
        return np.asarray(np.where((distance <= tolerance)[:, None], points[nearest], at + origin))

    rings = _rings(shapely.transform(together, back), tolerance)
    rings = [ring[(tree.closest(ring).distance == 0.0) | (_bends(ring) > tolerance)] for ring in rings if len(ring) > 2]
    return Mesh.from_loops([ring for ring in rings if len(ring) > 2 and _area(ring) > INPUT_ROUND_OFF * diagonal**2])


def _rings(solid: Any, tolerance: float = 0.0) -> list[FloatArray]:
    """The outlines of the polygons of a geometry, without points as close as that to the one before."""
    parts = [part for part in getattr(solid, "geoms", [solid]) if part.geom_type == "Polygon"]
    rings = [np.array(ring.coords)[:-1] for part in parts for ring in (part.exterior, *part.interiors)]
    return [ring[norm(ring - np.roll(ring, 1, axis=0)) > tolerance] for ring in rings]


def _bends(ring: FloatArray) -> FloatArray:
    """(k,) distance of each point of a ring from the edge between its neighbours."""
    return point_edge(ring, np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)).distance


def _area(ring: FloatArray) -> float:
    here = ring - ring[0]
    return abs(0.5 * float(cross(here, np.roll(here, -1, axis=0)).sum()))
