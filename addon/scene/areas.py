"""The painted area of an evaluated object: faces, strokes with their width, and the inside of closed lines; and what is
painted on its vertices.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from bpy.types import Context, Object

from ..core import broad_phase, core
from ..errors import FloatArray, UserError
from .chains import SMALLEST_LOOP, chains
from .convert import read
from .filling import evaluated_mesh, loop_edges, points_of, stored, weights_of
from .plane import Frame, transform, world_matrix
from .reading import READERS, SMOOTH, STRAIGHT, has_nodes, realized, style_of, temporary, unseen

# Corners of the round end of a stroke. They circumscribe the circle, so that the stroke lies inside its area.
ROUND = 24
# Segments between two points of a smooth stroke, as many as Blender draws.
SEGMENTS = 12
# Types of objects that have faces.
SOLID = {"MESH", "CURVE", "FONT", "SURFACE", "META"}


def areas_of(
    context: Context, obj: Object, frame: Frame, *, strokes: bool = True, closed: bool = False
) -> list[core.exchange.Painted]:
    """All that an object paints, its instances included, as float32 shapes in a frame. Raises: UserError if nothing.

    strokes: with the width of Grease Pencil strokes; closed: closed strokes are areas too, even if not filled.
    """
    if obj.type == "GREASEPENCIL":
        areas = list(_drawn(context, obj, frame, strokes, closed or not strokes))
    else:
        areas, depsgraph = list[core.exchange.Painted](), context.evaluated_depsgraph_get()
        if obj.type in SOLID:  # faces, those of instances included, and the inside of closed lines
            areas += _faces(obj.evaluated_get(depsgraph), world_matrix(obj), frame)
            if has_nodes(obj):
                with temporary() as blocks:
                    shape = realized(context, obj, 0, blocks)
                    depsgraph = context.evaluated_depsgraph_get()
                    areas += _faces(shape.evaluated_get(depsgraph), world_matrix(obj), frame)
        areas += _instances(context, obj, frame)
        if obj.type in {"FONT", "CURVES"}:  # hair, and texts, whose faces may omit overlaps
            outline = read(context, obj)
            world = (transform(outline.matrix, loop.astype(np.float64)) for loop in outline.loops)
            areas.append(core.exchange.Painted([_seen(frame, loop) for loop in world], obj.type != "FONT"))
    if not areas:
        raise UserError(
            f"'{obj.name}' has no silhouette: it has neither faces nor closed lines nor strokes with a width"
        )
    return areas


def paints(obj: Object) -> bool:
    """Whether an object of this kind can have a silhouette."""
    return obj.type in SOLID or obj.type in READERS or instances_collection(obj)


def instances_collection(obj: Object) -> bool:
    """Whether an object is an empty that shows a collection."""
    return obj.type == "EMPTY" and obj.instance_type == "COLLECTION" and obj.instance_collection is not None


def _seen(frame: Frame, points: FloatArray) -> FloatArray:
    """Points (n, 3) of the world in a frame, (n, 2), as float32 values."""
    return frame.from_world(points)[0].astype(np.float32).astype(np.float64)


def _instances(context: Context, obj: Object, frame: Frame) -> Iterator[core.exchange.Painted]:
    """The areas of what an object instances: a collection, or its children on its vertices or faces."""
    for instance in context.evaluated_depsgraph_get().object_instances if obj.instance_type != "NONE" else ():
        if instance.is_instance and instance.parent is not None and instance.parent.original == obj:
            shown = instance.object
            # Wires, such as cages, are no part of what a collection paints.
            if shown is not None and shown.type in SOLID and shown.display_type not in {"WIRE", "BOUNDS"}:
                yield from _faces(shown, np.array(instance.matrix_world, dtype=np.float64), frame)


def _faces(evaluated: Object, matrix: FloatArray, frame: Frame) -> Iterator[core.exchange.Painted]:
    with evaluated_mesh(evaluated) as mesh:
        if mesh is None:
            return
        mesh.calc_loop_triangles()
        points, lone = points_of(mesh), loop_edges(mesh, 0)
        triangles = stored(mesh.loop_triangles, "vertices", 3, np.int32)
    flat = _seen(frame, transform(matrix, points))
    yield from (core.exchange.Painted([triangle]) for triangle in flat[triangles])
    loops = [flat[loop] for loop in chains(lone, len(points)).closed if len(loop) >= SMALLEST_LOOP]
    if loops:
        yield core.exchange.Painted(loops, evenodd=True)


def _drawn(context: Context, obj: Object, frame: Frame, strokes: bool, closed: bool) -> Iterator[core.exchange.Painted]:
    """Fills and strokes of the visible layers on the current frame. Raises: UserError for Bézier and NURBS strokes."""
    evaluated = obj.evaluated_get(context.evaluated_depsgraph_get())
    for layer, hidden in unseen(evaluated).items():
        matrix = world_matrix(obj) @ np.array(layer.matrix_local)
        scale = abs(float(np.linalg.det(matrix[:3, :3]))) ** (1.0 / 3.0)
        for number, stroke in enumerate(layer.current_frame().drawing.strokes):
            if number in hidden:
                continue
            drawn = np.array([(*point.position, point.radius) for point in stroke.points], np.float64).reshape(-1, 4)
            kind = getattr(stroke, "curve_type", STRAIGHT)
            if kind == SMOOTH:
                drawn = _smooth(drawn, stroke.cyclic)
            elif kind != STRAIGHT:
                raise UserError(
                    f"'{obj.name}' has Bézier or NURBS strokes: convert them to poly curves (Edit Mode, Stroke, Set "
                    "Curve Type)"
                )
            points = _seen(frame, transform(matrix, drawn[:, :3]))
            radii = scale / frame.scale * np.maximum(drawn[:, 3], 0.0)
            style = style_of(evaluated, stroke)
            filled = (style is not None and style.show_fill) or (stroke.cyclic and closed)
            if filled and len(points) >= SMALLEST_LOOP:
                yield core.exchange.Painted([points], evenodd=True)
            lined = strokes and (style is None or style.show_stroke)
            if lined and len(points) and radii.max() > 0.0:
                line = np.append(np.arange(len(points)), 0) if stroke.cyclic else np.arange(len(points))
                yield from (core.exchange.Painted([shape]) for shape in _stroke(points[line], radii[line]))


def _smooth(values: FloatArray, cyclic: bool) -> FloatArray:
    """Values (k, c) along the uniform Catmull-Rom spline through values (n, c), which Blender draws."""
    if len(values) < 2:
        return values
    ends = (values[-1:], values[:2]) if cyclic else (values[:1], values[-1:])
    padded = np.concatenate([ends[0], values, ends[1]])
    before, start, end, after = (padded[i : len(padded) - 3 + i, None] for i in range(4))
    t = np.arange(SEGMENTS)[None, :, None] / SEGMENTS
    slope, bend, twist = end - before, 2 * before - 5 * start + 4 * end - after, 3 * (start - end) + after - before
    smooth = (start + 0.5 * t * (slope + t * (bend + t * twist))).reshape(-1, values.shape[1])
    return smooth if cyclic else np.concatenate([smooth, values[-1:]])


def _stroke(stroke: FloatArray, radii: FloatArray) -> list[FloatArray]:
    """Loops (k, 2) of simple shapes that together cover a stroke (k, 2): a disc around each point, a quad between."""
    angles = 2.0 * np.pi * (np.arange(ROUND) + 0.5) / ROUND
    circle = np.column_stack([np.cos(angles), np.sin(angles)]) / np.cos(np.pi / ROUND)
    around = radii[:, None, None] * circle + stroke[:, None, :]
    shapes: list[FloatArray] = [disc for disc, radius in zip(around, radii, strict=True) if radius > 0.0]
    for (start, end), (narrow, wide) in zip(pairwise(stroke), pairwise(radii), strict=True):
        along = end - start
        length = float(np.hypot(*along))
        if length > abs(wide - narrow):  # else one disc covers the other
            shapes.append(_between(start, end, float(narrow), float(wide), along / length, length))
    return shapes


def _between(
    start: FloatArray, end: FloatArray, first: float, second: float, along: FloatArray, length: float
) -> FloatArray:
    """The quad (4, 2) between the points where the common tangents touch two circles."""
    sine = (first - second) / length
    across, ahead = np.sqrt(1.0 - sine * sine) * np.array([-along[1], along[0]]), sine * along
    left, right = ahead + across, ahead - across
    return np.array([start + first * right, end + second * right, end + second * left, start + first * left])


def painted(
    context: Context, objects: Sequence[Object], frame: Frame, group: str, points: FloatArray
) -> FloatArray | None:
    """(n,) weight of the evaluated vertex closest to each point (n, 2) of a frame; None without such a group."""
    places, values = [], []
    for obj in objects:
        if obj.type == "MESH":
            vertices, weights = _weights(context, obj, group)
            matrix = np.array(obj.matrix_world, dtype=np.float64)
            places.append(frame.from_world(transform(matrix, vertices))[0])
            values.append(weights)
    if not any(weights is not None for weights in values):
        return None
    place = np.concatenate(places)
    weight = np.concatenate([np.zeros(len(p)) if w is None else w for p, w in zip(places, values, strict=True)])
    return weight[broad_phase.nearest(points, place)[1]]


def bone_ends(armature: Object, frame: Frame) -> FloatArray:
    """Both ends (k, 2) of the bones of an armature at rest, each once, in a drawing's frame."""
    ends: list[Any] = [end for bone in armature.data.bones for end in (bone.head_local, bone.tail_local)]
    points = np.array(list(dict.fromkeys(map(tuple, ends))), dtype=np.float64).reshape(-1, 3)
    return frame.from_world(transform(np.array(armature.matrix_world, dtype=np.float64), points))[0]


def _weights(context: Context, obj: Object, group: str) -> tuple[FloatArray, FloatArray | None]:
    """Evaluated vertices (n, 3) in the object's own space and their weights (n,), None without the group."""
    if obj.mode == "EDIT":
        obj.update_from_editmode()
    named = obj.vertex_groups.get(group)
    with evaluated_mesh(obj.evaluated_get(context.evaluated_depsgraph_get())) as mesh:
        assert mesh is not None
        weights = np.nan_to_num(weights_of(mesh, named.index + 1)[-1]) if named is not None else None
        return points_of(mesh), weights
