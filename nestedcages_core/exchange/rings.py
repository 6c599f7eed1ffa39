"""Foreign coordinates as arrays of numbers; invalid ones are named with their place."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ..errors import InvalidMeshError
from ..geometry.arrays import FloatArray
from ..geometry.drawable import Drawable
from ..geometry.mesh import Mesh
from ..geometry.mesh.validation import MAX_COORDINATE
from .limits import no_outline

Polygon = list[FloatArray]
"""An outer ring and its holes, each (k, 2)."""

LONGEST_SHOWN = 40
"""Maximum length of a value quoted in a message."""


RINGLESS = ("Point", "MultiPoint", "LineString", "MultiLineString")
"""Types of geometries without an inside."""

GREATEST_DEPTH = 64
"""Maximum nesting depth of collections; a deeper one is assumed to contain itself."""


def polygons_of(geometry: Any, depth: int = 0) -> list[Polygon]:
    """The polygons of a GeoJSON geometry as arrays; geometries without an inside are left out.

    Raises InvalidMeshError for anything else, with the place of invalid coordinates.
    """
    mapping = getattr(geometry, "__geo_interface__", geometry)
    if not isinstance(mapping, Mapping):
        raise no_outline(f"The geometry is {shown(geometry)}, not an object with a type.")
    if depth > GREATEST_DEPTH:
        raise InvalidMeshError(
            f"The geometry has collections within collections, more than {GREATEST_DEPTH} deep.", code="limit.exceeded"
        )
    kind = mapping.get("type")
    if kind == "GeometryCollection":
        members = _items(mapping.get("geometries"), "The list of geometries")
        return [polygon for member in members for polygon in polygons_of(member, depth + 1)]
    if kind in RINGLESS:
        return []
    if kind not in ("Polygon", "MultiPolygon"):
        raise no_outline(f"A geometry of type {shown(kind)} is not known; give Polygon or MultiPolygon.")
    given = mapping.get("coordinates")
    polygons = [given] if kind == "Polygon" else _items(given, "The list of polygons")
    return [
        [ring_of(ring, f"ring {k} of polygon {number}") for k, ring in enumerate(rings)]
        for number, rings in enumerate(_items(polygon, f"Polygon {m}") for m, polygon in enumerate(polygons))
        if len(rings)
    ]


def _items(value: Any, what: str) -> Any:
    """A list, tuple or array as it is. Raises InvalidMeshError for anything else."""
    if isinstance(value, str | bytes) or not isinstance(value, Sequence | np.ndarray):
        raise no_outline(f"{what} is {shown(value)}, not a list.")
    return value


def ring_of(points: Any, where: str) -> FloatArray:
    """(k, 2) coordinates of a ring, heights left out. Raises InvalidMeshError for all but finite real numbers."""
    if isinstance(points, np.ndarray) and points.ndim == 2 and points.shape[1] >= 2 and points.dtype.kind in "iuf":
        ring = points[:, :2].astype(np.float64)
    else:
        rows = []
        for k, point in enumerate(_items(points, where.capitalize())):
            if not _is_point(point):
                raise no_outline(f"Point {k} of {where} is {shown(point)}, not two numbers.")
            try:
                rows.append((float(point[0]), float(point[1])))
            except OverflowError:
                raise no_outline(f"Point {k} of {where} is out of range for floating-point numbers.") from None
        ring = np.reshape(rows, (-1, 2))
    far = np.flatnonzero(~(np.abs(ring) < MAX_COORDINATE).all(axis=1))
    if len(far):
        x, y = ring[far[0]].tolist()
        raise no_outline(f"Point {far[0]} of {where} is ({x:.6g}, {y:.6g}); finite numbers below 1e150 are read.")
    return ring


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


def shown(value: Any) -> str:
    """A value, shortened for messages."""
    try:
        text = reprlib.repr(value)
    except Exception:  # from integers with thousands of digits, or from user-defined objects
        return f"a {type(value).__name__}"
    text = ascii(text)[1:-1] if not text.isascii() else text
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}…"


def _is_point(point: Any) -> bool:
    if isinstance(point, str | bytes) or not isinstance(point, Sequence | np.ndarray) or len(point) < 2:
        return False
    return all(isinstance(value, float | int | np.number) and type(value) is not bool for value in point[:2])
