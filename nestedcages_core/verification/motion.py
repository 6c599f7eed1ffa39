"""Certificate of an animation: between consecutive steps, linear motion never lets the cage meet the fine mesh or
itself.

Only pairs that come close enough are looked at: in a block of steps, during which nothing moves far, those that are
closer at first than their vertices travel until the end of a step.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from ..contact.pairs import Bodies, find_pairs
from ..errors import NestedCagesError
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.mesh import Mesh, MeshLike
from ..geometry.precision import MOST_HALVINGS
from ..progress import Tick, no_tick

Number = TypeVar("Number", float, FloatArray)

CHUNK_PAIRS = 2_000_000
"""Coordinates of steps looked at together, and pairs; bounds the memory to about 300 MB."""

MAX_PIECES = 32
"""Maximum number of undecided intervals of one pair: a passing contact leaves two or three, sliding leaves more."""

ROUNDINGS = 16.0
"""Bound on the roundings in a coefficient: a product of two differences, summed twice, doubled for safety."""

COEFFICIENT_ROUNDING = ROUNDINGS * float(np.finfo(float).eps)
"""Bound on the relative rounding error of a coefficient."""

HALVING_ROUNDING = float(np.finfo(float).eps)
"""Bound on the rounding error that a halving adds to a difference of positions, relative to the largest one:
half of it for the sum; the other half, once, for the difference itself."""

UNDERFLOW = ROUNDINGS * np.finfo(float).smallest_subnormal
"""Bound on the error of a coefficient whose products leave the range of normal floats."""


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
    """Certify the linear motion between consecutive steps of a cage and a fine mesh.

    What is certified is that no contact comes or goes: all instants are nested if one is, for which `verify` has a
    certificate. The fine mesh may cross itself as it moves.

    Parameters
    ----------
    cage, fine : MeshLike
        As in `verify`; they give the edges only.
    cage_steps : (K + 1, m, 2) array_like
        Positions of the vertices of the cage, in any unit.
    fine_steps : (K + 1, n, 2) array_like
        Those of the fine mesh.

    Returns
    -------
    MotionCertificate
        True if all motion is free of collisions; else the first step whose motion may not be.

    Raises
    ------
    NestedCagesError
        If the steps have another shape or are not finite.
    """
    cage, fine = Mesh.of(cage, strict=True), Mesh.of(fine, strict=True)
    cage_steps, fine_steps = _checked_steps(cage, cage_steps, "cage"), _checked_steps(fine, fine_steps, "fine")
    if len(cage_steps) != len(fine_steps):
        raise NestedCagesError(
            f"There are {len(cage_steps)} steps of the cage, but {len(fine_steps)} of the fine mesh; give as many.",
            code="mesh.unreadable",
        )
    return certify_motion(Bodies.of(cage, fine), list(cage_steps), list(fine_steps))


def certify_motion(
    bodies: Bodies, cage_steps: Sequence[FloatArray], fine_steps: Sequence[FloatArray], *, tick: Tick = no_tick
) -> MotionCertificate:
    """`verify_motion` for steps, (m, 2) and (n, 2) each, that need no check or copy.

    tick: called with the fraction done before every block.
    """
    last = len(cage_steps) - 1
    step = 0
    while step < last:
        tick(step / last)
        block = _Block(bodies, cage_steps[step:], fine_steps[step:])
        for number, vertex in block.may_meet():
            return MotionCertificate(False, step + number, vertex)
        step += len(block.positions) - 1
    return MotionCertificate(True)


class _Block:
    """Consecutive steps in which nothing moves far, at least two of them."""

    def __init__(self, bodies: Bodies, cage_steps: Sequence[FloatArray], fine_steps: Sequence[FloatArray]) -> None:
        self.bodies = bodies
        self.start = np.concatenate([cage_steps[0], fine_steps[0]])
        listed, away = [self.start.T], [np.zeros(len(self.start))]
        self.farthest = away[0]
        """(m + n,) largest distance of each vertex from where it is first."""
        for cage, fine in zip(cage_steps[1:], fine_steps[1:], strict=True):
            x = np.concatenate([cage.T, fine.T], axis=1)
            distance = np.hypot(*(x - listed[0]))
            farthest = np.maximum(self.farthest, distance)
            full = self._approach(farthest) > bodies.cage_edge_length  # measured: the fastest
            if len(listed) > 1 and (full or len(listed) * x.size > CHUNK_PAIRS):
                break
            listed.append(x)
            away.append(distance)
            self.farthest = farthest
        self.positions, self.away = np.stack(listed), np.stack(away)
        """(S + 1, 2, m + n), and (S + 1, m + n) distances from the first ones."""
        self.slack = COEFFICIENT_ROUNDING * float(np.abs(self.positions).max())
        """Bound on the rounding error of a measured distance."""

    def may_meet(self) -> Iterator[tuple[int, int]]:
        """Steps from which the motion to the next one is not certified, with the vertex of a pair that may meet."""
        reach = self._approach(self.farthest)
        if reach == 0.0:
            return
        pairs = find_pairs(self.bodies, self.start, self._with_rounding(reach))
        distance = pairs.measure(self.start).distance
        corners = np.stack([pairs.point, pairs.start, pairs.end])
        motion = self.positions[1:] - self.positions[:-1]
        travelled = self.away[:-1] + np.hypot(motion[:, 0], motion[:, 1])
        count = max(1, len(pairs))
        together = max(1, CHUNK_PAIRS // count)
        for first in range(0, len(motion), together):
            point, start, end = (travelled[first : first + together].take(corner, axis=1) for corner in corners)
            close = distance <= self._with_rounding(point + np.maximum(start, end))
            places = close.ravel().nonzero()[0]
            step = places // count
            chosen = corners.take(places - step * count, axis=1)
            step += first
            free = never_meet(self._at(step, chosen), self._at(step + 1, chosen))
            yield from ((int(step[k]), int(chosen[0, k])) for k in np.flatnonzero(~free))

    def _at(self, step: IntArray, corners: IntArray) -> FloatArray:
        """(3, 2, K) positions of corners (3, K) at steps (K,)."""
        _, axes, count = self.positions.shape
        place = (axes * step + np.arange(axes)[:, None]) * count + corners[:, None]
        positions: FloatArray = self.positions.ravel().take(place)
        return positions

    def _approach(self, motion: FloatArray) -> float:
        """How much closer any pair can come by motions (m + n,)."""
        m = self.bodies.m
        cage = float(motion[:m].max())
        return cage + max(cage, float(motion[m:].max()))

    def _with_rounding(self, distance: Number) -> Number:
        """Upper bound of a measured distance."""
        return distance * (1.0 + COEFFICIENT_ROUNDING) + self.slack


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
            "position per vertex in each step.",
            code="mesh.unreadable",
        )
    bad = np.argwhere(~np.isfinite(checked).all(axis=2))
    if len(bad):
        raise NestedCagesError(
            f"Vertex {bad[0][1]} of {name} step {bad[0][0]} is not finite; correct its coordinates.",
            code="mesh.not_finite",
        )
    return checked


def never_meet(before: FloatArray, after: FloatArray) -> BoolArray:
    """(K,) whether pairs certainly stay apart in linear motion; positions (3, 2, K) of point, start and end.

    With s from 0 to 1, a point p and an edge a-b meet only where c = (b - a) × (p - a) is zero and p lies next to the
    edge. Both c and the two products that say whether p lies next to it are quadratic in s, so each lies between the
    smallest and the largest of its three Bernstein coefficients (Farouki 2012). Where those have one sign, beyond their
    rounding errors, the pair is certified; so is one whose point stays on one side of both ends of the edge along x or
    along y, even where the edge shrinks to a point. All other intervals of s are halved. After k halvings a difference
    of positions carries an absolute error of up to k roundings of the largest one, which both tests allow for: a
    relative bound says nothing about a difference that vanishes. A pair that is undecided after all halvings counts as
    a collision, so the certificate is conservative.
    """
    first, last = _differences(before), _differences(after)
    count = first.shape[2]
    pair, margin, certified = np.arange(count), np.zeros(count), np.ones(count, bool)
    rounding = margin
    for halvings in range(MOST_HALVINGS):
        side, errors = _bernstein(first[0], last[0], first[1], last[1], margin, cross=True)
        left = (~(_above(side, errors) | _above(-side, errors))).nonzero()[0]
        pair, margin, rounding = pair.take(left), margin.take(left), rounding.take(left)
        first, last = first.take(left, axis=2), last.take(left, axis=2)
        if halvings == 0:
            rounding = HALVING_ROUNDING * np.abs(np.concatenate([first, last])).max(axis=(0, 1))
        side, errors = side[::2].take(left, axis=1), errors[::2].take(left, axis=1)
        passes = (np.abs(side) > errors).all(axis=0) & (side[0] * side[1] < 0.0)
        never, always = _next_to_edge(first, last, margin)
        left = (~never).nonzero()[0]
        if len(left) == 0:
            break
        certified[pair.take(left[(passes & always).take(left)])] = False
        certified[np.bincount(pair.take(left), minlength=count) > MAX_PIECES] = False
        left = left[certified.take(pair.take(left))]
        first, last = first.take(left, axis=2), last.take(left, axis=2)
        middle = 0.5 * (first + last)
        pair, rounding = np.tile(pair.take(left), 2), np.tile(rounding.take(left), 2)
        first, last = np.concatenate([first, middle], axis=2), np.concatenate([middle, last], axis=2)
        margin = (halvings + 1) * rounding
    else:
        certified[pair] = False
    return certified


def _differences(corners: FloatArray) -> FloatArray:
    """(3, 2, K) along the edge, from its start and from its end to the point, of these at positions (3, 2, K)."""
    point, start, end = corners
    differences = np.empty_like(corners)
    for difference, (to, of) in zip(differences, ((end, start), (point, start), (point, end)), strict=True):
        np.subtract(to, of, out=difference)
    return differences


def _next_to_edge(first: FloatArray, last: FloatArray, margin: FloatArray) -> tuple[BoolArray, BoolArray]:
    """(K,) whether the point certainly never lies next to the edge, and whether it certainly always does.

    Never: before its start, after its end, or beyond both along an axis. Differences (3, 2, K), errors (K,).
    """
    (edge, *ends), (last_edge, *last_ends) = first, last
    after_start, start_errors = _bernstein(edge, last_edge, ends[0], last_ends[0], margin, cross=False)
    after_end, end_errors = _bernstein(edge, last_edge, ends[1], last_ends[1], margin, cross=False)
    sides = np.stack([*ends, *last_ends])
    beyond = (_above(sides, margin) | _above(-sides, margin)).any(axis=0)
    never = _above(-after_start, start_errors) | _above(after_end, end_errors) | beyond
    return never, _above(after_start, start_errors) & _above(-after_end, end_errors)


def _above(values: FloatArray, errors: FloatArray) -> BoolArray:
    """Whether all values along the first axis are above their errors."""
    return np.asarray((values > errors).all(axis=0))


def _bernstein(
    u0: FloatArray, u1: FloatArray, w0: FloatArray, w1: FloatArray, margin: FloatArray, *, cross: bool
) -> tuple[FloatArray, FloatArray]:
    """Coefficients (3, K) of u(s) × w(s), or of u(s) · w(s), for linear u and w (2, K), and bounds of their errors.

    margin: (K,) bounds on the absolute errors of the components of u and w.
    """
    if cross:
        w0, w1 = w0[::-1], w1[::-1]
    values, sizes = np.empty((3, len(margin))), np.empty((3, len(margin)))

    def product(u: FloatArray, w: FloatArray, k: int) -> None:
        first, second = u[0] * w[0], u[1] * w[1]
        (np.subtract if cross else np.add)(first, second, out=values[k])
        np.add(np.abs(first, out=first), np.abs(second, out=second), out=sizes[k])

    product(u1, w0, 0)
    product(u0, w1, 1)
    for both in (values, sizes):
        np.add(both[0], both[1], out=both[1])
        both[1] *= 0.5
    product(u0, w0, 0)
    product(u1, w1, 2)
    errors = COEFFICIENT_ROUNDING * sizes
    errors += UNDERFLOW
    if margin.any():
        # (u + δ)(w + δ) - u w for both terms of each product, the larger end of each vector taken for both
        reach = np.maximum(*(np.abs(u).sum(axis=0) for u in (u0, u1)))
        reach += np.maximum(*(np.abs(w).sum(axis=0) for w in (w0, w1)))
        errors += margin * (reach + 2.0 * margin)
    return values, errors
