"""Certificate of an animation: between consecutive steps, linear motion never lets the cage meet the fine mesh or
itself.

From one step to the next, with s from 0 to 1, a point p and an edge a-b meet only where c = (b - a) × (p - a) is zero
and p lies beside the edge. Both c and the two products that say whether p lies beside it are quadratic in s, so each
lies between the smallest and the largest of its three Bernstein coefficients (Farouki 2012). Where those have one
sign, beyond their rounding errors, the pair is certified; so is one whose point stays on one side of both ends of the
edge along x or along y, even where the edge shrinks to a point. All other intervals of s are halved. After k halvings a
difference of positions carries an absolute error of up to k roundings of the largest one, which both tests allow for:
a relative bound says nothing about a difference that vanishes. A pair that is undecided after all halvings counts as a
collision, so the certificate is conservative.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..contact.pairs import Bodies, CandidateList, Pairs
from ..errors import NestedCagesError
from ..geometry.arrays import BoolArray, FloatArray
from ..geometry.mesh import Mesh, MeshLike
from ..stages import Stage, drain

MAX_HALVINGS = 40
"""Maximum number of halvings: an interval is then about as short as a rounding of s."""

MAX_PIECES = 32
"""Maximum number of undecided intervals of one pair: a passing contact leaves two or three, sliding leaves more."""

COEFFICIENT_ROUNDING = 16.0 * float(np.finfo(float).eps)
"""Bound on the relative rounding error of a coefficient: a product of two differences, summed twice, doubled for
safety."""

HALVING_ROUNDING = float(np.finfo(float).eps)
"""Bound on the rounding error that a halving adds to a difference of positions, relative to the largest one:
half of it for the sum; the other half, once, for the difference itself."""

UNDERFLOW = 16.0 * np.finfo(float).smallest_subnormal
"""Bound on the error of a coefficient whose products leave the range of normal floats."""

CANDIDATE_SKIN = 1.0
"""Skin of the candidate list as a fraction of the mean cage edge length."""


@dataclass(frozen=True)
class MotionCertificate:
    """Whether motion is free of collisions at every instant, given that one step is."""

    free: bool
    step: int | None = None
    """The first step whose motion to the next one could not be certified."""
    vertex: int | None = None
    """A vertex that may be hit there: an index into the vertices of the cage, followed by those of the fine mesh."""

    def __bool__(self) -> bool:
        return self.free


def verify_motion(cage: MeshLike, fine: MeshLike, cage_steps: ArrayLike, fine_steps: ArrayLike) -> MotionCertificate:
    """Certify the linear motion between consecutive steps of a cage (K + 1, m, 2) and a fine mesh (K + 1, n, 2).

    The meshes give the edges only; the fine mesh may cross itself on its way. What is certified is that no contact
    comes or goes: all instants are nested if one is, for which `verify` has a certificate. cage and fine may be
    anything that `verify` accepts.

    Raises NestedCagesError if the steps have another shape or are not finite.
    """
    cage, fine = Mesh.of(cage), Mesh.of(fine)
    cage_steps, fine_steps = _checked_steps(cage, cage_steps, "cage"), _checked_steps(fine, fine_steps, "fine")
    if len(cage_steps) != len(fine_steps):
        raise NestedCagesError(
            f"There are {len(cage_steps)} steps of the cage, but {len(fine_steps)} of the fine mesh; give as many."
        )
    return certify_motion(Bodies.of(cage, fine), list(cage_steps), list(fine_steps))


def certify_motion(
    bodies: Bodies, cage_steps: Sequence[FloatArray], fine_steps: Sequence[FloatArray]
) -> MotionCertificate:
    """`verify_motion` for steps, (m, 2) and (n, 2) each, that need no check or copy."""
    return drain(certifying(bodies, cage_steps, fine_steps))


def certifying(
    bodies: Bodies, cage_steps: Sequence[FloatArray], fine_steps: Sequence[FloatArray]
) -> Stage[float, MotionCertificate]:
    """`certify_motion` as a generator: yields the fraction done before every step and returns the certificate."""
    candidates = CandidateList(bodies)
    for step in range(len(cage_steps) - 1):
        yield step / (len(cage_steps) - 1)
        before = np.concatenate([cage_steps[step], fine_steps[step]])
        after = np.concatenate([cage_steps[step + 1], fine_steps[step + 1]])
        motion = after - before
        speed = np.sqrt(motion[:, 0] ** 2 + motion[:, 1] ** 2)
        cage_speed, fine_speed = float(speed[: bodies.m].max()), float(speed[bodies.m :].max())
        reach = cage_speed + max(cage_speed, fine_speed)
        if reach == 0.0:
            continue
        slack = COEFFICIENT_ROUNDING * float(np.abs(before).max())  # of a measured distance
        pairs = candidates.within(before, reach + slack, CANDIDATE_SKIN * bodies.cage_edge_length)
        closest = pairs.approach(speed) * (1.0 + COEFFICIENT_ROUNDING) + slack
        pairs = pairs.subset(pairs.measure(before).distance <= closest)
        certified = _never_meet(pairs, before, after)
        if not certified.all():
            return MotionCertificate(False, step, int(pairs.point[~certified][0]))
    return MotionCertificate(True)


def _checked_steps(mesh: Mesh, steps: ArrayLike, name: str) -> FloatArray:
    """Steps (K + 1, n, 2) of a mesh. Raises NestedCagesError for another shape or values that are not finite."""
    try:
        checked = np.asarray(steps, dtype=np.float64)
    except (TypeError, ValueError):
        checked = np.zeros(0)
    wanted = mesh.vertices.shape
    if checked.ndim != 3 or checked.shape[1:] != wanted or len(checked) == 0:
        raise NestedCagesError(
            f"The {name} steps have shape {np.shape(checked)}, but (steps, {wanted[0]}, {wanted[1]}) is needed: one "
            "place per vertex in each step."
        )
    bad = np.argwhere(~np.isfinite(checked).all(axis=2))
    if len(bad):
        raise NestedCagesError(f"Vertex {bad[0][1]} of {name} step {bad[0][0]} is not finite; correct its coordinates.")
    return checked


def _never_meet(pairs: Pairs, before: FloatArray, after: FloatArray) -> BoolArray:
    """(K,) whether a pair is certified to stay apart in linear motion from ``before`` to ``after``."""
    ends = [
        (x[pairs.end] - x[pairs.start], x[pairs.point] - x[pairs.start], x[pairs.point] - x[pairs.end])
        for x in (before, after)
    ]
    (edge0, start0, end0), (edge1, start1, end1) = ends
    pair = np.arange(len(pairs))
    vectors = (edge0, edge1, start0, start1, end0, end1)
    rounding = HALVING_ROUNDING * np.max([np.abs(vector).max(axis=1) for vector in vectors], axis=0)
    certified = np.ones(len(pairs), bool)
    for halvings in range(MAX_HALVINGS):
        margin = halvings * rounding[pair]
        side = _bernstein(edge0, edge1, start0, start1, margin, cross=True)
        open_ = ~(_sure(side, 1.0) | _sure(side, -1.0))
        if not open_.any():
            break
        left = margin[open_]
        along_start = _bernstein(edge0[open_], edge1[open_], start0[open_], start1[open_], left, cross=False)
        along_end = _bernstein(edge0[open_], edge1[open_], end0[open_], end1[open_], left, cross=False)
        open_[open_] = ~(_sure(along_start, -1.0) | _sure(along_end, 1.0))
        sides = np.stack([corner[open_] for corner in (start0, start1, end0, end1)])
        open_[open_] = ~_beyond(sides, margin[open_])
        crowded = np.bincount(pair[open_], minlength=len(pairs)) > MAX_PIECES
        certified[crowded] = False
        open_ &= ~crowded[pair]
        pair = pair[open_]
        edge0, edge1, start0, start1, end0, end1 = (
            array[open_] for array in (edge0, edge1, start0, start1, end0, end1)
        )
        edge, start, end = 0.5 * (edge0 + edge1), 0.5 * (start0 + start1), 0.5 * (end0 + end1)
        pair = np.concatenate([pair, pair])
        edge0, edge1 = np.concatenate([edge0, edge]), np.concatenate([edge, edge1])
        start0, start1 = np.concatenate([start0, start]), np.concatenate([start, start1])
        end0, end1 = np.concatenate([end0, end]), np.concatenate([end, end1])
    else:
        certified[pair] = False
    return certified


def _beyond(sides: FloatArray, margin: FloatArray) -> BoolArray:
    """(K,) whether, along an axis, the point is beyond both ends of the edge by the margin (K,), before and after.

    sides: (4, K, 2) from the edge's ends to the point.
    """
    beyond = (sides > margin[:, None]).all(axis=0) | (sides < -margin[:, None]).all(axis=0)
    certain: BoolArray = beyond.any(axis=1)
    return certain


def _bernstein(
    u0: FloatArray, u1: FloatArray, w0: FloatArray, w1: FloatArray, margin: FloatArray, *, cross: bool
) -> tuple[FloatArray, FloatArray]:
    """Coefficients (3, K) of u(s) × w(s), or of u(s) · w(s), for linear u and w, and bounds of their errors.

    margin: (K,) bounds on the absolute errors of the components of u and w.
    """

    def products(u: FloatArray, w: FloatArray) -> tuple[FloatArray, FloatArray]:
        first = u[:, 0] * (w[:, 1] if cross else w[:, 0])
        second = u[:, 1] * (w[:, 0] if cross else w[:, 1])
        total = first + (-second if cross else second)
        return np.asarray(total), np.abs(first) + np.abs(second)

    (low, low_size), (high, high_size) = products(u0, w0), products(u1, w1)
    (one, one_size), (other, other_size) = products(u0, w1), products(u1, w0)
    values = np.stack([low, 0.5 * (one + other), high])
    sizes = np.stack([low_size, 0.5 * (one_size + other_size), high_size])
    errors = COEFFICIENT_ROUNDING * sizes + UNDERFLOW
    if not margin.any():
        return values, errors
    # (u + δ)(w + δ) - u w for both terms of each product, the larger end of each vector taken for both
    reach = np.max([np.abs(vector).sum(axis=1) for vector in (u0, u1)], axis=0)
    reach = reach + np.max([np.abs(vector).sum(axis=1) for vector in (w0, w1)], axis=0)
    return values, errors + margin * (reach + 2.0 * margin)


def _sure(bounds: tuple[FloatArray, FloatArray], sign: float) -> BoolArray:
    """(K,) whether all coefficients certainly have the sign."""
    values, errors = bounds
    certain: BoolArray = (sign * values > errors).all(axis=0)
    return certain
