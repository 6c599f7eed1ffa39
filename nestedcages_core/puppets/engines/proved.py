"""Ranges of joints proved on meshes as they are: also where weights were painted by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.mesh import Mesh
from ...geometry.triangulation import Triangulation
from ..field.mesh import BendField
from ..field.ranges import FREE, UNPROVED, JointRange, ranges_of
from ..field.weights import Bend
from ..skeleton.bone import Bone
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
        chain = _in_a_chain(bones, used)
        if chain is None:
            found = dict.fromkeys(used.tolist(), UNPROVED)
        else:
            proved = ranges_of(_field_of(mesh, bones, chain), SKIN) if _is_even(mesh, chain) else None
            found = dict(zip(chain[1:], proved or [UNPROVED] * (len(chain) - 1), strict=True))
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


def _in_a_chain(bones: Sequence[Bone], used: IntArray) -> list[int] | None:
    """The bones in the order in which they hang on each other; None if they are no chain, without gaps."""
    inside = set(used.tolist())
    tips = inside - {bones[bone].parent for bone in inside}
    if len(tips) != 1:
        return None
    chain = [tips.pop()]
    while (parent := bones[chain[-1]].parent) in inside and parent is not None:
        chain.append(parent)
    return chain[::-1] if len(chain) == len(inside) else None


def _is_even(mesh: PartMesh, chain: Sequence[int]) -> bool:
    """Whether each point follows one bone, or two that are next to each other in the chain."""
    on = mesh.weights[:, chain] > 0.0
    count = on.sum(axis=1)
    together = (on[:, :-1] & on[:, 1:]).any(axis=1)
    return bool(((count == 1) | ((count == 2) & together)).all())


def _field_of(mesh: PartMesh, bones: Sequence[Bone], chain: Sequence[int]) -> BendField:
    """The mesh as a field of the joints between its bones."""
    ring = np.arange(mesh.hull)
    hull = Mesh.from_loops([mesh.points[: mesh.hull]])
    grid = Triangulation(mesh.points, mesh.triangles, ring, np.roll(ring, -1), np.zeros(mesh.hull))
    weights: FloatArray = mesh.weights[:, chain]
    shares = np.cumsum(weights[:, :0:-1], axis=1)[:, ::-1]
    joints = [np.array(bones[bone].head) for bone in chain[1:]]
    bends = tuple(Bend(joint, 0.0, 0.0, np.stack((joint, joint))) for joint in joints)
    return BendField(hull, grid, chain[0], bends, shares)
