"""Ranges of joints: the angles at which no triangle of a field flips, whatever the other joints do."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
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


def least_turn(ranges: Sequence[JointRange]) -> float:
    """The least angle that any of some joints turns without a fold, either way."""
    return min(min(-each.low, each.high) for each in ranges)


def first_that_turns(fields: Iterable[BendField], skin: Skin, least: float) -> tuple[BendField, list[JointRange]]:
    """The first of some fields whose joints turn at least by an angle, else the one that turns farthest, and ranges."""
    found: list[tuple[BendField, list[JointRange]]] = []
    for field in fields:
        found.append((field, ranges_of(field, skin)))
        if least_turn(found[-1][1]) >= least:
            break
    return max(found, key=lambda each: least_turn(each[1]))


def ranges_of(field: BendField, skin: Skin) -> list[JointRange]:
    """The range of each joint within a part: no angle where a vertex follows more bones than one and its parent."""
    count = len(field.bends)
    if not field.is_even:
        return [UNPROVED] * count
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
    proved = moved_by.sum(axis=1) < 2
    for first, second, are_beside in _neighbours(field.parents):
        both = moved_by[:, first] & moved_by[:, second] & (moved_by.sum(axis=1) == 2)
        proved |= both
        pair = _between(field, corner[both], first, second, are_beside, skin, rounding)
        for sides in ((0, 0), (0, 1), (1, 0), (1, 1)):
            extent = np.deg2rad(ends[[first, second], sides])
            ends[[first, second], sides] *= safe_part(unfolded(pair), int(both.sum()), extent)
    ends[moved_by[~proved].any(axis=0)] = 0.0
    ends = np.trunc(ends * STEPS_PER_DEGREE) / STEPS_PER_DEGREE
    simple = [_simple(field, k, ends[k], skin, rounding) for k in range(count)]
    return [JointRange(float(low), float(high), *narrow) for (low, high), narrow in zip(ends, simple, strict=True)]


def _neighbours(parents: Sequence[int]) -> Iterator[tuple[int, int, bool]]:
    """Pairs of joints around one bone, by number of the joint, and whether the bone carries both; else the first is its
    own joint."""
    for second in range(1, len(parents)):
        if parents[second] > 0:
            yield parents[second] - 1, second - 1, False
        for first in range(1, second):
            if parents[first] == parents[second]:
                yield first - 1, second - 1, True


def _between(
    field: BendField, corner: IntArray, first: int, second: int, are_beside: bool, skin: Skin, rounding: float
) -> TwoJoints:
    """Triangles (T, 3) that two joints move, seen from the bone between them, or that carries both."""
    place = np.asarray(field.grid.vertices @ (1.0, 1j))[corner]
    one, other = (complex(*field.bends[k].joint) for k in (first, second))
    of_second = field.shares[corner, second] > 0.0 if are_beside else field.shares[corner, first] == 1.0
    joint = np.where(of_second, other, one)
    weight = np.where(of_second, field.shares[corner, second], field.shares[corner, first])
    return TwoJoints(place - joint, joint, weight, of_second, skin, rounding, 0.0 if are_beside else 1.0)


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
