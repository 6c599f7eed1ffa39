"""Drawings in the scene from files: the same formats that cages are written in."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import keys
from ..core import chains, core
from ..errors import UserError, told
from ..generation.job import Progress, Work
from ..scene.plane import size

SVG, MAPS = (".svg",), (".geojson", ".json")


# Metres per unit: of drawings, whose unit is a pixel, and of files exported from Blender, which keep their size.
PIXEL, EXPORTED = 0.01, 1.0
# Whether an SVG becomes an outline of each shape, by the choices of the operator.
EACH = {"ONE": False, "SEVERAL": True, "PARTS": True, "AUTO": None}


@dataclass(frozen=True)
class Shape:
    """A mesh of the core and its name, and by default: whether its y points down, and metres per unit."""

    name: str
    mesh: core.Mesh
    y_down: bool
    scale: float = PIXEL


def shapes_in(path: Path, outlines: str = "AUTO") -> list[Shape]:
    """The filled area of an SVG, each feature of a GeoJSON, or a collision outline. Raises: UserError.

    outlines: of an SVG, "ONE" of everything, "SEVERAL" of each shape, or "AUTO", several of exported cages.
    """
    exchange = core.exchange
    if not path.exists():
        raise UserError(f"There is no file '{path}'")
    try:
        if path.suffix.lower() in SVG:
            return _svg_shapes(path, outlines)
        if path.suffix.lower() not in MAPS:
            raise UserError(f"'{path.name}' is not a supported file type: choose .svg, .geojson or .json")
        text = exchange.read_whole(path, exchange.Limits())
        if exchange.is_engine_json(text):
            return [Shape(path.stem, exchange.from_engine_json(text), True, EXPORTED)]
        features = exchange.features_from_geojson(text)
    except (core.NestedCagesError, OSError) as error:
        raise UserError(f"'{path.name}' cannot be read: {told(error)}") from error
    if not features:
        raise UserError(f"'{path.name}' has no polygons")
    return [
        Shape(
            str(feature.properties.get("name") or feature.properties.get("NAME") or feature.id or path.stem),
            feature.mesh,
            bool(feature.properties.get(keys.Y_DOWN, False)),
            EXPORTED if keys.Y_DOWN in feature.properties else PIXEL,
        )
        for feature in features
    ]


def _svg_shapes(path: Path, outlines: str) -> list[Shape]:
    """The outlines of an SVG. Raises: core.NestedCagesError, OSError."""
    content = core.exchange.read_whole(path, core.exchange.Limits())
    found = core.exchange.svg_shapes(content, each=EACH[outlines])
    return [Shape(name or path.stem, mesh, True, EXPORTED if found.written else PIXEL) for name, mesh in found.shapes]


def place(
    context: bpy.types.Context, shapes: list[Shape], *, y_down: bool | None, scale: float
) -> Work[list[bpy.types.Object]]:
    """New objects of edges, each around its own centre, so that distant places keep their precision. Raises: UserError.

    y_down: whether the y axis points down, None for the default of the file format; scale: metres per unit of the file,
    0 for the default.
    """
    made: list[tuple[str, core.Mesh, NDArray[np.float64]]] = []
    for shape in shapes:
        yield Progress(0.5 + 0.5 * len(made) / len(shapes), f"placing '{shape.name}'")
        turned = shape.y_down if y_down is None else y_down
        unit = scale or shape.scale
        points = shape.mesh.vertices * (unit, -unit if turned else unit)
        middle = (0.5 * (points.min(axis=0) + points.max(axis=0))).astype(np.float32).astype(np.float64)
        kept = stored(shape.name, [points[loop] - middle for loop in shape.mesh.loops])
        made.append((shape.name, kept, middle))
    return [_object(context, *parts) for parts in made]


def _object(context: bpy.types.Context, name: str, mesh: core.Mesh, middle: NDArray[np.float64]) -> bpy.types.Object:
    """A new object of edges that stands at `middle` (2,)."""
    data = bpy.data.meshes.new(name)
    corners = np.column_stack([mesh.vertices, np.zeros(len(mesh.vertices))])
    data.from_pydata(corners.tolist(), mesh.edges.tolist(), [])
    obj = bpy.data.objects.new(name, data)
    obj.location = (*middle.tolist(), 0.0)
    context.collection.objects.link(obj)
    return obj


def stored(name: str, loops: list[NDArray[np.float64]]) -> core.Mesh:
    """The core's ``Mesh`` of loops (k, 2) in float32 precision. Raises: UserError.

    Points that coincide in float32 are merged, and loops that touch because of it are joined.
    """
    extent = size(np.concatenate(loops))
    try:
        kept = [_rounded(loop, extent) for loop in loops]
        try:
            return core.Mesh.from_loops(kept)
        except core.NestedCagesError:
            mended = core.exchange.solid([core.exchange.Painted(kept, evenodd=True)])
            return core.Mesh.from_loops([_rounded(mended.vertices[loop], extent) for loop in mended.loops])
    except core.NestedCagesError as error:
        raise UserError(f"'{name}' loses detail in Blender's precision: {error}") from error


def _rounded(loop: NDArray[np.float64], extent: float) -> NDArray[np.float64]:
    """A loop (k, 2) as float32, without repeated points."""
    return chains.without_doubles(loop.astype(np.float32), extent).astype(np.float64)
