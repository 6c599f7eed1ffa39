"""Outlines as files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from bpy.types import Context, Object

from .. import keys
from ..core import blamed, core
from ..drawing import planar
from ..drawing.plane import PLANARITY
from ..errors import UserError

# Units of length in CSS with their metres: of Blender's units that CSS has, and of systems for all others.
CSS_UNITS = {
    **dict.fromkeys(("MILLIMETERS", "METRIC"), ("mm", 1e-3)),
    "CENTIMETERS": ("cm", 1e-2),
    **dict.fromkeys(("INCHES", "IMPERIAL"), ("in", 0.0254)),
}


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
