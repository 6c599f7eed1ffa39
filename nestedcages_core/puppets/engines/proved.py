"""Ranges of joints proved on meshes as they are: also where weights were painted by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...geometry.arrays import IntArray
from ...geometry.mesh import Mesh
from ...geometry.triangulation import Triangulation
from ..field.mesh import BendField
from ..field.ranges import FREE, UNPROVED, JointRange, ranges_of
from ..field.weights import Bend
from ..skeleton.bone import Bone
from ..skeleton.bone_tree import BoneTree
from .bending import SKIN
from .textured_mesh import PartMesh


def proved_ranges(bones: Sequence[Bone], meshes: Sequence[PartMesh]) -> tuple[JointRange, ...]:
    """The range of each bone in which no triangle of any mesh flips, whatever the others do; bones turn at their heads.

    Proved where the bones of a mesh are a chain and each point follows at most two neighbours in it; else nothing is
    proved of the bones of that mesh.
    """
    ranges = [FREE] * len(bones)
    for mesh in meshes:
        used = np.flatnonzero(mesh.weights.any(axis=0))
        if len(used) < 2:
            continue
        field = _field_of(mesh, bones, used)
        if field is None:
            found = dict.fromkeys(used.tolist(), UNPROVED)
        else:
            found = dict(zip(used[1:].tolist(), ranges_of(field, SKIN), strict=True))
        for bone, proved_range in found.items():
            ranges[bone] = narrower(ranges[bone], proved_range)
    return tuple(ranges)


def narrower(one: JointRange, other: JointRange) -> JointRange:
    """The angles in two ranges."""
    return replace(
        one,
        low=max(one.low, other.low),
        high=min(one.high, other.high),
        simple_low=max(one.simple_low, other.simple_low),
        simple_high=min(one.simple_high, other.simple_high),
    )


def _field_of(mesh: PartMesh, bones: Sequence[Bone], used: IntArray) -> BendField | None:
    """The mesh as a field of the joints between its bones; None if these are no tree without gaps."""
    place = {bone: k for k, bone in enumerate(used.tolist())}
    above = [bones[bone].parent for bone in place]
    parents = tuple(-1 if bone is None else place.get(bone, -1) for bone in above)
    if parents.count(-1) > 1:
        return None
    ring = np.arange(mesh.hull)
    hull = Mesh.from_loops([mesh.points[: mesh.hull]])
    grid = Triangulation(mesh.points, mesh.triangles, ring, np.roll(ring, -1), np.zeros(mesh.hull))
    joints = [np.array(bones[bone].head) for bone in used[1:]]
    bends = tuple(Bend(joint, 0.0, 0.0, np.stack((joint, joint))) for joint in joints)
    shares = BoneTree.of(parents).shares(mesh.weights[:, used])
    return BendField(hull, grid, int(used[0]), parents, bends, shares)
