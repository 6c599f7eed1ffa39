"""Silhouettes: several objects and layers as one filled outline, their painted areas united in a plane."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from bpy.types import Context, Object
from mathutils import Matrix

from .. import cage_sets
from ..blender import mesh_data
from ..blender.jobs import Progress, Work
from ..cage_sets import selection
from ..cage_sets.selection import scene_of
from ..core import core
from ..drawing.evaluated import READERS, lines_of
from ..drawing.grease_pencil import KINDS, Painting
from ..drawing.painted import areas_of
from ..drawing.plane import Frame, fitted_frame, own_frame, united, world_matrix
from ..errors import FloatArray, UserError

# Largest area of faces seen edge-on, as a fraction of their size squared.
EDGE_ON = 1e-12


def plane_of(context: Context, active: Object, axes: FloatArray | None = None) -> Frame:
    """The plane that an object lies in, or one through its origin with these axes (2, 3). Raises: UserError."""
    if axes is not None:
        return Frame.through(np.array(active.matrix_world.translation), *axes)
    if active.type in KINDS:
        return Painting.of(context, active).frame()
    points = np.array([corner[:] for corner in active.bound_box], dtype=np.float64)
    if active.type in READERS:
        points = lines_of(context, active).vertices.astype(np.float64)
    if len(points) == 0:
        raise UserError(f"'{active.name}' is empty: draw something in it, or choose another plane")
    matrix = world_matrix(active)
    return own_frame(matrix, points) or fitted_frame(matrix, points)


def painted_loops(
    context: Context,
    objects: Sequence[Object],
    frame: Frame,
    *,
    closed: bool = False,
    fill_holes: bool = False,
    gap: float = 0.0,
) -> Work[tuple[tuple[FloatArray, ...], list[UserError]]]:
    """The loops (k, 2) of the silhouette of objects in a frame, and why some have none. Raises: UserError if all do.

    closed: closed strokes are areas too. fill_holes: without holes. gap: parts closer than this length of the scene are
    joined.
    """
    areas: list[core.formats.Painted] = []
    problems: list[UserError] = []
    for done, obj in enumerate(objects):
        yield Progress(0.5 * done / len(objects), f"reading '{obj.name}'")
        try:
            painted = areas_of(context, obj, frame, closed=closed)
            areas += [area for area in painted if any(map(_has_room, area.loops))]
        except UserError as error:
            problems.append(error)
    name = objects[0].name
    if not areas:
        raise problems[0] if problems else UserError(f"'{name}' is seen from the side or scaled to nothing: turn it")
    yield Progress(0.5, "uniting painted areas")
    loops = united(name, areas)
    if gap > 0.0:
        mesh = core.formats.joined(core.Mesh.from_loops(loops), gap / frame.scale)
        loops = united(name, [core.formats.Painted([mesh.vertices[loop] for loop in mesh.loops], evenodd=True)])
    if fill_holes:
        mesh = core.Mesh.from_loops(loops)
        outer = [mesh.vertices[loop] for loop, sign in zip(mesh.loops, mesh.loop_signs, strict=True) if sign > 0]
        loops = united(name, [core.formats.Painted([loop]) for loop in outer])
    return loops, problems


def _has_room(loop: FloatArray) -> bool:
    """Whether a loop is not seen from the side."""
    x, y = (loop - loop[0]).T  # at 0, which the last edge, from the last point to the first, adds
    twice = abs(float(x[:-1] @ y[1:] - y[:-1] @ x[1:]))
    return twice > EDGE_ON * float((x.max() - x.min()) ** 2 + (y.max() - y.min()) ** 2)


def place_silhouette(
    context: Context, active: Object, frame: Frame, loops: Sequence[FloatArray], parts: Sequence[Object]
) -> Object:
    """A new flat mesh with the loops as its border, in the collection of the active object and with its material.

    parts: the objects whose silhouette it is, which will follow its cages too.
    """
    mesh = core.Mesh.from_loops(loops)
    name = f"{active.name} Silhouette"
    obj = bpy.data.objects.new(name, mesh_data.filled(name, frame.points(mesh.vertices), mesh))
    if active.active_material is not None and active.type != "GREASEPENCIL":
        obj.data.materials.append(active.active_material)
    selection.home_of(scene_of(context), active).objects.link(obj)
    obj.matrix_world = Matrix(frame.matrix.tolist())
    cage_sets.show_in(obj, parts)
    return obj
