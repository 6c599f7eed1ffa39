"""Cages as faces that play their animation, as convex pieces for collisions, and as files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import bpy
import numpy as np
from bpy.types import Context, Object
from mathutils import Matrix

from .. import cage_sets, keys
from ..animation import visibility
from ..blender import display, mesh_data, shape_keys
from ..core import blamed, core, triangulation
from ..drawing import placement, planar
from ..drawing.plane import PLANARITY, Frame
from ..errors import UserError
from ..memory import remembered

# Units of length in CSS with their metres: of Blender's units that CSS has, and of systems for all others.
CSS_UNITS = {
    **dict.fromkeys(("MILLIMETERS", "METRIC"), ("mm", 1e-3)),
    "CENTIMETERS": ("cm", 1e-2),
    **dict.fromkeys(("INCHES", "IMPERIAL"), ("in", 0.0254)),
}


def put(new: Object, obj: Object, frame: Frame) -> None:
    """Gives a new object the place of one with this frame."""
    standing = placement.standing(obj)
    if frame.own and standing is not None:
        placement.copy_transform(standing, new)
    else:
        new.matrix_world = Matrix(frame.matrix.tolist())


def make_animated(objects: Sequence[Object]) -> list[Object]:
    """A copy of each animated level, with its shape keys, its action, and triangles between its vertices.

    Alembic keeps only the points of a mesh without faces; glTF keeps both, loose edges as lines on request. The
    triangles fill the result and deform until then. The copies are visible on all frames, because exporters
    leave out objects that are hidden on their first. Raises: UserError.
    """
    for obj in objects:
        if cage_sets.level_of(obj) is None or obj.data.shape_keys is None:
            raise UserError(f"'{obj.name}' is not an animated cage: choose faces instead")
    outlines = [mesh_data.shape_of(obj) for obj in objects]
    made = []
    for obj, outline in zip(objects, outlines, strict=True):
        new = obj.copy()
        new.data = obj.data.copy()
        new.name = new.data.name = f"{obj.name} Animated"
        mesh_data.add_faces(mesh_data.mesh_of(new), triangulation.triangulate(outline).triangles)
        if shape_keys.action_of(new) is not None:
            shape_keys.own_action(new, new.name)
            visibility.always_show(new)
        display.set_thickness(new, 0.0)
        new.display_type, new.show_in_front = "TEXTURED", False
        cage_sets.remove(new)
        (obj.users_collection or [bpy.context.scene.collection])[0].objects.link(new)
        made.append(new)
    return made


def meshes(
    context: Context, objects: Sequence[Object], *, world: bool = False, scale: float = 1.0
) -> dict[str, core.Mesh]:
    """The core's ``Mesh`` of each object by its name, times `scale`. Raises: UserError.

    In the plane and coordinates of the first; or, with `world`, in world coordinates seen from the top, the front or
    the right, whichever the drawing faces.
    """
    outlines = [planar.read(context, obj) for obj in objects]
    first = planar.fine_drawing(outlines[0])
    seen = _facing_axes(first) if world else None
    by_name = {}
    for obj, outline in zip(objects, outlines, strict=True):
        drawing = first if outline is outlines[0] else planar.drawing_in(first.frame, outline)
        mesh = drawing.mesh()
        if seen is not None or scale != 1.0:
            points = mesh.vertices if seen is None else first.frame.to_world(mesh.vertices)[:, seen]
            mesh = core.Mesh.from_loops([scale * points[loop] for loop in mesh.loops])
        by_name[obj.name] = mesh
    return by_name


def _facing_axes(drawing: planar.Drawing) -> list[int]:
    """The two world axes of the plane that a drawing faces. Raises: UserError if it is tilted."""
    normal = np.abs(np.cross(drawing.frame.matrix[:3, 0], drawing.frame.matrix[:3, 1]))
    away = int(normal.argmax())
    if np.delete(normal, away).max() > PLANARITY * normal[away]:
        raise UserError(f"'{drawing.name}' is tilted: turn it to the top, front or right, or untick 'World'")
    return [axis for axis in range(3) if axis != away]


def paper(context: Context, obj: Object, *, world: bool) -> tuple[float, str] | None:
    """The length of a unit of `meshes` on paper and its CSS unit, as the scene shows lengths; None if it shows none."""
    shown = context.scene.unit_settings
    if shown.system == "NONE":
        return None
    unit = 1.0 if world else planar.fine_drawing(planar.read(context, obj)).frame.scale
    name, metre = CSS_UNITS.get(shown.length_unit, CSS_UNITS[shown.system])
    return unit * shown.scale_length / metre, name


def write(
    path: Path,
    kind: str,
    shapes: dict[str, core.Mesh],
    *,
    flip_y: bool,
    levels: Sequence[int] | None = None,
    size: Any = None,
    pieces: int | None = None,
) -> None:
    """Writes meshes by name, from the inside out, to a file of a kind: "SVG" or "GEOJSON". Raises: UserError.

    flip_y: y pointing down as in pictures. `levels` and `size`: as of ``to_svg``; `pieces`: as of ``to_geojson``.
    """
    formats, turn = core.formats, (1.0, -1.0 if flip_y else 1.0)
    turned = {name: core.Mesh(mesh.vertices * turn + 0.0, mesh.edges) for name, mesh in shapes.items()}
    with blamed(f"'{path.name}' cannot be written"):
        if kind == "SVG":
            text = formats.to_svg(turned, levels=levels, size=size)
        else:
            features = []
            for k, (name, mesh) in enumerate(turned.items()):
                own = {"name": name, keys.Y_DOWN: flip_y, **formats.measures(mesh)}
                features.append(formats.Feature(mesh, own if levels is None else {**own, "level": levels[k]}))
            text = formats.to_geojson(features, pieces=pieces)
        formats.write_whole(path, text)


# A drawing, its mesh, and its convex pieces as indices of vertices.
Tiles: TypeAlias = "tuple[planar.Drawing, core.Mesh, Sequence[Sequence[int]]]"


def make_pieces(context: Context, objects: Sequence[Object], most: int) -> list[Object]:
    """The convex pieces of each object as it is evaluated now, faces of at most so many vertices in a collection of
    their own next to it. Raises: UserError.
    """
    tiles: list[Tiles] = []
    for obj in objects:
        drawing = planar.fine_drawing(planar.read(context, obj))
        mesh = drawing.mesh()
        with blamed(f"'{drawing.name}'"):
            made_of = partial(core.formats.piece_vertices, mesh, most)
            tiles.append((drawing, mesh, remembered(made_of, mesh.vertices.nbytes, "pieces", mesh, most)))
    return [new for obj, each in zip(objects, tiles, strict=True) for new in _place_pieces(context, obj, each)]


def _place_pieces(context: Context, obj: Object, tiles: Tiles) -> Iterator[Object]:
    """The pieces of one object."""
    drawing, mesh, pieces = tiles
    points = drawing.frame.points(mesh.vertices)
    home = bpy.data.collections.new(f"{obj.name} Pieces")
    (obj.users_collection or [context.scene.collection])[0].children.link(home)
    for number, piece in enumerate(pieces, 1):
        name = f"{obj.name} Piece {number}"
        new = bpy.data.objects.new(name, mesh_data.new_mesh(name, points[list(piece)], faces=[range(len(piece))]))
        new.color = display.colour(1, number)
        home.objects.link(new)
        put(new, obj, drawing.frame)
        yield new
