"""GeoJSON in and out (RFC 7946): polygons that touch or cross are united, and each change is reported."""

from __future__ import annotations

import json
import math
import os
import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..errors import NestedCagesError, NestedCagesWarning, invalid_file, no_outline
from ..geometry.arrays import FloatArray
from ..geometry.drawable import Drawable
from ..geometry.mesh import Mesh, MeshLike
from ..geometry.mesh.validation import MAX_COORDINATE
from .decimals import check_decimals
from .files import write_whole
from .geometries import polygons_of, shown
from .gis_files import map_document
from .limits import LimitError, Limits, Quota
from .lonlat import across, may_be_degrees
from .meshes import left_out_of, mesh_of_polygons, meshes_of
from .pieces import convex_pieces

FEATURES_PER_SECOND, RINGS_PER_SECOND = 2_500, 10_000
"""Features, and rings of them, that are read in a second (measured); to unite outlines takes longer."""

NAMES = ("name", "NAME", "Name")
"""Properties that name a feature."""

LONGEST_NAME = 60
"""Maximum length of a feature's name in a message."""

LOOKS = ("time", "fill", "fill-opacity", "stroke", "stroke-opacity", "stroke-width")
"""Properties that say when and how a feature is shown."""

KEPT_BY_PIECES = ("name", "level", *LOOKS)
"""Properties that the convex pieces of a feature have too."""


@dataclass(frozen=True, eq=False)
class Feature:
    """A mesh with its properties."""

    mesh: Mesh
    properties: Mapping[str, Any] = field(default_factory=dict)
    id: str | int | float | None = None
    name: str = "feature"
    """Name in messages: its number in the file, and its own name if it has one."""
    repairs: tuple[str, ...] = ()
    """Repairs on reading, each with its place."""
    given: tuple[FloatArray, ...] = ()
    """Rings (k, 2) as they were read, before repairs but those across the 180th meridian; none where the mesh has them
    as they are."""

    @property
    def __geo_interface__(self) -> dict[str, Any]:
        feature: dict[str, Any] = {
            "type": "Feature",
            "properties": dict(self.properties),
            "geometry": self.mesh.__geo_interface__,
        }
        return feature if self.id is None else {**feature, "id": self.id}


@dataclass(frozen=True, eq=False)
class Map:
    """The features of a document that have polygons."""

    features: tuple[Feature, ...]
    refused: tuple[str, ...] = ()
    """A sentence for each feature that could not be read."""
    without_polygons: int = 0
    """Features that have no polygons."""
    left_out: Mapping[str, int] = field(default_factory=dict)
    """Number of points and lines by type, which have no inside."""
    crs: Any = None
    """The document's `crs` member, as older documents have it; None for longitude and latitude, or not said."""
    pixels: Mapping[str, Any] | None = None
    """The document's `pixels` member: coordinates are those of a picture. See `to_geojson`."""

    @property
    def notes(self) -> list[str]:
        """A sentence for each repair, with its feature and place, and one on points and lines."""
        repairs = [f"{feature.name}: {repair}." for feature in self.features for repair in feature.repairs]
        return repairs + ([f"{left_out_of(self.left_out)}."] if self.left_out else [])


