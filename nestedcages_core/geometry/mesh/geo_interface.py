"""Geometries in the `__geo_interface__` form (GeoJSON, RFC 7946) as rings of coordinates, and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ...errors import InvalidMeshError, unreadable
from ..arrays import IntArray
from ..vectors import place

MAX_NESTING_DEPTH = 64
"""Maximum nesting depth of collections; a deeper one is assumed to contain itself."""


def rings_of(geometry: Any) -> list[list[Any]]:
    """The polygons of a geometry, each a list of rings, the outer one first; empty polygons are left out.

    geometry: anything with `__geo_interface__`, or such a mapping: Polygon, MultiPolygon, Feature,
    FeatureCollection, GeometryCollection. Raises InvalidMeshError for anything else.
    """
    polygons: list[list[Any]] = []
    _collect(geometry, polygons, 0)
    if not polygons:
        raise InvalidMeshError("The geometry is empty; give at least one polygon.", code="mesh.empty")
    return polygons


def _collect(geometry: Any, polygons: list[list[Any]], depth: int) -> None:
    mapping = getattr(geometry, "__geo_interface__", geometry)
    if not isinstance(mapping, Mapping) or depth > MAX_NESTING_DEPTH:
        raise unreadable(
            f"A {type(geometry).__name__} does not describe a geometry; give an object with __geo_interface__, "
            "such as a shapely Polygon."
        )
    kind = mapping.get("type")
    if kind == "Polygon":
        _add(mapping.get("coordinates"), polygons)
    elif kind == "MultiPolygon":
        for rings in _items(mapping, "coordinates"):
            _add(rings, polygons)
    elif kind == "Feature":
        if mapping.get("geometry") is not None:
            _collect(mapping["geometry"], polygons, depth + 1)
    elif kind == "FeatureCollection":
        for feature in _items(mapping, "features"):
            _collect(feature, polygons, depth + 1)
    elif kind == "GeometryCollection":
        for member in _items(mapping, "geometries"):
            _collect(member, polygons, depth + 1)
    else:
        raise unreadable(f"A geometry of type {kind} has no inside; give Polygon or MultiPolygon geometries.")


def _items(mapping: Mapping[str, Any], key: str) -> list[Any]:
    try:
        return list(mapping[key])
    except Exception as error:
        raise unreadable(f"The {mapping['type']} has no list of {key}; give one.") from error


def _add(rings: Any, polygons: list[list[Any]]) -> None:
    """Append the rings of one polygon, heights left out."""
    try:
        polygon = [[tuple(point)[:2] for point in ring] for ring in rings]
    except TypeError as error:
        raise unreadable(
            "The coordinates of a Polygon are a list of rings of points; these are something else."
        ) from error
    if any(polygon):
        polygons.append(polygon)


def to_geo_interface(polygons: Sequence[Sequence[Sequence[Sequence[float]]]]) -> dict[str, Any]:
    """A Polygon or MultiPolygon mapping from polygons of open rings; the rings are closed here."""
    closed = tuple(
        tuple(tuple((float(x), float(y)) for x, y in (*ring, ring[0])) for ring in polygon) for polygon in polygons
    )
    if len(closed) == 1:
        return {"type": "Polygon", "coordinates": closed[0]}
    return {"type": "MultiPolygon", "coordinates": closed}


def check_roles(polygons: list[list[Any]], signs: IntArray, components: IntArray) -> None:
    """Check that in the mesh of all rings, in order, each polygon is one component. Raises InvalidMeshError."""
    first = 0
    for k, polygon in enumerate(polygons):
        roles, owners = signs[first : first + len(polygon)], components[first : first + len(polygon)]
        if roles[0] < 0:
            raise InvalidMeshError(
                f"Polygon {k} near {place(polygon[0][0])} lies inside another polygon; unite them or remove one.",
                code="mesh.nesting",
            )
        if (roles[1:] > 0).any() or (owners != owners[0]).any():
            raise InvalidMeshError(
                f"A hole of polygon {k} near {place(polygon[0][0])} is not directly inside it; move or remove it.",
                code="mesh.nesting",
            )
        first += len(polygon)
