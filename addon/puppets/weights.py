"""Weights of meshes that the bones of a puppet bend: as solved, and what was painted by hand since, by place."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from bpy.types import Object

from .. import cage_sets, keys
from ..bind import field
from ..blender import mesh_data
from ..core import broad_phase, core
from ..drawing.plane import Frame, transform, world_matrix
from ..errors import FloatArray
from ..verify.check import Folding
from . import armatures
from .armatures import part_of

# Weights that differ by less than this were not painted by hand: they are stored in single precision.
ROUNDING = 1e-5


def note_solved(obj: Object, solved: FloatArray) -> None:
    """Notes weights (N, B) of a mesh that were solved, to know later what was painted by hand."""
    for number, column in enumerate(solved.T):
        mesh_data.add_attribute(mesh_data.mesh_of(obj), f"{keys.SOLVED}{number}", "FLOAT", column.astype(np.float32))


def note_digest(obj: Object) -> None:
    """Notes the weights of a picture, to know later whether they were painted by hand."""
    obj[keys.SOLVED] = _digest(obj)


def were_painted(obj: Object) -> bool:
    """Whether the weights of a picture are others than were solved."""
    return str(obj.get(keys.SOLVED, "")) != _digest(obj)


def _digest(obj: Object) -> str:
    found = np.nan_to_num(mesh_data.weights_of(mesh_data.mesh_of(obj), len(obj.vertex_groups)))
    used = found[found.any(axis=1)]
    return f"{zlib.crc32(np.round(used / ROUNDING).astype(np.int64).tobytes()):08x}"


def carriers_of(armature: Object) -> dict[str, Object]:
    """The hidden mesh that bends each part that bends, by name of the part."""
    hidden = [each for each in armature.children if part_of(each) and not cage_sets.is_helper(each, cage_sets.FIELD)]
    return {part_of(each): each for each in hidden}


def left_over(drawings: Sequence[Object]) -> dict[str, Object]:
    """The hidden meshes that drawings follow since an armature that was deleted."""
    hidden = [each for each in map(field.followed, drawings) if each is not None and each.parent is None]
    return {part_of(each): each for each in hidden if part_of(each)}


def foldings_of(armature: Object) -> list[Folding]:
    """What can fold in a puppet: the hidden meshes that bones bend, and paintings with weights of their own."""
    drawings = armatures.drawings_of(armature)
    shown = {field.followed(obj): obj for obj in reversed(drawings)}
    meshes = [*carriers_of(armature).values(), *(obj for obj in drawings if armatures.is_skinned(obj))]
    return [Folding.of_skin(mesh, shown.get(mesh, mesh)) for mesh in meshes]


def by_hand(armature: Object, puppet: core.puppets.Puppet, frame: Frame) -> core.puppets.Puppet:
    """A puppet with what was painted by hand on the hidden meshes of its armature, and what is proved of that."""
    names = {part: [bone.name for bone in chain] for part, chain in armatures.chains_of(armature.data.bones).items()}
    number = {part.name: k for k, part in enumerate(puppet.draft.parts)}
    for part, carrier in carriers_of(armature).items():
        bent = puppet.fields[number[part]] if part in number else None
        if bent is None or len(bent.bends) + 1 != len(names[part]):
            continue
        found = _difference(carrier, names[part])
        if found is not None:
            places = frame.from_world(
                transform(world_matrix(carrier), mesh_data.points_of(mesh_data.mesh_of(carrier)))
            )[0]
            nearest = broad_phase.nearest(bent.grid.vertices, places)[1]
            weights = np.clip(bent.weights + found[nearest], 0.0, 1.0)
            puppet = core.puppets.reweighted(puppet, number[part], weights / weights.sum(axis=1, keepdims=True))
    return puppet


def _difference(obj: Object, names: Sequence[str]) -> FloatArray | None:
    """(N, B) how the weights of bones differ from those that were solved; None if they don't."""
    mesh = mesh_data.mesh_of(obj)
    known: Any = mesh.attributes
    groups = [obj.vertex_groups[name].index for name in names if name in obj.vertex_groups]
    solved = [each for k in range(len(names)) if (each := known.get(f"{keys.SOLVED}{k}")) is not None]
    if not len(groups) == len(solved) == len(names):
        return None
    now = np.nan_to_num(mesh_data.weights_of(mesh, len(obj.vertex_groups)))[groups].T
    sums = now.sum(axis=1, keepdims=True)
    before = np.concatenate([mesh_data.stored(each.data, "value", 1) for each in solved], axis=1).astype(np.float64)
    found = np.where(sums > 0.0, now / np.maximum(sums, ROUNDING), before) - before
    return found if np.abs(found).max() > ROUNDING else None
