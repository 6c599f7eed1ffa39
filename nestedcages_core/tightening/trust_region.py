"""Trust region: how far vertices may move (Conn, Gould & Toint 2000, algorithm 6.1.1), and the trials of a step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..contact.ccd import impacts
from ..contact.pairs import Bodies, Pairs
from ..energies import CageEnergy
from ..geometry.arrays import TINY, FloatArray
from ..geometry.precision import SUFFICIENT_DECREASE
from ..solver.quadratic_program import QPSolution
from .reach_clearance import restore

FAIR_GAIN, POOR_GAIN = 0.5, 0.25
"""Gain, the actual decrease of the energy over the predicted one, above which the radius may grow and below which it
shrinks."""

LINEAR = 0.9999
"""Gain above which the model is exact, as where a cage slides along needles: radii are doubled beyond the largest."""

GROWTH = 2.5
"""Factor on the longest motion of a good step, for the radius after it."""

MAX_ATTEMPTS = 3
"""Cap on the trials of one step; more gain nothing over a new model with smaller radii (docs/numbers.md: trials of
shortened steps)."""

STEP_REDUCTION = 0.4
"""Factor on the steps of failing vertices, and on the longest motion of a step that was too long for the model."""

EXPECTED_MOTION = 2.0
"""Motion of a vertex, restoration included, up to which only nearby pairs are checked, relative to its own step or the
steps of its neighbours."""


class Trial(NamedTuple):
    """The outcome of a step."""

    x: FloatArray
    """(m + n, 2) positions after the step, or before it if it was rejected."""
    value: float
    """Energy at x."""
    accepted: bool


def next_radius(radius: float, largest: float, solution: QPSolution, trial: Trial, gain: float) -> float:
    """The radius Δ after a trial that gained an energy; largest: that is allowed while the model is not exact."""
    longest = float(np.hypot(solution.step[:, 0], solution.step[:, 1]).max())
    part = gain / max(solution.decrease, TINY)
    if not trial.accepted or part < POOR_GAIN:
        return min(radius, STEP_REDUCTION * longest)
    if part <= FAIR_GAIN:
        return radius
    most = 2.0 * radius if part > LINEAR and radius >= largest else largest
    return max(radius, min(GROWTH * longest, most))


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The pairs that can meet in a motion of limited length."""

    pairs: Pairs
    distance: FloatArray
    """(K,) their distances before it."""
    side: FloatArray
    """(K,) sides of the edges that the points are on."""
    required: FloatArray
    """(K,) distances to keep."""
    farthest_motion: FloatArray
    """(m + n,) longest motion of each vertex."""

    def within(self, farthest_motion: FloatArray) -> Surroundings:
        """The pairs that can meet in shorter motions."""
        pairs = self.pairs
        near = np.flatnonzero(self.distance - self.required <= pairs.approach(farthest_motion))
        distance, side, required = (field.take(near) for field in (self.distance, self.side, self.required))
        return Surroundings(pairs.take(near), distance, side, required, farthest_motion)


def find_trial(
    bodies: Bodies,
    around: Surroundings,
    x: FloatArray,
    step: FloatArray,
    *,
    value: float,
    decrease: float,
    energy: CageEnergy,
) -> Trial:
    """Reduce a ``step`` (m, 2) of the cage until, restored, it keeps all distances, is collision-free and lowers the
    energy.

    value: the energy at x (m + n, 2); decrease: predicted by the model.
    """
    m = bodies.m
    fraction = np.ones(m)
    motion, missed = np.zeros_like(x), np.zeros(0, np.int64)
    closest = float(around.required.min(initial=np.inf))
    near = around.within(_expected(bodies, step, around))
    lacking = bodies.short(x[:m])
    for _ in range(MAX_ATTEMPTS):
        tried = x.copy()
        tried[:m] += bodies.scaled(step, fraction)
        restored, after = restore(bodies, near.pairs, tried, near.required, near.side, lacking)
        moved = np.hypot(*(restored[:m] - x[:m]).T)
        if (moved > near.farthest_motion[:m]).any() and near is not around:
            near = around
            restored, after = restore(bodies, near.pairs, tried, near.required, near.side, lacking)
            moved = np.hypot(*(restored[:m] - x[:m]).T)
        if (moved > around.farthest_motion[:m]).any():
            fraction *= STEP_REDUCTION
            continue
        np.subtract(restored[:m], x[:m], out=motion[:m])
        hit, _ = impacts(near.pairs, x, motion, near.distance, closest)
        failing = np.concatenate([hit, np.flatnonzero(after.distance < near.required)])
        if lacking is not None:
            missed = np.flatnonzero(np.asarray(bodies.short(restored[:m])) > lacking)
        if len(failing) == 0 and len(missed) == 0:
            restored_value = energy.value(restored[:m], bodies.coarse.successor)
            if restored_value < value - SUFFICIENT_DECREASE * float(fraction.min()) * max(decrease, 0.0):
                return Trial(restored, restored_value, True)
            # reductions of single vertices may have turned the step uphill: reduce all alike
            shortest = float(fraction.min())
            fraction = np.full(m, shortest if shortest < float(fraction.max()) else STEP_REDUCTION * shortest)
            continue
        if len(failing) == 0:  # parts of a step keep rows if all vertices take the same
            fraction = np.full(m, STEP_REDUCTION * float(fraction.min()))
            continue
        pairs = near.pairs
        vertex = np.concatenate([pairs.point[failing], pairs.start[failing], pairs.end[failing], missed])
        fraction[np.unique(vertex[vertex < m])] *= STEP_REDUCTION
        if bodies.elimination is not None:
            fraction = bodies.elimination.least(fraction)
    return Trial(x, value, False)


def _expected(bodies: Bodies, step: FloatArray, around: Surroundings) -> FloatArray:
    """(m + n,) expected upper bound on each vertex's displacement, restoration included."""
    length = np.hypot(step[:, 0], step[:, 1])
    neighbours = np.maximum(length[bodies.cage.predecessor], length[bodies.cage.successor])
    expected = around.farthest_motion.copy()
    bound = EXPECTED_MOTION * np.maximum(length, neighbours) + float(around.required.max(initial=0.0))
    expected[: bodies.m] = np.minimum(expected[: bodies.m], bound)
    return expected
