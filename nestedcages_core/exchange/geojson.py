"""GeoJSON in and out (RFC 7946)."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..errors import NestedCagesError
from ..mesh import Mesh


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


def from_geojson(text: str | bytes) -> Mesh:
    """All polygons of a GeoJSON text as one mesh; heights and properties are left out.

    Raises NestedCagesError for what is not GeoJSON, InvalidMeshError where polygons touch or overlap: read those as
    single features.
    """
    return Mesh.from_geometry(_loaded(text))


def features_from_geojson(text: str | bytes) -> list[Feature]:
    """One mesh for each feature of a GeoJSON text, with its properties; features without polygons are left out."""
    document = _loaded(text)
    members = document.get("features") if document.get("type") == "FeatureCollection" else [document]
    if not isinstance(members, list):
        raise NestedCagesError("The FeatureCollection has no list of features; give one.")
    features = []
    for k, member in enumerate(members):
        if not isinstance(member, dict):
            raise NestedCagesError(f"Feature {k} is not an object with a type; correct the document.")
        is_feature = member.get("type") == "Feature"
        geometry = member.get("geometry") if is_feature else member
        if not isinstance(geometry, dict) or geometry.get("type") not in ("Polygon", "MultiPolygon"):
            continue
        known = member.get("properties") if is_feature else None
        features.append(Feature(Mesh.from_geometry(geometry), known or {}, member.get("id") if is_feature else None))
    return features


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
    except ValueError as error:
        raise NestedCagesError(f"This is not GeoJSON: {error}.") from error
    if not isinstance(document, dict) or "type" not in document:
        raise NestedCagesError("This is not GeoJSON: the document is not an object with a type.")
    return document
