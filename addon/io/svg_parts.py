"""The parts of a layered SVG as faces in their colours, in a collection per group."""

from __future__ import annotations

from pathlib import Path
from typing import TypeAlias

import bpy
import numpy as np
from bpy.types import Collection, Context, Mesh, Object
from mathutils import Color

from ..core import blamed, core, triangulation
from ..errors import FloatArray
from ..generation.job import Progress, Work
from ..scene import display, filling
from ..scene.plane import divided, size
from .importers import PIXEL, SVG, content_of, middle_of, stored_mesh

# Longest edge of a part as a fraction of the drawing's size: straight limbs bend too.
LONGEST_SIDE = 1.0 / 64.0
# Distance between two parts in the stack, as a fraction of the drawing's size.
DEPTH = 1e-3

# Materials by kind, "Fill" or "Stroke", and colour.
Materials = dict[tuple[str, tuple[float, ...]], bpy.types.Material]
# Kind, colour and outline of one colour of a part, around the part's middle.
Paint: TypeAlias = "tuple[str, tuple[float, ...], core.Mesh]"


def read(path: Path, outlines: str) -> tuple[tuple[core.formats.SvgPart, ...], tuple[str, ...]]:
    """The parts of a layered SVG, the lowest first, and notes on what was left out. Raises: UserError.

    outlines: "PARTS" or "PUPPET", which leaves out the background, or "AUTO" for none of exported cages and of drawings
    of a single shape; else none.
    """
    wanted, automatic = path.suffix.lower() in SVG and outlines in ("PARTS", "PUPPET", "AUTO"), outlines == "AUTO"
    if not wanted:
        return (), ()
    content = content_of(path)
    with blamed(f"'{path.name}' cannot be read"):
        if automatic and core.formats.is_written_svg(content):
            return (), ()
        parts, notes = core.formats.svg_parts(content, background=outlines != "PUPPET")
    return ((), ()) if automatic and len(parts) < 2 else (parts, notes)


def place(
    context: Context, title: str, parts: tuple[core.formats.SvgPart, ...], *, y_down: bool, scale: float
) -> Work[list[Object]]:
    """New objects, each around its own centre and above the one before, in a collection per group. Raises: UserError.

    scale: metres per unit of the file, 0 for the default.
    """
    scale = scale or PIXEL
    turn = np.array((scale, -scale if y_down else scale))
    own = [np.concatenate([mesh.vertices for mesh in (part.fill, part.stroke) if mesh]) * turn for part in parts]
    extent = size(np.concatenate(own))
    made: list[tuple[core.formats.SvgPart, FloatArray, list[Paint]]] = []
    for part, points in zip(parts, own, strict=True):
        yield Progress(0.5 + 0.5 * len(made) / len(parts), f"placing '{part.name}'")
        middle, paints = middle_of(points), []
        coloured = (("Fill", part.fill, part.fill_colour), ("Stroke", part.stroke, part.stroke_colour))
        for kind, mesh, shade in coloured:
            if mesh is not None:
                loops = [divided(mesh.vertices[loop] * turn - middle, LONGEST_SIDE * extent) for loop in mesh.loops]
                paints.append((kind, tuple(shade), stored_mesh(part.name, loops)))
        made.append((part, middle, paints))
    home = bpy.data.collections.new(title)
    context.collection.children.link(home)
    groups: dict[tuple[str, ...], Collection] = {(): home}
    materials: Materials = {}
    placed = []
    for number, (part, middle, paints) in enumerate(made):
        obj = bpy.data.objects.new(part.name, _mesh_of_paints(part.name, paints, materials))
        obj.location = (*middle.tolist(), DEPTH * extent * number)
        obj.color = obj.data.materials[0].diffuse_color
        _group(groups, part.groups).objects.link(obj)
        placed.append(obj)
    return placed


def _group(known: dict[tuple[str, ...], Collection], groups: tuple[str, ...]) -> Collection:
    """The collection of a group, a new one inside that of the group around it."""
    if groups not in known:
        known[groups] = bpy.data.collections.new(groups[-1])
        _group(known, groups[:-1]).children.link(known[groups])
    return known[groups]


def _mesh_of_paints(name: str, paints: list[Paint], materials: Materials) -> Mesh:
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
