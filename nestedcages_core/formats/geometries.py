"""Geometries in the `__geo_interface__` form (GeoJSON, RFC 7946) as rings of coordinates."""

from __future__ import annotations

import reprlib
from collections import Counter
from collections.abc import Mapping
from decimal import Decimal
from numbers import Real
from typing import Any

import numpy as np

from ..errors import InvalidMeshError, unreadable
from ..geometry.arrays import FloatArray
from ..geometry.mesh.validation import MAX_COORDINATE

Polygon = list[FloatArray]
"""An outer ring and its holes, each (k, 2)."""

MAX_NESTING_DEPTH = 64
"""Maximum nesting depth of collections; a deeper one is assumed to contain itself."""

MAX_SHOWN = 40
"""Maximum length of a value quoted in a message."""

WITHOUT_INSIDE = ("Point", "MultiPoint", "LineString", "MultiLineString")
"""Types of geometries without an inside."""


def without_repeated_points(ring: FloatArray) -> FloatArray:
    """A ring (k, 2) with each of its points different from the next; of one that is a point, one."""
    if len(ring) < 2:
        return ring
    different = (ring != np.concatenate((ring[1:], ring[:1]))).any(axis=1)
    return ring[different] if different.any() else ring[:1]


def polygons_of(geometry: Any, *, left_out: Counter[str] | None = None, depth: int = 0) -> list[Polygon]:
    """The polygons of a geometry.

    geometry: anything with `__geo_interface__`, or such a mapping: Polygon, MultiPolygon, Feature, FeatureCollection,
    GeometryCollection. left_out: leave out points and lines, and count them by type.

    Raises InvalidMeshError for anything else, with the place of invalid coordinates.
    """
    mapping = getattr(geometry, "__geo_interface__", geometry)
    if not isinstance(mapping, Mapping):
        raise unreadable(
            f"The geometry is {shown(geometry)}, not an object with a type; give an object with __geo_interface__, "
            "such as a shapely Polygon."
        )
    if depth > MAX_NESTING_DEPTH:
        raise InvalidMeshError(
            f"The geometry has collections within collections, more than {MAX_NESTING_DEPTH} deep.",
            code="limit.exceeded",
        )
    kind = mapping.get("type")
    if kind == "Polygon":
        return [rings] if (rings := _checked_rings(mapping.get("coordinates"), 0)) else []
    if kind == "MultiPolygon":
        parts = _items(mapping.get("coordinates"), "The list of polygons")
        return [rings for number, part in enumerate(parts) if (rings := _checked_rings(part, number))]
    if kind == "Feature":
        members = [] if mapping.get("geometry") is None else [mapping["geometry"]]
    elif kind == "FeatureCollection":
        members = _items(mapping.get("features"), "The list of features")
    elif kind == "GeometryCollection":
        members = _items(mapping.get("geometries"), "The list of geometries")
    elif kind in WITHOUT_INSIDE and left_out is not None:
        left_out[kind] += 1
        return []
    else:
        raise unreadable(f"A geometry of type {shown(kind)} has no inside; give Polygon or MultiPolygon geometries.")
    return [each for member in members for each in polygons_of(member, left_out=left_out, depth=depth + 1)]


def _checked_rings(polygon: Any, number: int) -> Polygon:
    rings = _items(polygon, f"Polygon {number}")
    return [_ring(ring, f"ring {k} of polygon {number}") for k, ring in enumerate(rings)]


def _items(value: Any, what: str) -> list[Any]:
    """The items of anything iterable but texts and mappings. Raises InvalidMeshError for these."""
    try:
        if not isinstance(value, str | bytes | Mapping):
            return list(value)
    except Exception as error:  # user-defined objects may raise anything
        raise unreadable(f"{what} is {shown(value)}, not a list.") from error
    raise unreadable(f"{what} is {shown(value)}, not a list.")


def _ring(points: Any, where: str) -> FloatArray:
    """(k, 2) coordinates of a ring, heights left out. Raises InvalidMeshError for all but finite real numbers."""
    if isinstance(points, np.ndarray) and points.ndim == 2 and points.shape[1] >= 2 and points.dtype.kind in "iuf":
        ring = points[:, :2].astype(np.float64)
    else:
        rows = [_point(point, k, where) for k, point in enumerate(_items(points, where.capitalize()))]
        ring = np.reshape(rows, (-1, 2))
    far = np.flatnonzero(~(np.abs(ring) < MAX_COORDINATE).all(axis=1))
    if len(far):
        x, y = ring[far[0]].tolist()
        raise InvalidMeshError(
            f"Point {far[0]} of {where} is ({x:.6g}, {y:.6g}); finite numbers below {MAX_COORDINATE:g} are read.",
            code="mesh.out_of_range" if np.isfinite(ring[far[0]]).all() else "mesh.not_finite",
        )
    return ring


def _point(point: Any, k: int, where: str) -> tuple[float, float]:
    try:
        x, y = point[0], point[1]
        if _is_number(x) and _is_number(y):
            return float(x), float(y)
    except OverflowError as error:
        raise InvalidMeshError(
            f"Point {k} of {where} is out of range for floating-point numbers.", code="mesh.out_of_range"
        ) from error
    except Exception as error:  # user-defined objects may raise anything
        raise unreadable(f"Point {k} of {where} is {shown(point)}, not two numbers.") from error
    raise unreadable(f"Point {k} of {where} is {shown(point)}, not two numbers.")


def _is_number(value: Any) -> bool:
    return isinstance(value, float | int | Real | Decimal) and type(value) is not bool


def shown(value: Any) -> str:
    """A value, shortened for messages."""
    try:
        text = reprlib.repr(value)
    except Exception:  # from integers with thousands of digits, or from user-defined objects
        return f"a {type(value).__name__}"
    text = ascii(text)[1:-1] if not text.isascii() else text
    return text if len(text) <= MAX_SHOWN else f"{text[:MAX_SHOWN]}…"
