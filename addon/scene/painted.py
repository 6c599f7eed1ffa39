"""Where it matters in a drawing: vertex groups of its objects, and bones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .filling import evaluated_mesh, points_of, weights_of
from .plane import Frame, nearest, transform


def painted(
    context: bpy.types.Context,
    objects: Sequence[bpy.types.Object],
    frame: Frame,
    group: str,
    points: NDArray[np.float64],
) -> NDArray[np.float64] | None:
    """(n,) weight of the evaluated vertex closest to each point (n, 2) of a frame; None without such a group."""
    places, values = [], []
    for obj in objects:
        if obj.type == "MESH":
            found, weights = _weights(context, obj, group)
            matrix = np.array(obj.matrix_world, dtype=np.float64)
            places.append(frame.from_world(transform(matrix, found))[0])
            values.append(weights)
    if not any(weights is not None for weights in values):
        return None
    place = np.concatenate(places)
    weight = np.concatenate([np.zeros(len(p)) if w is None else w for p, w in zip(places, values, strict=True)])
    chosen: NDArray[np.float64] = weight[nearest(points, place)]
    return chosen


def bone_ends(armature: bpy.types.Object, frame: Frame) -> NDArray[np.float64]:
    """Both ends (k, 2) of the bones of an armature at rest, each once, in a drawing's frame."""
    ends: list[Any] = [end for bone in armature.data.bones for end in (bone.head_local, bone.tail_local)]
    points = np.array(list(dict.fromkeys(map(tuple, ends))), dtype=np.float64).reshape(-1, 3)
    found: NDArray[np.float64] = frame.from_world(transform(np.array(armature.matrix_world, dtype=np.float64), points))[
        0
    ]
    return found


def _weights(
    context: bpy.types.Context, obj: bpy.types.Object, group: str
) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Evaluated vertices (n, 3) in the object's own space and their weights (n,), None without the group."""
    if obj.mode == "EDIT":
        obj.update_from_editmode()
    named = obj.vertex_groups.get(group)
    with evaluated_mesh(obj.evaluated_get(context.evaluated_depsgraph_get())) as mesh:
        assert mesh is not None
        weights = np.nan_to_num(weights_of(mesh, named.index + 1)[-1]) if named is not None else None
        return points_of(mesh), weights
