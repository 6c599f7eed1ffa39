"""Bones as segments, and the places near their joints where a cage needs vertices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import NestedCagesError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.signed_distance import SignedDistance

JOINT_REACH = 2.0
"""Distance of the places before and after a joint, in radii of the limb: two vertices on each side of an elbow. Of 1.5,
2 and 2.5, on twelve random figures, the one with which the fewest bent cages cross themselves."""

TOUCHING = 1e-3
"""Distance below which two ends of bones are one joint, as a fraction of the longer bone."""


@dataclass(frozen=True)
class Bone:
    """A segment from head to tail that turns around its head."""

    head: tuple[float, float]
    tail: tuple[float, float]
    parent: int | None = None
    """Number of the bone that carries this one, always smaller than its own; None for a root."""
    name: str = ""

    @property
    def length(self) -> float:
        """Distance from head to tail."""
        return float(np.hypot(self.tail[0] - self.head[0], self.tail[1] - self.head[1]))


def ends_of(bones: Sequence[Bone]) -> FloatArray:
    """(B, 2, 2) heads and tails. Raises NestedCagesError if there are none, or one is not finite or has no length."""
    if not bones:
        raise NestedCagesError("There are no bones; give at least one.", code="setting.invalid")
    ends = np.array([(bone.head, bone.tail) for bone in bones], dtype=np.float64)
    for number, bone in enumerate(bones):
        name = bone.name or number
        if not np.isfinite(ends[number]).all() or not bone.length > 0.0:
            raise NestedCagesError(
                f"Bone {name} has no length: its head and its tail are {bone.head} and {bone.tail}.",
                code="setting.invalid",
            )
        if bone.parent is not None and not 0 <= bone.parent < number:
            raise NestedCagesError(
                f"Bone {name} must come after its parent, which has the number {bone.parent}.", code="setting.invalid"
            )
    return ends


def radii_of(shape: Mesh, points: FloatArray) -> FloatArray:
    """(P,) distance from points (P, 2) inside a shape to its outline; 0 outside."""
    return np.maximum(-SignedDistance.of(shape).at(points).distance, 0.0)


def joints_of(shape: Mesh, bones: Sequence[Bone]) -> list[tuple[float, float]]:
    """Places along the bones, before and after each joint, where a cage of the shape needs vertices on both sides.

    Their distance from the joint is twice the radius of the limb there, and at most half of the bone. Ends of bones
    that meet no other bone, such as fingertips, need none. Raises NestedCagesError as `bone_weights`.
    """
    ends = ends_of(bones)
    flat = ends.reshape(-1, 2)
    lengths = np.repeat([bone.length for bone in bones], 2)
    apart = np.hypot(*(flat[:, None] - flat[None]).transpose(2, 0, 1))
    near = apart <= TOUCHING * np.maximum(lengths[:, None], lengths[None])
    bone_of = np.repeat(np.arange(len(bones)), 2)
    shared = (near & (bone_of[:, None] != bone_of[None])).any(axis=1)
    inwards = (ends[:, ::-1] - ends).reshape(-1, 2) / lengths[:, None]
    reach = np.minimum(JOINT_REACH * radii_of(shape, flat), 0.5 * lengths)
    used = shared & (reach > 0.0)
    return [(float(x), float(y)) for x, y in flat[used] + reach[used, None] * inwards[used]]