def read_map(source: Any, limits: Limits | None = None, *, specks: float = 0.0, inside: bool = False) -> Map:
    """All features of a GeoJSON document with polygons; faults of single features are reported, not raised.

    Rings are read exactly, and each mesh holds them exactly. Where they touch, overlap or cross, the polygons are
    united, and each change is named; polygons across the 180th meridian are shifted beyond it.

    Parameters
    ----------
    source : Any
        GeoJSON as text or bytes, a mapping, or anything with `__geo_interface__`, such as a GeoDataFrame.
    limits : Limits, optional
        On the input.
    specks : float, optional
        Width below which parts and spikes are left out, holes and gaps closed. Default: all are read.
    inside : bool, optional
        For cages inside: meshes lie in the polygons, instead of holding them.

    Raises
    ------
    NestedCagesError
        For input that is not GeoJSON or exceeds the limits.
    """
    limits = limits or Limits()
    document = _loaded(source, limits)
    members: Any = document.get("features") if document["type"] == "FeatureCollection" else [document]
    if isinstance(members, str | bytes | Mapping) or not hasattr(members, "__iter__"):
        raise invalid_file(f"The FeatureCollection has {shown(members)} where its list of features belongs.")
    pixels = document.get("pixels") if isinstance(document.get("pixels"), Mapping) else None
    if pixels and not all(is_number(pixels.get(side, 0)) for side in ("width", "height")):
        raise invalid_file("The width and the height of the pixels are not numbers.")
    degrees = pixels is None and may_be_degrees(document.get("crs"))
    features, refused, without, quota = [], [], 0, Quota(limits)
    left_out: Counter[str] = Counter()
    if hasattr(members, "__len__"):
        quota.spend("seconds", len(members) / FEATURES_PER_SECOND)
    for number, member in enumerate(members):
        quota.spend("elements", 1)
        name = f"feature {number}"
        try:
            geometry, properties, identity, lost = _feature_members(member)
            name = _name(number, properties, identity)
            polygons = [] if geometry is None else polygons_of(geometry, left_out=left_out)
            quota.spend("points", sum(len(ring) for polygon in polygons for ring in polygon))
            quota.spend("seconds", sum(map(len, polygons)) / RINGS_PER_SECOND)
            if not polygons:
                without += 1
                continue
            polygons, shifted = across(polygons) if degrees else (polygons, [])
            mesh, repairs = mesh_of_polygons(polygons, quota=quota, specks=specks, inside=inside)
            rings = tuple(ring for polygon in polygons for ring in polygon) if repairs else ()
            features.append(Feature(mesh, properties, identity, name, (*shifted, *repairs, *lost), rings))
        except LimitError:
            raise
        except NestedCagesError as error:
            refused.append(f"{name}: {error}")
    return Map(tuple(features), tuple(refused), without, left_out, document.get("crs"), pixels)


def features_from_geojson(source: Any, *, limits: Limits | None = None, **options: Any) -> list[Feature]:
    """One mesh for each feature of a GeoJSON document, with its properties; features without polygons are left out.

    source and options: those of `read_map`. A NestedCagesWarning names all changes, what is left out, and the features
    that cannot be read. Raises NestedCagesError for input that is not GeoJSON, and if no feature can be read.
    """
    return list(_said(read_map(source, limits, **options)).features)


def from_geojson(source: Any, *, limits: Limits | None = None, specks: float = 0.0, inside: bool = False) -> Mesh:
    """All polygons of a GeoJSON document as one mesh, properties left out; features that touch or overlap are united.

    Options and warnings: as of `features_from_geojson`. Raises NestedCagesError also if there are no polygons.
    """
    features = _said(read_map(source, limits, specks=specks, inside=inside)).features
    if not features:
        raise invalid_file("The document has no polygons; give Polygon or MultiPolygon geometries.")
    if len(features) == 1:
        return features[0].mesh
    polygons = [polygon for feature in features for polygon in polygons_of(feature.mesh)]
    return mesh_of_polygons(polygons, quota=Quota(limits or Limits()), inside=inside)[0]


def read_geojson(path: str | os.PathLike[str], *, limits: Limits | None = None, **options: Any) -> Mesh:
    """All polygons of a GeoJSON file as one mesh, or with pyogrio of a Shapefile, GeoPackage or TopoJSON.

    options: those of `from_geojson`.
    """
    limits = limits or Limits()
    return from_geojson(map_document(path, limits), limits=limits, **options)


