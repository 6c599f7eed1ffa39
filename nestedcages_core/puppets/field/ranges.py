"""Ranges of joints: the angles at which no triangle of a field flips, whatever the other joints do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.distance import point_edge
from ...geometry.vectors import norm
from .interval_proof import POSED_ROUNDING, OneJoint, TwoJoints, apart, safe_part, unfolded
from .mesh import BendField
from .skinning import Skin

MOST_TURN = 170.0
"""Largest angle that is tried, in degrees; blends of dual quaternions change sides at 180."""

STEPS_PER_DEGREE = 100.0
"""Ranges are rounded towards rest, to a hundredth of a degree."""


@dataclass(frozen=True)
class JointRange:
    """Angles of a joint in degrees, counter-clockwise, relative to the drawing at rest."""

    low: float = -180.0
    high: float = 180.0
    """Between these no triangle flips, whatever the other joints do within their own ranges."""
    simple_low: float = -180.0
    simple_high: float = 180.0
    """Between these the part's cage does not touch itself either, while the part's other joints are at rest."""

    def holds(self, angle: float) -> bool:
        """Whether an angle is within the range without folds."""
        return self.low <= angle <= self.high


FREE = JointRange()
"""Range of a joint that bends nothing."""

UNPROVED = JointRange(0.0, 0.0, 0.0, 0.0)
"""Range of a joint of which nothing is proved."""


def ranges_of(field: BendField, skin: Skin) -> list[JointRange]:
    """The range of each joint within a part."""
    count = len(field.bends)
    place = np.asarray(field.grid.vertices @ (1.0, 1j))
    corner = field.grid.triangles
    shares = field.shares[corner]  # (T, 3, K)
    moved_by = np.ptp(shares, axis=1) > 0.0
    rounding = POSED_ROUNDING * float(np.abs(field.grid.vertices).max())
    ends = np.full((count, 2), MOST_TURN) * (-1.0, 1.0)
    for k, bend in enumerate(field.bends):
        own = moved_by[:, k] & (moved_by.sum(axis=1) == 1)
        triples = OneJoint(place[corner[own]] - complex(*bend.joint), shares[own][:, :, k], skin, rounding)
        for side in (0, 1):
            ends[k, side] *= safe_part(unfolded(triples), int(own.sum()), np.deg2rad(ends[k, side : side + 1]))
    for k in range(count - 1):
        both = moved_by[:, k] & moved_by[:, k + 1] & (moved_by.sum(axis=1) == 2)
        pair = _between(field, corner[both], k, skin, rounding)
        for sides in ((0, 0), (0, 1), (1, 0), (1, 1)):
            extent = np.deg2rad(ends[[k, k + 1], sides])
            ends[[k, k + 1], sides] *= safe_part(unfolded(pair), int(both.sum()), extent)
    crowded = moved_by[moved_by.sum(axis=1) > 2].any(axis=0)
    ends[crowded] = 0.0
    ends = np.trunc(ends * STEPS_PER_DEGREE) / STEPS_PER_DEGREE
    simple = [_simple(field, k, ends[k], skin, rounding) for k in range(count)]
    return [JointRange(float(low), float(high), *narrow) for (low, high), narrow in zip(ends, simple, strict=True)]


def _between(field: BendField, corner: IntArray, k: int, skin: Skin, rounding: float) -> TwoJoints:
    """Triangles (T, 3) that joints k and k + 1 move."""
    place = np.asarray(field.grid.vertices @ (1.0, 1j))[corner]
    first, second = (np.asarray(field.bends[j].joint @ (1.0, 1j)) for j in (k, k + 1))
    of_second = field.shares[corner, k] == 1.0
    joint = np.where(of_second, second, first)
    weight = np.where(of_second, field.shares[corner, k + 1], field.shares[corner, k])
    return TwoJoints(place - joint, joint, weight, of_second, skin, rounding)


def _simple(field: BendField, k: int, ends: FloatArray, skin: Skin, rounding: float) -> tuple[float, float]:
    """The part of a range in which the outline of a field does not touch itself, with the other joints at rest."""
    rim = field.rim
    point, edge = _may_touch(field, k, float(np.abs(ends).max()), skin, rounding)
    triple = np.stack((rim[point, 0], rim[edge, 0], rim[edge, 1]), axis=1)
    share = field.shares[triple, k]
    kept = (triple[:, 0] != triple[:, 1]) & (triple[:, 0] != triple[:, 2]) & (np.ptp(share, axis=1) > 0.0)
    place = np.asarray(field.grid.vertices @ (1.0, 1j)) - complex(*field.bends[k].joint)
    triples = OneJoint(place[triple[kept]], share[kept], skin, rounding)
    parts = [safe_part(apart(triples), int(kept.sum()), np.deg2rad(ends[side : side + 1])) for side in (0, 1)]
    low, high = (np.trunc(ends * parts * STEPS_PER_DEGREE) / STEPS_PER_DEGREE).tolist()
    return low, high


def _may_touch(field: BendField, k: int, degrees: float, skin: Skin, rounding: float) -> tuple[IntArray, IntArray]:
    """Pairs of a point and an edge of the rim, by numbers of edges, whose distances from joint k overlap at some turns.

    A point keeps its distance from the joint, or comes nearer by |m|, which is least at the largest turn; so does an
    edge whose ends have the same share. Other pairs never meet while the other joints are at rest.
    """
    rim, share = field.rim, field.shares[:, k]
    place = field.grid.vertices - field.bends[k].joint
    least = np.abs(skin.multiplier(share, np.full(len(share), np.deg2rad(degrees))))
    farthest = norm(place)
    nearest = farthest * least
    one, other = rim.T
    middle = point_edge(np.zeros_like(place[one]), place[one], place[other]).distance
    edge_nearest = np.where(share[one] == share[other], middle * least[one], 0.0)
    edge_farthest = np.maximum(farthest[one], farthest[other])
    slack = 4.0 * rounding
    meets = (nearest[one][:, None] <= edge_farthest + slack) & (farthest[one][:, None] >= edge_nearest - slack)
    point, edge = np.nonzero(meets)
    return point, edge
