"""What the faces of an evaluated object show in a plane, and which objects show more than their lines."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from bpy.types import Object

from ..blender.display import is_ours
from ..blender.mesh_data import evaluated_mesh, loop_edges, points_of, stored
from ..core import core
from ..errors import FloatArray
from .edge_loops import SMALLEST_LOOP, chains
from .plane import Frame, transform

# Relative difference of areas that is more than rounding of float32.
SAME_AREA = 1e-5
# Area of a triangle seen edge-on, over its size squared.
EDGE_ON = 1e-12


def is_thick(obj: Object) -> bool:
    """Whether a curve or text has faces beyond its lines: by offset, bevel or extrusion."""
    if obj.type not in {"CURVE", "FONT"}:
        return False
    data = obj.data
    return bool(data.offset or data.bevel_depth or data.extrude or (data.bevel_mode == "OBJECT" and data.bevel_object))


def may_show_more(obj: Object) -> bool:
    """Whether faces of an object may lie beyond its outline: those of meshes, and what modifiers add to a curve. Wires
    show no faces, and of what follows a cage the outline counts.
    """
    modifiers = [each for each in obj.modifiers if each.show_viewport]
    if obj.display_type in {"WIRE", "BOUNDS"} or any(map(is_ours, modifiers)):
        return False
    return bool(modifiers) if obj.type == "CURVE" else obj.type == "MESH" and obj.mode != "EDIT"


class Shown(NamedTuple):
    """What an object shows in a frame, float32: triangles (t, 3, 2) not seen edge-on, and lone closed lines (k, 2)."""

    triangles: FloatArray
    loops: list[FloatArray]

    def areas(self) -> Iterator[core.formats.Painted]:
        """The triangles, and the inside of the lines."""
        yield from (core.formats.Painted([each]) for each in self.triangles)
        if self.loops:
            yield core.formats.Painted(self.loops, evenodd=True)


def shown_in(evaluated: Object, matrix: FloatArray, frame: Frame) -> Shown:
    """What an evaluated object with a matrix shows in a frame."""
    with evaluated_mesh(evaluated) as mesh:
        if mesh is None:
            return Shown(np.zeros((0, 3, 2)), [])
        mesh.calc_loop_triangles()
        points, lone = points_of(mesh), loop_edges(mesh, 0)
        triangles = stored(mesh.loop_triangles, "vertices", 3, np.int32)
    flat = seen(frame, transform(matrix, points))
    shapes = flat[triangles]
    spread = np.ptp(shapes, axis=1).max(axis=1) if len(shapes) else np.zeros(0)
    loops = [flat[loop] for loop in chains(lone, len(points)).closed if len(loop) >= SMALLEST_LOOP]
    return Shown(shapes[_areas(shapes) > EDGE_ON * spread**2], loops)


def seen(frame: Frame, points: FloatArray) -> FloatArray:
    """Points (n, 3) of the world in a frame, (n, 2), as float32 values."""
    return frame.from_world(points)[0].astype(np.float32).astype(np.float64)


def tile(triangles: FloatArray, loops: list[FloatArray]) -> bool:
    """Whether triangles (t, 3, 2) have the area that loops (k, 2) enclose, as they do if these are their outline; true
    without triangles, and for loops that cross.
    """
    try:
        whole = core.Mesh.from_loops(loops).area if len(triangles) else 0.0
    except core.NestedCagesError:
        return True
    return bool(abs(float(_areas(triangles).sum()) - whole) <= SAME_AREA * whole)


def _areas(triangles: FloatArray) -> FloatArray:
    """Areas (t,) of triangles (t, 3, 2)."""
    one, two = (triangles[:, k] - triangles[:, 0] for k in (1, 2))
    return np.asarray(0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]))
