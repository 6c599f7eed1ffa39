"""The parts of a layered SVG as faces in their colours, in a collection per group."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import bpy
import numpy as np
from bpy.types import Collection, Context, Mesh, Object
from mathutils import Color

from .. import keys
from ..blender import display, mesh_data
from ..blender.jobs import Progress, Work
from ..core import blamed, core, triangulation
from ..drawing.plane import divided, size
from ..errors import FloatArray
from .importers import PIXEL, SVG, content_of, middle_of, stored_mesh
from .pictures import image_of_pixels, pictures_in

# Longest edge of a part as a fraction of the drawing's size: straight limbs bend too.
LONGEST_SIDE = 1.0 / 64.0
# Distance between two parts in the stack, as a fraction of the drawing's size.
DEPTH = 1e-3

# Pixels of the longer side of the picture of a gradient.
GRADIENT_SIDE = 256

# Materials by kind, "Fill" or "Stroke", and colour.
Materials = dict[tuple[str, tuple[float, ...]], bpy.types.Material]


class Paint(NamedTuple):
    """One paint of a part: its kind, colour and outline around the part's middle, and a picture of its gradient."""

    kind: str
    colour: tuple[float, ...]
    mesh: core.Mesh
    picture: FloatArray | None
    """(h, w, 4) over the box of the outline, the bottom row first; None for one colour."""


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
        parts, notes = core.formats.svg_parts(content, background=outlines != "PUPPET", crop=False)
    return ((), ()) if automatic and len(parts) < 2 else (parts, notes)


def place(context: Context, title: str, parts: tuple[core.formats.SvgPart, ...], *, scale: float) -> Work[list[Object]]:
    """New objects, each around its own centre and above the one before, in a collection per group. Raises: UserError.

    scale: metres per unit of the file, 0 for the default.
    """
    scale = scale or PIXEL
    turn = np.array((scale, -scale))
    own = [np.concatenate([mesh.vertices for mesh in (part.fill, part.stroke) if mesh]) * turn for part in parts]
    extent = size(np.concatenate(own))
    made: list[tuple[core.formats.SvgPart, FloatArray, list[Paint]]] = []
    for part, points in zip(parts, own, strict=True):
        yield Progress(0.5 + 0.5 * len(made) / len(parts), f"placing '{part.name}'")
        middle, paints = middle_of(points), []
        fill = ("Fill", part.fill, part.fill_colour, part.fill_gradient)
        stroke = ("Stroke", part.stroke, part.stroke_colour, part.stroke_gradient)
        for kind, mesh, shade, gradient in (fill, stroke):
            if mesh is not None:
                loops = [divided(mesh.vertices[loop] * turn - middle, LONGEST_SIDE * extent) for loop in mesh.loops]
                picture = _picture(gradient, mesh) if gradient is not None else None
                picture = picture[::-1] if picture is not None else None
                paints.append(Paint(kind, tuple(shade), stored_mesh(part.name, loops), picture))
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
    places: list[FloatArray] = []
    for slot, paint in enumerate(paints):
        vertices = paint.mesh.vertices
        numbers = [points.setdefault((x, y), len(points)) for x, y in vertices.tolist()]
        triangles = triangulation.triangulate(paint.mesh).triangles
        faces += [[numbers[corner] for corner in triangle] for triangle in triangles.tolist()]
        slots += [slot] * len(triangles)
        places.append(((vertices - vertices.min(axis=0)) / np.ptp(vertices, axis=0))[triangles.ravel()])
    data = mesh_data.new_mesh(name, np.array(list(points)), faces=faces)
    for paint in paints:
        data.materials.append(_flat(paint, materials) if paint.picture is None else _shaded(name, paint))
    data.polygons.foreach_set("material_index", slots)
    if any(paint.picture is not None for paint in paints):
        data.uv_layers.new(name="UVMap").data.foreach_set("uv", np.concatenate(places).astype(np.float32).ravel())
    return data


def _flat(paint: Paint, materials: Materials) -> bpy.types.Material:
    """The material of one colour, which all paints of that kind share."""
    key = paint.kind, paint.colour
    if key not in materials:
        code = "".join(f"{round(255.0 * part):02X}" for part in paint.colour[:3])
        colour = Color(paint.colour[:3]).from_srgb_to_scene_linear()
        materials[key] = display.flat_material(f"{paint.kind} #{code}", (*colour[:], paint.colour[3]))
    return materials[key]


def _shaded(name: str, paint: Paint) -> bpy.types.Material:
    """A new material that shows the picture of a gradient."""
    assert paint.picture is not None
    name = f"{name} {paint.kind}"
    made = display.material(display.CUTOUT, name)
    made.diffuse_color = (*Color(paint.colour[:3]).from_srgb_to_scene_linear()[:], paint.colour[3])
    for node in pictures_in(made):
        node.image, node.extension = image_of_pixels(name, paint.picture), "EXTEND"
        node.image[keys.GRADIENT] = True
    return made


def _picture(gradient: core.formats.Shades, mesh: core.Mesh) -> FloatArray:
    """(h, w, 4) a gradient over the box of an outline, the row of the least y first."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    width, height = np.ceil(GRADIENT_SIDE * (high - low) / (high - low).max()).astype(int).tolist()
    return core.formats.shaded(gradient, low, high, (height, width))
