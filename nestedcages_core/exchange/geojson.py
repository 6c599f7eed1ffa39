"""GeoJSON in and out (RFC 7946)."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InvalidMeshError, NestedCagesError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.mesh.geo_interface import rings_of
from .fill import Painted, solid

POLYGONAL = ("Polygon", "MultiPolygon", "GeometryCollection")
"""Types of geometries that may have an inside."""

TOUCHING = 1e-4
"""Share of the area by which polygons that only touch in points may differ once they are joined there."""


@dataclass(frozen=True, eq=False)
class Feature:
    """A mesh with what is known about it."""

    mesh: Mesh
    properties: Mapping[str, Any] = field(default_factory=dict)
    id: str | int | None = None

    @property
    def __geo_interface__(self) -> dict[str, Any]:
        feature: dict[str, Any] = {
            "type": "Feature",
            "properties": dict(self.properties),
            "geometry": self.mesh.__geo_interface__,
        }
        return feature if self.id is None else {**feature, "id": self.id}


@dataclass(frozen=True, eq=False)
class Record:
    """A feature as it stands in a file, its geometry not yet looked at."""

    geometry: Mapping[str, Any]
    properties: Mapping[str, Any]
    id: str | int | None
    number: int
    """Its place in the file, from 0."""

    @property
    def name(self) -> str:
        """What a message calls it."""
        known = self.properties.get("name") or self.properties.get("NAME") or self.id
        return f"feature {self.number}" + (f" ({known})" if known is not None else "")

    def mesh(self) -> Mesh:
        """Its polygons; where they touch in points they become one there. Raises InvalidMeshError."""
        try:
            return Mesh.from_geometry(self.geometry)
        except InvalidMeshError:
            try:
                return _joined(self.geometry)
            except InvalidMeshError:
                pass
            raise


def records_from_geojson(text: str | bytes) -> list[Record]:
    """The features of a GeoJSON text that may have polygons; others are left out. Raises NestedCagesError."""
    document = _loaded(text)
    members = document.get("features") if document.get("type") == "FeatureCollection" else [document]
    if not isinstance(members, list):
        raise NestedCagesError("The FeatureCollection has no list of features; give one.")
    records = []
    for k, member in enumerate(members):
        if not isinstance(member, dict):
            raise NestedCagesError(f"Feature {k} is not an object with a type; correct the document.")
        is_feature = member.get("type") == "Feature"
        geometry = member.get("geometry") if is_feature else member
        if not isinstance(geometry, dict) or geometry.get("type") not in POLYGONAL:
            continue
        known = member.get("properties") if is_feature else None
        properties = known if isinstance(known, dict) else {}
        records.append(Record(geometry, properties, member.get("id") if is_feature else None, k))
    return records


def from_geojson(text: str | bytes) -> Mesh:
    """All polygons of a GeoJSON text as one mesh; heights and properties are left out.

    Raises NestedCagesError for what is not GeoJSON, InvalidMeshError where polygons touch or overlap: read those as
    single features.
    """
    return Mesh.from_geometry(_loaded(text))


def features_from_geojson(text: str | bytes) -> list[Feature]:
    """One mesh for each feature of a GeoJSON text, with its properties; features without polygons are left out.

    Polygons of one feature that touch in points, as the standard allows, become one by necks as thin as a hair.
    Raises NestedCagesError, which names the feature.
    """
    features = []
    for record in records_from_geojson(text):
        try:
            features.append(Feature(record.mesh(), record.properties, record.id))
        except InvalidMeshError as error:
            raise InvalidMeshError(f"{record.name.capitalize()}: {error}") from error
    return features


def _joined(geometry: Mapping[str, Any]) -> Mesh:
    """Polygons whose rings touch in points and nowhere else. Raises InvalidMeshError for others."""
    polygons = [[np.asarray(ring, dtype=np.float64) for ring in polygon] for polygon in rings_of(geometry)]
    wanted = sum(_area(ring) if k == 0 else -_area(ring) for polygon in polygons for k, ring in enumerate(polygon))
    mesh = solid([Painted(polygon, evenodd=True) for polygon in polygons])
    if not abs(mesh.area - wanted) <= TOUCHING * wanted:
        raise InvalidMeshError("The polygons overlap.")
    return mesh


def _area(ring: FloatArray) -> float:
    """Of a ring (k, 2), in whatever sense it turns."""
    x, y = (ring - ring.mean(axis=0)).T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0


def read_geojson(path: str | os.PathLike[str]) -> Mesh:
    """All polygons of a GeoJSON file as one mesh; see `from_geojson`."""
    return from_geojson(Path(path).read_bytes())


def to_geojson(shapes: Mesh | Feature | Sequence[Mesh | Feature], *, indent: int | None = None) -> str:
    """A FeatureCollection with one feature per shape; coordinates are written to the last bit."""
    given = [shapes] if isinstance(shapes, Mesh | Feature) else list(shapes)
    features = [item if isinstance(item, Feature) else Feature(item) for item in given]
    collection = {"type": "FeatureCollection", "features": [item.__geo_interface__ for item in features]}
    try:
        return json.dumps(collection, indent=indent, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise NestedCagesError(f"The properties cannot be written as JSON: {error}.") from error


def write_geojson(path: str | os.PathLike[str], shapes: Mesh | Feature | Sequence[Mesh | Feature]) -> None:
    """Write a GeoJSON file; see `to_geojson`."""
    Path(path).write_text(to_geojson(shapes), encoding="utf-8")


def _loaded(text: str | bytes) -> dict[str, Any]:
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise NestedCagesError(f"This is not GeoJSON: {error}.") from error
    if not isinstance(document, dict) or "type" not in document:
        raise NestedCagesError("This is not GeoJSON: the document is not an object with a type.")
    return document