def to_geojson(
    shapes: Drawable | MeshLike | Feature | Map | Sequence[Mesh | Feature],
    *,
    indent: int | None = None,
    crs: Any = None,
    pixels: Mapping[str, Any] | None = None,
    pieces: int | None = None,
    decimals: int | None = None,
) -> str:
    """A FeatureCollection with one feature per shape; coordinates are written exactly.

    Parameters
    ----------
    shapes : Drawable, mesh-like, Feature, Map or sequence of Mesh and Feature
        Of a hierarchy the drawing and its cages, with their `level`, `area` and `centroid` as properties.
    indent : int, optional
        Spaces per level of the JSON. Default: everything on one line.
    crs : Any, optional
        A `crs` member, as `Map.crs` has it.
    pixels : mapping, optional
        A `pixels` member, which says that the coordinates are those of a picture: whether "y" points "down" or "up",
        and the "width" and "height" of the picture where it has any.
    pieces : int, optional
        Adds convex pieces of at most this many vertices after each feature but drawings, which have level 0: features
        with a number from 1 on as `piece`.
    decimals : int, optional
        The most that a coordinate may have. Nothing is rounded, since that would undo certificates: ask for cages with
        as many, as by Settings(grid=1e-6) for 6.

    Returns
    -------
    str

    Raises
    ------
    NestedCagesError
        For what JSON cannot hold, and for coordinates with more decimals.
    """
    if isinstance(shapes, Map):
        crs = shapes.crs if crs is None else crs
        pixels = shapes.pixels if pixels is None else pixels
        shapes = shapes.features
    features = _features_of(shapes)
    check_decimals([feature.mesh for feature in features], decimals)
    if pieces is not None:
        features = [each for feature in features for each in (feature, *_pieces_of(feature, pieces))]
    collection: dict[str, Any] = {"type": "FeatureCollection"}
    if pixels is not None:
        collection |= {"crs": None, "pixels": dict(pixels)}  # null: nobody takes them for degrees
    elif crs is not None:
        collection["crs"] = crs
    collection["features"] = [feature.__geo_interface__ for feature in features]
    try:
        return json.dumps(collection, indent=indent, allow_nan=False, default=_json_value)
    except (TypeError, ValueError, RecursionError) as error:
        raise invalid_file(f"The properties cannot be written as JSON: {error}.") from error


def measures(mesh: Mesh) -> dict[str, Any]:
    """Area and centroid of a solid, as properties of its feature."""
    starts, ends = mesh.vertices - mesh.vertices[0], mesh.edge_ends - mesh.vertices[0]
    twice = starts[:, 0] * ends[:, 1] - starts[:, 1] * ends[:, 0]
    return {"area": mesh.area, "centroid": (mesh.vertices[0] + twice @ (starts + ends) / (6.0 * mesh.area)).tolist()}


def _features_of(shapes: Any) -> list[Feature]:
    """What a writer is given as features. Raises NestedCagesError."""
    if isinstance(shapes, Drawable) and not isinstance(shapes, Mesh):
        return [Feature(mesh, {"level": k, **measures(mesh)}) for k, mesh in enumerate(shapes.meshes)]
    listed = isinstance(shapes, str | Mapping | list | tuple)
    given: Any = [shapes] if isinstance(shapes, Feature) else shapes if listed else meshes_of(shapes)
    if isinstance(given, str | Mapping) or not all(isinstance(item, Mesh | Feature) for item in given):
        raise invalid_file("GeoJSON is written from meshes and features; give a list of these.")
    return [item if isinstance(item, Feature) else Feature(item) for item in given]


def _pieces_of(feature: Feature, most: int) -> list[Feature]:
    """The convex pieces of a feature; none of a drawing."""
    if feature.properties.get("level") == 0:
        return []
    kept = {key: feature.properties[key] for key in KEPT_BY_PIECES if key in feature.properties}
    pieces = convex_pieces(feature.mesh, most)
    return [Feature(Mesh.from_loops([piece]), {**kept, "piece": k}) for k, piece in enumerate(pieces, 1)]


def write_geojson(
    path: str | os.PathLike[str], shapes: Drawable | MeshLike | Feature | Map | Sequence[Mesh | Feature], **options: Any
) -> None:
    """Write a GeoJSON file, whole or not at all; shapes and options as of `to_geojson`."""
    write_whole(path, to_geojson(shapes, **options))


