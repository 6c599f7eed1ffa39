"""The painted area of an evaluated object: faces, strokes with their width, and the inside of closed lines; and what is
painted on its vertices.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from bpy.types import Context, Object

from ..blender.mesh_data import evaluated_mesh, points_of, weights_of
from ..core import broad_phase, core
from ..errors import FloatArray, UserError
from . import grease_pencil
from .evaluated import has_nodes, realized, temporary
from .faces import seen, shown_in
from .planar import read, readable
from .plane import Frame, transform, world_matrix

# Types of objects that have faces.
SOLID = {"MESH", "CURVE", "FONT", "SURFACE", "META"}


def areas_of(context: Context, obj: Object, frame: Frame, *, closed: bool = False) -> list[core.formats.Painted]:
    """All that an object paints, its instances included, as float32 shapes in a frame. Raises: UserError if nothing.

    closed: closed strokes of Grease Pencil are areas too, even if not filled.
    """
    if obj.type in grease_pencil.KINDS:
        areas = grease_pencil.Painting.of(context, obj).areas(frame, grease_pencil.Counts(closed=closed))
    else:
        areas, depsgraph = list[core.formats.Painted](), context.evaluated_depsgraph_get()
        if obj.type in SOLID:  # faces, those of instances included, and the inside of closed lines
            areas += shown_in(obj.evaluated_get(depsgraph), world_matrix(obj), frame).areas()
            if has_nodes(obj):
                with temporary() as blocks:
                    shape = realized(context, obj, blocks)
                    depsgraph = context.evaluated_depsgraph_get()
                    areas += shown_in(shape.evaluated_get(depsgraph), world_matrix(obj), frame).areas()
        areas += _instances(context, obj, frame)
        if obj.type in {"FONT", "CURVES"}:  # hair, and texts, whose faces may omit overlaps
            outline = read(context, obj)
            world = (transform(outline.matrix, loop.astype(np.float64)) for loop in outline.loops)
            areas.append(core.formats.Painted([seen(frame, loop) for loop in world], obj.type != "FONT"))
    if not areas:
        raise UserError(
            f"'{obj.name}' has no silhouette: it has neither faces nor closed lines nor strokes with a width"
        )
    return areas


def paints(obj: Object) -> bool:
    """Whether an object of this kind can have a silhouette."""
    return obj.type in SOLID or readable(obj) or instances_collection(obj)


def instances_collection(obj: Object) -> bool:
    """Whether an object is an empty that shows a collection."""
    return obj.type == "EMPTY" and obj.instance_type == "COLLECTION" and obj.instance_collection is not None


def _instances(context: Context, obj: Object, frame: Frame) -> Iterator[core.formats.Painted]:
    """The areas of what an object instances: a collection, or its children on its vertices or faces."""
    for instance in context.evaluated_depsgraph_get().object_instances if obj.instance_type != "NONE" else ():
        if instance.is_instance and instance.parent is not None and instance.parent.original == obj:
            shown = instance.object
            # Wires, such as cages, are no part of what a collection paints.
            if shown is not None and shown.type in SOLID and shown.display_type not in {"WIRE", "BOUNDS"}:
                matrix = np.array(instance.matrix_world, dtype=np.float64)
                yield from shown_in(shown, matrix, frame).areas()


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
