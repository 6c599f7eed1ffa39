"""Drawings from files: outlines in the formats that cages are written in, as objects of edges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from bpy.types import Context, Object
from mathutils import Matrix, Vector

from .. import keys
from ..blender import mesh_data
from ..blender.jobs import Progress, Work
from ..blender.views import turned
from ..core import blamed, core
from ..drawing.edge_loops import without_doubles
from ..drawing.plane import size, united_loops
from ..errors import FloatArray, UserError

SVG, MAPS = (".svg",), (".geojson", ".json")

# Metres per unit: of drawings, whose unit is a pixel, and of files exported from Blender, which keep their size.
PIXEL, EXPORTED = 0.01, 1.0
# Whether an SVG becomes one outline, or one of each shape; by default, several of exported cages.
EACH = {"ONE": False, "SEVERAL": True}


@dataclass(frozen=True)
class Shape:
    """A mesh of the core and its name, and by default: whether its y points down, and metres per unit."""

    name: str
    mesh: core.Mesh
    y_down: bool
    scale: float = PIXEL


def shapes_in(path: Path, outlines: str = "AUTO") -> tuple[list[Shape], bool, tuple[str, ...]]:
    """The filled area of an SVG, or each feature of a GeoJSON; whether its coordinates mean a place, as those of maps
    and of exported cages do; and notes on what was repaired or left out. Raises: UserError.

    outlines: see `EACH`.
    """
    formats, ending = core.formats, path.suffix.lower()
    if path.exists() and ending not in (*SVG, *MAPS):
        raise UserError(f"'{path.name}' is not a supported file type: choose .svg, .geojson, .json, .psd, .ora or .kra")
    content = content_of(path)
    with blamed(f"'{path.name}' cannot be read"):
        if ending in SVG:
            drawing = formats.svg_drawing(content, each=EACH.get(outlines), crop=False)
            scale = EXPORTED if drawing.written else PIXEL
            shapes = [Shape(name or path.stem, mesh, True, scale) for name, mesh in drawing.shapes]
            return shapes, drawing.written, drawing.notes
        table = formats.read_map(content)
    notes = (*table.refused, *table.notes)
    if not table.features:
        raise UserError(". ".join((f"'{path.name}' has no polygons", *notes)))
    shapes = [
        Shape(
            str(feature.properties.get("name") or feature.properties.get("NAME") or feature.id or path.stem),
            feature.mesh,
            bool(feature.properties.get(keys.Y_DOWN, (table.pixels or {}).get("y") == "down")),
            EXPORTED if keys.Y_DOWN in feature.properties else PIXEL,
        )
        for feature in table.features
        if "piece" not in feature.properties
    ]
    return shapes, True, notes


def content_of(path: Path) -> bytes:
    """What is in a file of a size that can be read. Raises: UserError."""
    if not path.exists():
        raise UserError(f"There is no file '{path}'")
    with blamed(f"'{path.name}' cannot be read"):
        return core.formats.read_whole(path, core.formats.Limits())


def place(context: Context, shapes: list[Shape], *, scale: float) -> Work[list[Object]]:
    """New objects of edges, each around its own centre, so that distant places keep their precision. Raises: UserError.

    scale: metres per unit of the file, 0 for the default.
    """
    made: list[tuple[str, core.Mesh, FloatArray]] = []
    for shape in shapes:
        yield Progress(0.5 + 0.5 * len(made) / len(shapes), f"placing '{shape.name}'")
        unit = scale or shape.scale
        points = shape.mesh.vertices * (unit, -unit if shape.y_down else unit)
        middle = middle_of(points)
        made.append((shape.name, stored_mesh(shape.name, [points[loop] - middle for loop in shape.mesh.loops]), middle))
    placed = []
    for name, mesh, middle in made:
        obj = bpy.data.objects.new(name, mesh_data.new_mesh(name, mesh.vertices, mesh.edges))
        obj.location = (*middle.tolist(), 0.0)
        context.collection.objects.link(obj)
        placed.append(obj)
    return placed


def arrange(objects: Sequence[Object], axes: FloatArray, *, centred: bool = False) -> None:
    """Turns new objects, which lie on the floor, to the directions (2, 3) of their x and y axes; what is higher in the
    stack is in front. centred: with the middle of all at the origin.
    """
    middle = np.zeros(2)
    if centred:
        ends = [mesh_data.points_of(mesh_data.mesh_of(obj)) + np.array(obj.location) for obj in objects]
        middle = middle_of(np.concatenate([np.stack([each.min(axis=0), each.max(axis=0)]) for each in ends])[:, :2])
    for obj in objects:
        obj.matrix_world = turned(axes) @ Matrix.Translation(obj.location - Vector((*middle.tolist(), 0.0)))


def middle_of(points: FloatArray) -> FloatArray:
    """The middle (2,) of the bounding box of points (n, 2), a float32 value."""
    return (0.5 * (points.min(axis=0) + points.max(axis=0))).astype(np.float32).astype(np.float64)


def stored_mesh(name: str, loops: list[FloatArray]) -> core.Mesh:
    """The core's ``Mesh`` of loops (k, 2) in float32 precision. Raises: UserError.

    Points that coincide in float32 are merged, and loops that touch because of it are joined.
    """
    extent = size(np.concatenate(loops))
    rounded = [without_doubles(loop.astype(np.float32), extent).astype(np.float64) for loop in loops]
    return core.Mesh.from_loops(united_loops(name, rounded, evenodd=True))
