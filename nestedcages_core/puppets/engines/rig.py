"""Bones in their parents, names that engines take, and numbers as text."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...geometry.arrays import FloatArray
from ..naming import Names
from ..skeleton.bone import Bone, ends_of

DECIMALS = 6
"""Of numbers in files: a millionth of a pixel."""


class LocalBone(NamedTuple):
    """A bone in the frame of its parent, whose x axis lies along it: y pointing up, angles counter-clockwise."""

    x: float
    y: float
    degrees: float
    length: float


class Frames(NamedTuple):
    """Bones at rest: heads, and directions in radians."""

    heads: FloatArray
    """(B, 2)."""
    angles: FloatArray
    """(B,)."""

    @classmethod
    def of(cls, bones: Sequence[Bone]) -> Frames:
        ends = ends_of(bones)
        along = ends[:, 1] - ends[:, 0]
        return cls(ends[:, 0], np.arctan2(along[:, 1], along[:, 0]))

    def inside(self, bone: int, points: FloatArray) -> FloatArray:
        """Points (n, 2) in the frame of a bone."""
        return turned_by(points - self.heads[bone], -float(self.angles[bone]))


def local_bones(bones: Sequence[Bone]) -> list[LocalBone]:
    """Bones in their parents; roots in the frame of the drawing."""
    frames = Frames.of(bones)
    found = []
    for k, bone in enumerate(bones):
        x, y = frames.heads[k] if bone.parent is None else frames.inside(bone.parent, frames.heads[k : k + 1])[0]
        above = 0.0 if bone.parent is None else float(frames.angles[bone.parent])
        turn = float(np.rad2deg(frames.angles[k] - above) + 180.0) % 360.0 - 180.0
        found.append(LocalBone(float(x), float(y), turn, bone.length))
    return found


def in_parent(bones: Sequence[Bone], bone: int, vectors: FloatArray) -> FloatArray:
    """Vectors (n, 2) of the drawing at rest along the axes of a bone's parent."""
    parent = bones[bone].parent
    return vectors if parent is None else turned_by(vectors, -float(Frames.of(bones).angles[parent]))


def turned_by(points: FloatArray, angle: float) -> FloatArray:
    """Points (n, 2) turned around 0 by radians."""
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


def unique_names(names: Iterable[str], forbidden: str, taken: Iterable[str] = ()) -> list[str]:
    """The names with _ for characters that are forbidden, and numbers after those that repeat."""
    given = Names(taken, "_")
    clean = ("".join("_" if sign in forbidden or not sign.isprintable() else sign for sign in name) for name in names)
    return [given.new(name.strip() or "part") for name in clean]


def few_decimals(values: ArrayLike) -> list[float]:
    """Numbers in a row with few decimals, without negative zeros."""
    flat = np.round(np.ravel(values), DECIMALS) + 0.0
    return [int(value) if value == int(value) else value for value in flat.tolist()]