def loaded_json(text: Any, limits: Limits, *, strict: bool = False) -> Any:
    """A JSON document; strict: without NaN, and members that are there twice. Raises NestedCagesError."""
    if not isinstance(text, str | bytes | bytearray):
        raise invalid_file(f"GeoJSON is read from text or bytes, not from {type(text).__name__}.")
    limits.check("bytes", len(text))
    hooks: dict[str, Any] = (
        {"object_pairs_hook": _once, "parse_constant": _finite, "parse_float": _finite} if strict else {}
    )
    try:
        return json.loads(text, **(hooks if strict else {}))
    except (ValueError, RecursionError) as error:
        problem: object = "its brackets are nested too deeply" if isinstance(error, RecursionError) else error
        if "int_max_str_digits" in str(error):  # Python's advice, to programmers
            problem = "a whole number in it has thousands of digits"
        raise invalid_file(f"This is not GeoJSON: {problem}.") from error


def is_number(value: Any) -> bool:
    """Whether a value of JSON is a number that a coordinate can be."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < MAX_COORDINATE


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object. Raises NestedCagesError for a member that is there twice."""
    if len(found := dict(pairs)) < len(pairs):
        raise invalid_file("The document has an object with the same member twice.")
    return found


def _finite(word: str) -> float:
    """A number of JSON. Raises NestedCagesError for NaN, Infinity, and what is as large."""
    if not math.isfinite(number := float(word)):
        raise invalid_file(f"The document has {word:.40}, which is no finite number.")
    return number


def _loaded(source: Any, limits: Limits) -> Mapping[str, Any]:
    document = getattr(source, "__geo_interface__", source)
    if not isinstance(document, Mapping):
        document = loaded_json(source, limits)
    if not isinstance(document, Mapping) or not isinstance(document.get("type"), str):
        raise invalid_file("This is not GeoJSON: the document is not an object with a type.")
    if document["type"] == "Topology":
        raise invalid_file("This is TopoJSON; give its file to read_geojson or the command, which use pyogrio.")
    return document


def _feature_members(member: Any) -> tuple[Any, Mapping[str, Any], str | int | float | None, list[str]]:
    """Geometry, properties and id of a feature or a bare geometry, and a note on numbers that JSON cannot represent,
    which become None."""
    mapping = getattr(member, "__geo_interface__", member)
    if not isinstance(mapping, Mapping):
        raise no_outline(f"It is {shown(member)}, not an object with a type.")
    if mapping.get("type") != "Feature":
        return mapping, {}, None, []
    properties, identity = mapping.get("properties"), mapping.get("id")
    properties = properties if isinstance(properties, Mapping) else {}
    bad = [key for key, value in properties.items() if isinstance(value, float) and not math.isfinite(value)]
    lost = [f"properties that are not finite: {', '.join(map(shown, bad))}; set to null"] if bad else []
    properties = {**properties, **dict.fromkeys(bad)} if bad else properties
    return mapping.get("geometry"), properties, identity if isinstance(identity, str | int | float) else None, lost


def _name(number: int, properties: Mapping[str, Any], identity: Any) -> str:
    known = next((properties[key] for key in NAMES if properties.get(key) not in (None, "")), identity)
    words = " ".join(("" if known is None else known if isinstance(known, str) else shown(known)).split())
    words = words if len(words) <= LONGEST_NAME else f"{words[:LONGEST_NAME]}…"
    return f"feature {number}" + (f" ({words})" if words else "")


def _json_value(value: Any) -> Any:
    """Numbers and arrays of numpy as JSON knows them."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"a {type(value).__name__} cannot be written as JSON")


def _said(found: Map) -> Map:
    """Warn of repaired and rejected features. Raises NestedCagesError if all were rejected."""
    sentences = [*found.refused, *found.notes]
    if found.refused and not found.features:
        raise no_outline("\n".join(sentence[0].upper() + sentence[1:] for sentence in sentences))
    if sentences:
        warnings.warn("\n".join(sentences), NestedCagesWarning, stacklevel=3)
    return found
