"""Circular weights: around a joint, a point at a part of the way from the bone before it to the bone after it follows
that part of the joint's turn.

Points keep to circles around the joint, so only the slope of the turn along a circle can fold, and it is least where
the turn is even: a straight limb then bends until 180°, if weights are even there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.mesh import Mesh
from ...geometry.vectors import norm
from ...libraries import load_shapely
from ..part import NEEDED_FOR
from ..skeleton.bone_tree import BoneTree

MEETING = 0.5
"""Two blends along a bone share it at its middle."""

LEAST_REACH = 1.1
"""Least reach of a blend, in widths: where bones are too short it still goes beyond the limb."""

MOST_REACH = 3.0
"""Beyond this, in widths, a longer blend no longer widens the range."""


@dataclass(frozen=True, eq=False)
class Bend:
    """A joint within a part."""

    joint: FloatArray
    """(2,)."""
    width: float
    """Distance from the joint to the farther end of the shortest chord through it that separates its two bones."""
    reach: float
    """Radius of the disc in which weights blend."""
    chord: FloatArray
    """(2, 2) ends of that chord."""


@dataclass(frozen=True, eq=False)
class Limb:
    """What bends a part, and all that rides on it."""

    area: Mesh
    """What has all joints."""
    bones: BoneTree
    bends: tuple[Bend, ...]

    @classmethod
    def of(cls, area: Mesh, bones: BoneTree, kept: float) -> Limb:
        """A limb in an area; kept: radius around the head of its first bone that stays rigid."""
        return cls(area, bones, tuple(_bends_of(area, bones, kept)))


def _bends_of(cage: Mesh, bones: BoneTree, kept: float) -> list[Bend]:
    """The joints within a part, of its bones but the first."""
    shapely = load_shapely(NEEDED_FOR)
    solid = shapely.geometry.shape(cage.__geo_interface__)
    found = []
    for k in range(1, len(bones)):
        joint, behind, ahead = bones.heads[k], bones.before(k), bones.tails[k]
        across = _chord_direction(behind, joint, ahead)
        line = shapely.linestrings([joint - cage.diagonal * across, joint + cage.diagonal * across])
        chords = shapely.get_parts(shapely.intersection(line, solid))
        chord = min(chords, key=lambda piece: float(shapely.distance(piece, shapely.points(joint))))
        ends = shapely.get_coordinates(chord)[[0, -1]]
        width = float(norm(ends - joint).max())
        before, after = float(norm(behind - joint)), float(norm(ahead - joint))
        is_first = bones.parents[k] == 0 and bones.parents.count(0) == 1
        room = min(
            before - min(kept, (1.0 - MEETING) * before) if is_first else MEETING * before,
            after if bones.is_last(k) else MEETING * after,
        )
        found.append(Bend(joint, width, float(np.clip(room, LEAST_REACH * width, MOST_REACH * width)), ends))
    return found


def _chord_direction(behind: FloatArray, joint: FloatArray, ahead: FloatArray) -> FloatArray:
    """(2,) direction of the chord through a joint: along the bisector of its bones."""
    before, after = behind - joint, ahead - joint
    along = after / norm(after) - before / norm(before)
    return np.array([-along[1], along[0]]) / norm(along)


def shares_of(points: FloatArray, limb: Limb) -> FloatArray:
    """(N, B - 1) how much points (N, 2) follow each bone but the first, with all beyond it."""
    bones, bends = limb.bones, limb.bends
    piece = _pieces(points, limb)
    shares = bones.beyond[piece][:, 1:].astype(np.float64)
    reaches = np.array([bend.reach for bend in bends])
    joints = np.array([bend.joint for bend in bends])
    nearest = (norm(points[:, None] - joints[None]) / reaches).argmin(axis=1)
    for k, bend in enumerate(bends):
        own, parent = k + 1, bones.parents[k + 1]
        blended = (norm(points - bend.joint) < bend.reach) & np.isin(piece, (parent, own)) & (nearest == k)
        shares[blended, k] = _share(points[blended], piece[blended] == own, bend, bones.before(own), bones.tails[own])
    return shares


def _share(points: FloatArray, is_after: FloatArray, bend: Bend, before: FloatArray, after: FloatArray) -> FloatArray:
    """(P,) the part of the way around the joint, fading beyond the limb's width to that of the point's own bone."""
    here = (points - bend.joint) @ (1.0, 1j)
    first, second = complex(*(before - bend.joint)), complex(*(after - bend.joint))
    angle, whole = np.angle(here / first) % (2.0 * np.pi), np.angle(second / first) % (2.0 * np.pi)
    turn = np.where(angle <= whole, angle / whole, (2.0 * np.pi - angle) / (2.0 * np.pi - whole))
    away = np.abs(here)
    turn = np.where(away == 0.0, 0.5, turn)
    place = np.clip((away - bend.width) / (bend.reach - bend.width), 0.0, 1.0)
    near = 1.0 - place * place * (3.0 - 2.0 * place)
    faded = np.where(is_after, np.maximum(1.0 - near * (1.0 - turn), 0.5), np.minimum(near * turn, 0.5))
    return np.asarray(np.where(away <= bend.width, turn, faded))


def _pieces(points: FloatArray, limb: Limb) -> IntArray:
    """(P,) the bone in whose piece of the area each point lies; chords through the joints cut it."""
    shapely = load_shapely(NEEDED_FOR)
    solid = shapely.geometry.shape(limb.area.__geo_interface__)
    cuts = [shapely.linestrings(bend.joint + (1.0 + 1e-6) * (bend.chord - bend.joint)) for bend in limb.bends]
    lines = shapely.union_all([shapely.boundary(solid), *cuts])
    faces = [
        face for face in shapely.get_parts(shapely.polygonize([lines])) if solid.contains(face.representative_point())
    ]
    middles = shapely.points(0.5 * (limb.bones.heads + limb.bones.tails))
    bone_of = np.array([int(shapely.distance(face, middles).argmin()) for face in faces])
    tree = shapely.STRtree(faces)
    return np.asarray(bone_of[tree.nearest(shapely.points(points))])
