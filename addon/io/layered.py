"""The parts of a layered SVG as objects: fills and strokes as faces in their colours, groups as collections."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from mathutils import Color
from numpy.typing import NDArray

from ..core import core, triangulation
from ..errors import UserError, told
from ..generation.job import Progress, Work
from ..scene import display
from ..scene.plane import size
from ..scene.uniting import divided
from .importers import PIXEL, stored

# Longest edge of a part as a fraction of the drawing's size: straight limbs bend too.
LONGEST_SIDE = 1.0 / 64.0
# Distance between two parts in the stack, as a fraction of the drawing's size.
DEPTH = 1e-3

Points = NDArray[np.float64]
Shade = tuple[float, float, float, float]


@dataclass(frozen=True)
class Paint:
    """One colour of a part: loops (k, 2) around it, around the middle of the part."""

    name: str
    shade: Shade
    loops: tuple[Points, ...]


def read(path: Path) -> tuple[tuple[core.exchange.SvgPart, ...], tuple[str, ...]]:
    """The parts of an SVG file, the lowest first, and notes on what was left out. Raises: UserError."""
    try:
        parts, notes = core.exchange.svg_parts(core.exchange.read_whole(path, core.exchange.Limits()))
    except (core.NestedCagesError, OSError) as error:
        raise UserError(f"'{path.name}' cannot be read: {told(error)}") from error
    return tuple(parts), tuple(notes)


def place(
    context: bpy.types.Context, title: str, parts: tuple[core.exchange.SvgPart, ...], *, y_down: bool, scale: float
) -> Work[list[bpy.types.Object]]:
    """New objects, each around its own centre and above the one before, in a collection per group. Raises: UserError.

    scale: metres per unit of the file, 0 for the default.
    """
    scale = scale or PIXEL
    turn = np.array((scale, -scale if y_down else scale))
    corners = np.concatenate([mesh.vertices for part in parts for mesh in (part.fill, part.stroke) if mesh]) * turn
    extent = size(corners)
    made: list[tuple[core.exchange.SvgPart, Points, list[Paint]]] = []
    for part in parts:
        yield Progress(0.5 + 0.5 * len(made) / len(parts), f"placing '{part.name}'")
        own = np.concatenate([mesh.vertices for mesh in (part.fill, part.stroke) if mesh]) * turn
        middle = (0.5 * (own.min(axis=0) + own.max(axis=0))).astype(np.float32).astype(np.float64)
        paints = [
            Paint(kind, shade, _loops(part.name, mesh, turn, middle, LONGEST_SIDE * extent))
            for kind, mesh, shade in (
                ("Fill", part.fill, part.fill_colour),
                ("Stroke", part.stroke, part.stroke_colour),
            )
            if mesh is not None
        ]
        made.append((part, middle, paints))
    home = bpy.data.collections.new(title)
    context.collection.children.link(home)
    groups: dict[tuple[str, ...], bpy.types.Collection] = {(): home}
    materials: dict[tuple[str, Shade], bpy.types.Material] = {}
    found = []
    for number, (part, middle, paints) in enumerate(made):
        obj = bpy.data.objects.new(part.name, _faces(part.name, paints, materials))
        obj.location = (*middle.tolist(), DEPTH * extent * number)
        obj.color = obj.data.materials[0].diffuse_color
        _group(groups, part.groups).objects.link(obj)
        found.append(obj)
    return found


def _group(known: dict[tuple[str, ...], bpy.types.Collection], groups: tuple[str, ...]) -> bpy.types.Collection:
    """The collection of a group, a new one inside that of the group around it."""
    if groups not in known:
        known[groups] = bpy.data.collections.new(groups[-1])
        _group(known, groups[:-1]).children.link(known[groups])
    return known[groups]


def _loops(name: str, mesh: core.Mesh, turn: Points, middle: Points, longest: float) -> tuple[Points, ...]:
    """The loops of a mesh as they are stored, long edges divided."""
    loops = [divided(mesh.vertices[loop] * turn - middle, longest) for loop in mesh.loops]
    whole = stored(name, loops)
    return tuple(whole.vertices[loop] for loop in whole.loops)


def _faces(name: str, paints: list[Paint], materials: dict[tuple[str, Shade], bpy.types.Material]) -> bpy.types.Mesh:
    """A new mesh of all paints, joined where they have the same points, and a material of each."""
    points: dict[tuple[float, float], int] = {}
    faces: list[list[int]] = []
    slots: list[int] = []
    data = bpy.data.meshes.new(name)
    for slot, paint in enumerate(paints):
        mesh = core.Mesh.from_loops(paint.loops)
        numbers = [points.setdefault((x, y), len(points)) for x, y in mesh.vertices.tolist()]
        triangles = triangulation.triangulate(mesh).triangles.tolist()
        faces += [[numbers[corner] for corner in triangle] for triangle in triangles]
        slots += [slot] * len(triangles)
        data.materials.append(_material(materials, paint))
    data.from_pydata([(x, y, 0.0) for x, y in points], [], faces)
    data.polygons.foreach_set("material_index", slots)
    data.update()
    return data


def _material(known: dict[tuple[str, Shade], bpy.types.Material], paint: Paint) -> bpy.types.Material:
    """The material of a colour in this import."""
    key = (paint.name, paint.shade)
    if key not in known:
        code = "".join(f"{round(255.0 * part):02X}" for part in paint.shade[:3])
        red, green, blue = Color(paint.shade[:3]).from_srgb_to_scene_linear()[:]
        known[key] = display.flat_material(f"{paint.name} #{code}", (red, green, blue, paint.shade[3]))
    return known[key]
