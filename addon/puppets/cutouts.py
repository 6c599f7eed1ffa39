"""Cutouts as puppets of game engines: pictures that follow cages, whose vertices bones move."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import bpy
import numpy as np
from bpy.types import Context, Object
from numpy.typing import NDArray

from ..blender import mesh_data
from ..cage_sets import CageSet
from ..core import blamed, core
from ..drawing.plane import space_to_space, transform
from ..errors import FloatArray, UserError
from ..files.pictures import image_on, size_of
from . import armatures, exported

# Part of the weights of a point that engines may leave out, as they take four bones, before it is told.
LEFT_OUT = 0.05


def rig_of(objects: Sequence[Object]) -> Object | None:
    """The armature that moves the cages around the first of some pictures, or that is one of these objects."""
    for obj in objects:
        if obj.type == "ARMATURE" and moved_by(obj):
            return obj
        cage_set = next(iter(CageSet.all_of(obj)), None)
        rig = _rig_of(cage_set) if cage_set is not None else None
        if rig is not None and moved_by(rig):
            return rig
    return None


def moved_by(rig: Object) -> list[tuple[Object, CageSet]]:
    """The pictures that an armature moves by their cages, with these, from the back to the front."""
    sets = [each for each in CageSet.all_of(rig) if each.bound and _rig_of(each) == rig]
    found = [(obj, each) for each in sets for obj in each.originals if obj.type == "MESH" and image_on(obj) is not None]
    return sorted(found, key=lambda pair: (space_to_space(rig, pair[0])[2, 3], pair[0].name))


def _rig_of(cage_set: CageSet) -> Object | None:
    modifiers = cage_set.members[-1].modifiers if cage_set.members else ()
    return next((each.object for each in modifiers if isinstance(each, bpy.types.ArmatureModifier)), None)


def write(context: Context, rig: Object, path: Path, engine: str) -> tuple[list[Path], tuple[str, ...]]:
    """Writes the pictures that an armature moves for an engine of the core; returns the files and what is to be told.
    Raises: UserError.
    """
    return exported.put(path, engine, *cutouts_in_scene(context, rig))


def cutouts_in_scene(context: Context, rig: Object) -> tuple[core.puppets.GamePuppet, tuple[str, ...]]:
    """The puppet of the pictures that an armature moves, at rest, with its actions, and notes. Raises: UserError."""
    pictures = moved_by(rig)
    places = [_points_in(rig, obj) for obj, _ in pictures]
    unit = _unit_of(pictures[0][0], places[0])
    corners = [_corner_of(obj, points / unit) for (obj, _), points in zip(pictures, places, strict=True)]
    low = np.min(corners, axis=0)
    high = np.max([at + _pixels_of(obj) for at, (obj, _) in zip(corners, pictures, strict=True)], axis=0)
    place = core.puppets.Placement(*np.ceil(high - low).astype(int).tolist())
    shift = np.array((low[0] + 0.5 * place.width, low[1]))
    bones = armatures.bones_at_rest(rig.data.bones, unit)
    number, meshes, notes = {bone.name: k for k, bone in enumerate(bones)}, list[core.puppets.PartMesh](), list[str]()
    for (obj, cage_set), points in zip(pictures, places, strict=True):
        weights = _weights(obj, cage_set, number)
        left_out = 1.0 - np.sort(weights, axis=1)[:, -core.puppets.MOST_BONES :].sum(axis=1).min()
        if left_out > LEFT_OUT:
            notes.append(f"'{obj.name}': engines take four bones for a point, which leaves out up to {left_out:.0%}")
        meshes.append(exported.part_mesh(obj, points / unit - shift, weights, place))
    with blamed(f"'{rig.name}'"):
        there = tuple(replace(bone, head=_moved(bone.head, shift), tail=_moved(bone.tail, shift)) for bone in bones)
        animations = exported.baked(context, rig, bones, unit)
        ranges = core.puppets.proved_ranges(there, meshes)
    name = bpy.path.clean_name(pictures[0][0].name)
    return core.puppets.GamePuppet(name, place, there, tuple(meshes), ranges, animations), tuple(notes)


def _moved(end: tuple[float, float], shift: FloatArray) -> tuple[float, float]:
    return end[0] - float(shift[0]), end[1] - float(shift[1])


def _points_in(space: Object, obj: Object) -> FloatArray:
    """The vertices (n, 2) of a mesh in the plane of another object."""
    return transform(space_to_space(space, obj), mesh_data.points_of(mesh_data.mesh_of(obj)))[:, :2]


def _pixels_of(obj: Object) -> FloatArray:
    """Width and height of a picture in pixels."""
    image = image_on(obj)
    assert image is not None
    return np.array(size_of(image), dtype=np.float64)


def _shown(obj: Object) -> tuple[FloatArray, NDArray[np.int32]]:
    """Places (n, 2) of the corners of the faces of a picture in pixels, y pointing up, and their vertices (n,)."""
    places = exported.texture_places(obj) * _pixels_of(obj)
    return places, mesh_data.corner_vertices(mesh_data.mesh_of(obj))


def _unit_of(obj: Object, points: FloatArray) -> float:
    """The length of a pixel of a picture with vertices at points (n, 2)."""
    shown, used = _shown(obj)
    return float(np.ptp(points[used], axis=0).max() / np.ptp(shown, axis=0).max())


def _corner_of(obj: Object, points: FloatArray) -> FloatArray:
    """The lower left corner (2,) of a picture with vertices at points (n, 2), in pixels. Raises: UserError."""
    shown, used = _shown(obj)
    corners = points[used] - shown
    if np.ptp(corners, axis=0).max() > exported.OFF_PLACE:
        raise UserError(
            f"'{obj.name}' is turned, or of another size than other pictures: engines show them as files are"
        )
    return np.asarray(corners.mean(axis=0))


def _weights(obj: Object, cage_set: CageSet, number: dict[str, int]) -> FloatArray:
    """(n, B) how much each bone moves the vertices of a picture: through its cages, from the finest to the coarsest."""
    with blamed(f"'{obj.name}'"):
        weights = np.eye(len(mesh_data.points_of(mesh_data.mesh_of(obj))))
        for finer, coarser in pairwise((obj, *cage_set.cages)):
            weights = weights @ core.cage_coordinates(_points_in(coarser, finer), mesh_data.shape_of(coarser))
    weights = np.maximum(weights @ exported.group_weights(cage_set.cages[-1], number), 0.0)
    total = weights.sum(axis=1, keepdims=True)
    if not (total > 0.0).all():
        raise UserError(f"'{cage_set.cages[-1].name}' has vertices without weights of bones: paint some")
    return np.asarray(weights / total)
