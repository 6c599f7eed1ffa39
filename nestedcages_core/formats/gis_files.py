"""Map files of other formats than GeoJSON, through GDAL: Shapefile, GeoPackage, TopoJSON."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..errors import invalid_file
from ..libraries import needed
from .files import read_whole
from .limits import Limits

FILES = (".shp", ".gpkg", ".topojson")
"""Extensions of the files that are read by GDAL."""

TOPOLOGY, HEAD = b'"Topology"', 512
"""What TopoJSON says among its first bytes; files of it often end in .json."""


def map_document(
    path: str | os.PathLike[str], limits: Limits, layers: Sequence[str] | None = None
) -> bytes | Mapping[str, Any]:
    """The contents of a map file, as `read_map` takes it: GeoJSON as it is, other formats as a FeatureCollection.

    layers: names of the layers to read; default: the first one with polygons.

    Raises NestedCagesError for a file beyond the limits or without such layers, and where pyogrio is missing.
    """
    given = Path(path)
    if given.suffix.lower() in FILES:
        limits.check("bytes", os.stat(given).st_size)
        return _collection(given, limits, layers)
    content = read_whole(given, limits)
    return _collection(given, limits, layers) if TOPOLOGY in content[:HEAD] else content


def _collection(path: Path, limits: Limits, layers: Sequence[str] | None) -> dict[str, Any]:
    """The features of layers of a file."""
    with needed("pyogrio", f"Reading {path.name}"):
        import pyogrio
    from .solids import shapely

    try:
        there = {str(name): str(kind) for name, kind in pyogrio.list_layers(path)}
        polygons = [name for name, kind in there.items() if "Polygon" in kind or kind in ("Unknown", "None")]
        wanted = list(layers) if layers else polygons[:1]
        missing = [name for name in wanted if name not in there]
        if missing or not wanted:
            problem = f"has no layer {missing[0]!r}" if missing else "has no layer with polygons"
            raise invalid_file(f"{path.name} {problem}; its layers: {', '.join(there) or 'none'}.")
        features: list[dict[str, Any]] = []
        points = 0
        for layer in wanted:
            limits.check("elements", len(features) + pyogrio.read_info(path, layer=layer)["features"])
            about, _, geometries, columns = pyogrio.raw.read(path, layer=layer)
            shapes = shapely.from_wkb(geometries)
            points += int(shapely.get_num_coordinates(shapes).sum())  # polygons of TopoJSON share arcs
            limits.check("points", points)
            for row, shape in enumerate(shapes):
                named = zip(about["fields"], columns, strict=True)
                properties = {str(name): _json_value(values[row]) for name, values in named}
                geometry = None if shape is None else shapely.geometry.mapping(shape)
                features.append({"type": "Feature", "properties": properties, "geometry": geometry})
    except (pyogrio.errors.DataSourceError, pyogrio.errors.DataLayerError, shapely.errors.ShapelyError) as error:
        raise invalid_file(f"{path.name} cannot be read by GDAL: {error}") from error
    crs = about["crs"]
    named_crs = {} if crs in (None, "EPSG:4326") else {"crs": {"type": "name", "properties": {"name": crs}}}
    return {"type": "FeatureCollection", "features": features, **named_crs}


def _json_value(value: Any) -> Any:
    """A value of a table as JSON has it; dates as texts."""
    plain = value.item() if hasattr(value, "item") else value
    return plain if isinstance(plain, str | int | float | bool | None) else str(plain)
