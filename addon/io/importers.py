"""Drawings in the scene from files: outlines in the formats that cages are written in, and the parts of a layered SVG,
as faces in their colours, with groups as collections. Silhouettes: several objects and layers as one filled outline in
a plane, their painted areas projected and united.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import bpy
import numpy as np
from bpy.types import Collection, Context, Mesh, Object
from mathutils import Color, Matrix

from .. import keys, record
from ..core import blamed, core, triangulation
from ..errors import FloatArray, UserError
from ..generation.job import Progress, Work
from ..scene import display, filling, ownership
from ..scene.areas import areas_of
from ..scene.chains import without_doubles
from ..scene.ownership import scene_of
from ..scene.plane import Frame, divided, fitted_frame, outline_of, own_frame, size, united, world_matrix
from ..scene.reading import READERS, lines_of

SVG, MAPS = (".svg",), (".geojson", ".json")

# Metres per unit: of drawings, whose unit is a pixel, and of files exported from Blender, which keep their size.
PIXEL, EXPORTED = 0.01, 1.0
# Whether an SVG becomes an outline of each shape, by the choices of the operator.
EACH = {"ONE": False, "SEVERAL": True, "PARTS": True, "AUTO": None}
# Longest edge of a part as a fraction of the drawing's size: straight limbs bend too.
LONGEST_SIDE = 1.0 / 64.0
# Distance between two parts in the stack, as a fraction of the drawing's size.
DEPTH = 1e-3

# Materials by kind, "Fill" or "Stroke", and colour.
Materials = dict[tuple[str, tuple[float, ...]], bpy.types.Material]
# Kind, colour and outline of one colour of a part, around the part's middle.
Paint: TypeAlias = "tuple[str, tuple[float, ...], core.Mesh]"


@dataclass(frozen=True)
class Shape:
    """A mesh of the core and its name, and by default: whether its y points down, and metres per unit."""

    name: str
    mesh: core.Mesh
    y_down: bool
    scale: float = PIXEL


def shapes_in(path: Path, outlines: str = "AUTO") -> tuple[list[Shape], tuple[str, ...]]:
    """The filled area of an SVG, each feature of a GeoJSON, or a collision outline, and notes on what was repaired or
    left out. Raises: UserError.

    outlines: of an SVG, "ONE" of everything, "SEVERAL" of each shape, or "AUTO", several of exported cages.
    """
    exchange, ending = core.exchange, path.suffix.lower()
    if path.exists() and ending not in (*SVG, *MAPS):
        raise UserError(f"'{path.name}' is not a supported file type: choose .svg, .geojson or .json")
    content = _content(path)
    with blamed(f"'{path.name}' cannot be read"):
        if ending in SVG:
            found = exchange.svg_drawing(content, each=EACH[outlines])
            scale = EXPORTED if found.written else PIXEL
            return [Shape(name or path.stem, mesh, True, scale) for name, mesh in found.shapes], found.notes
        if exchange.is_engine_json(content):
            return [Shape(path.stem, exchange.from_engine_json(content), True, EXPORTED)], ()
        table = exchange.read_map(content)
    notes = (*table.refused, *table.notes)
    if not table.features:
        raise UserError(". ".join((f"'{path.name}' has no polygons", *notes)))
    shapes = [
        Shape(
            str(feature.properties.get("name") or feature.properties.get("NAME") or feature.id or path.stem),
            feature.mesh,
            bool(feature.properties.get(keys.Y_DOWN, False)),
            EXPORTED if keys.Y_DOWN in feature.properties else PIXEL,
        )
        for feature in table.features
    ]
    return shapes, notes


def parts_in(path: Path) -> tuple[tuple[core.exchange.SvgPart, ...], tuple[str, ...]]:
    """The parts of a layered SVG, the lowest first, and notes on what was left out. Raises: UserError."""
    content = _content(path)
    with blamed(f"'{path.name}' cannot be read"):
        return core.exchange.svg_parts(content)


def _content(path: Path) -> bytes:
    """What is in a file of a size that can be read. Raises: UserError."""
    if not path.exists():
        raise UserError(f"There is no file '{path}'")
    with blamed(f"'{path.name}' cannot be read"):
        return core.exchange.read_whole(path, core.exchange.Limits())


def place(context: Context, shapes: list[Shape], *, y_down: bool | None, scale: float) -> Work[list[Object]]:
    """New objects of edges, each around its own centre, so that distant places keep their precision. Raises: UserError.

    y_down: whether the y axis points down, None for the default of the file format; scale: metres per unit of the file,
    0 for the default.
    """
    made: list[tuple[str, core.Mesh, FloatArray]] = []
    for shape in shapes:
        yield Progress(0.5 + 0.5 * len(made) / len(shapes), f"placing '{shape.name}'")
        turned = shape.y_down if y_down is None else y_down
        unit = scale or shape.scale
        points = shape.mesh.vertices * (unit, -unit if turned else unit)
        middle = _middle(points)
        made.append((shape.name, _stored(shape.name, [points[loop] - middle for loop in shape.mesh.loops]), middle))
    found = []
    for name, mesh, middle in made:
        obj = bpy.data.objects.new(name, filling.new_mesh(name, mesh.vertices, mesh.edges))
        obj.location = (*middle.tolist(), 0.0)
        context.collection.objects.link(obj)
        found.append(obj)
    return found


def place_parts(
    context: Context, title: str, parts: tuple[core.exchange.SvgPart, ...], *, y_down: bool, scale: float
) -> Work[list[Object]]:
    """New objects, each around its own centre and above the one before, in a collection per group. Raises: UserError.

    scale: metres per unit of the file, 0 for the default.
    """
    scale = scale or PIXEL
    turn = np.array((scale, -scale if y_down else scale))
    own = [np.concatenate([mesh.vertices for mesh in (part.fill, part.stroke) if mesh]) * turn for part in parts]
    extent = size(np.concatenate(own))
    made: list[tuple[core.exchange.SvgPart, FloatArray, list[Paint]]] = []
    for part, points in zip(parts, own, strict=True):
        yield Progress(0.5 + 0.5 * len(made) / len(parts), f"placing '{part.name}'")
        middle, paints = _middle(points), []
        coloured = (("Fill", part.fill, part.fill_colour), ("Stroke", part.stroke, part.stroke_colour))
        for kind, mesh, shade in coloured:
            if mesh is not None:
                loops = [divided(mesh.vertices[loop] * turn - middle, LONGEST_SIDE * extent) for loop in mesh.loops]
                paints.append((kind, tuple(shade), _stored(part.name, loops)))
        made.append((part, middle, paints))
    home = bpy.data.collections.new(title)
    context.collection.children.link(home)
    groups: dict[tuple[str, ...], Collection] = {(): home}
    materials: Materials = {}
    found = []
    for number, (part, middle, paints) in enumerate(made):
        obj = bpy.data.objects.new(part.name, _faces(part.name, paints, materials))
        obj.location = (*middle.tolist(), DEPTH * extent * number)
        obj.color = obj.data.materials[0].diffuse_color
        _group(groups, part.groups).objects.link(obj)
        found.append(obj)
    return found


def _group(known: dict[tuple[str, ...], Collection], groups: tuple[str, ...]) -> Collection:
    """The collection of a group, a new one inside that of the group around it."""
    if groups not in known:
        known[groups] = bpy.data.collections.new(groups[-1])
        _group(known, groups[:-1]).children.link(known[groups])
    return known[groups]


def _faces(name: str, paints: list[Paint], materials: Materials) -> Mesh:
    """A new mesh of all paints, joined where they have the same points, and a material of each."""
    points: dict[tuple[float, float], int] = {}
    faces: list[list[int]] = []
    slots: list[int] = []
    for slot, (_, _, mesh) in enumerate(paints):
        numbers = [points.setdefault((x, y), len(points)) for x, y in mesh.vertices.tolist()]
        triangles = triangulation.triangulate(mesh).triangles.tolist()
        faces += [[numbers[corner] for corner in triangle] for triangle in triangles]
        slots += [slot] * len(triangles)
    data = filling.new_mesh(name, np.array(list(points)), faces=faces)
    for kind, shade, _ in paints:
        if (kind, shade) not in materials:
            code = "".join(f"{round(255.0 * part):02X}" for part in shade[:3])
            colour = Color(shade[:3]).from_srgb_to_scene_linear()
            materials[kind, shade] = display.flat_material(f"{kind} #{code}", (*colour[:], shade[3]))
        data.materials.append(materials[kind, shade])
    data.polygons.foreach_set("material_index", slots)
    return data


def _middle(points: FloatArray) -> FloatArray:
    """The middle (2,) of the bounding box of points (n, 2), a float32 value."""
    return (0.5 * (points.min(axis=0) + points.max(axis=0))).astype(np.float32).astype(np.float64)


def _stored(name: str, loops: list[FloatArray]) -> core.Mesh:
    """The core's ``Mesh`` of loops (k, 2) in float32 precision. Raises: UserError.

    FloatArray that coincide in float32 are merged, and loops that touch because of it are joined.
    """
    extent = size(np.concatenate(loops))
    rounded = [without_doubles(loop.astype(np.float32), extent).astype(np.float64) for loop in loops]
    return core.Mesh.from_loops(outline_of(name, rounded, evenodd=True))


# Directions of the x and y axes of planes facing a world axis.
AXES = {
    "TOP": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    "FRONT": ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "RIGHT": ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
}
# Largest area of faces seen edge-on, as a fraction of their size squared.
EDGE_ON = 1e-12


def plane_of(context: Context, active: Object, plane: str) -> Frame:
    """The plane to project onto: "ACTIVE", that of the active object, "VIEW", or a key of `AXES`. Raises: UserError."""
    if plane == "ACTIVE":
        points = np.array([corner[:] for corner in active.bound_box], dtype=np.float64)
        if active.type in READERS:
            points = lines_of(context, active).vertices.astype(np.float64)
        matrix = world_matrix(active)
        return own_frame(matrix, points) or fitted_frame(matrix, points)
    if plane == "VIEW":
        view = getattr(context, "region_data", None)
        if view is None:
            raise UserError("There is no view to look from: call it in a 3D view, or choose another plane")
        x, y, _ = np.array(view.view_matrix.to_3x3(), dtype=np.float64)
    else:
        x, y = map(np.array, AXES[plane])
    return Frame.through(np.array(active.matrix_world.translation), x, y)


def outline(
    context: Context,
    objects: Sequence[Object],
    frame: Frame,
    *,
    strokes: bool = True,
    closed: bool = False,
    fill_holes: bool = False,
    gap: float = 0.0,
) -> Work[tuple[tuple[FloatArray, ...], list[UserError]]]:
    """The loops (k, 2) of the silhouette of objects in a frame, and why some have none. Raises: UserError if all do.

    strokes: with the width of strokes; closed: closed ones are areas too. fill_holes: without holes. gap: parts closer
    than this length of the scene are joined.
    """
    areas: list[core.exchange.Painted] = []
    problems: list[UserError] = []
    for done, obj in enumerate(objects):
        yield Progress(0.5 * done / len(objects), f"reading '{obj.name}'")
        try:
            found = areas_of(context, obj, frame, strokes=strokes, closed=closed)
            areas += [area for area in found if any(map(_has_room, area.loops))]
        except UserError as error:
            problems.append(error)
    name = objects[0].name
    if not areas:
        raise problems[0] if problems else UserError(f"'{name}' is seen from the side: choose another plane")
    yield Progress(0.5, "uniting painted areas")
    loops = united(name, areas)
    if gap > 0.0:
        mesh = core.exchange.joined(core.Mesh.from_loops(loops), gap / frame.scale)
        loops = united(name, [core.exchange.Painted([mesh.vertices[loop] for loop in mesh.loops], evenodd=True)])
    if fill_holes:
        mesh = core.Mesh.from_loops(loops)
        outer = [mesh.vertices[loop] for loop, sign in zip(mesh.loops, mesh.loop_signs, strict=True) if sign > 0]
        loops = united(name, [core.exchange.Painted([loop]) for loop in outer])
    return loops, problems


def _has_room(loop: FloatArray) -> bool:
    """Whether a loop is not seen from the side."""
    x, y = (loop - loop[0]).T
    twice = abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
    return twice > EDGE_ON * float(np.ptp(x) ** 2 + np.ptp(y) ** 2)


def place_silhouette(
    context: Context, active: Object, frame: Frame, loops: Sequence[FloatArray], parts: Sequence[Object]
) -> Object:
    """A new flat mesh with the loops as its border, in the collection of the active object and with its material.

    parts: the objects whose silhouette it is, which will follow its cages too.
    """
    mesh = core.Mesh.from_loops(loops)
    name = f"{active.name} Silhouette"
    obj = bpy.data.objects.new(name, filling.filled(name, frame.points(mesh.vertices), mesh))
    if active.active_material is not None and active.type != "GREASEPENCIL":
        obj.data.materials.append(active.active_material)
    ownership.home_of(scene_of(context), active).objects.link(obj)
    obj.matrix_world = Matrix(frame.matrix.tolist())
    record.fill(record.described(obj).parts, parts)
    return obj
