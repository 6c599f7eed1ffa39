"""From the step of a quadratic program to a state that keeps all distances: restore, check, shorten where needed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..contact.ccd import impacts
from ..contact.linearisation import Contacts
from ..contact.pairs import Bodies, Pairs
from ..energies import CageEnergy
from ..geometry.arrays import FloatArray
from .restoration import restore

ATTEMPTS = 10
"""Number of times that a step is shortened."""

SHORTEN = 0.4
"""Factor by which the steps of failing vertices are shortened."""

WIDEN = 3
"""Attempt from which the neighbours of failing vertices are shortened as well."""

GIVE_UP = 7
"""Attempt from which failing vertices stand still."""

RESERVE = 1.5
"""How much farther than its own step, or its neighbours', restoration may move a vertex before all pairs are looked
at."""

SUFFICIENT_DECREASE = 1e-4
"""Fraction of the predicted decrease that an accepted step must reach (Armijo's rule)."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A step that was tried."""

    x: FloatArray
    """(m + n, 2) positions after it; those before it if it was not accepted."""
    fraction: FloatArray
    """(m,) part of each vertex's step that was kept."""
    value: float
    """Energy after it."""
    accepted: bool


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The pairs that can meet when no vertex moves farther than it is ``able`` to."""

    pairs: Pairs
    contacts: Contacts
    required: FloatArray
    """(K,) distances to keep."""
    able: FloatArray
    """(m + n,)."""

    def within(self, able: FloatArray) -> Surroundings:
        """Those that can meet when no vertex moves farther than ``able`` (m + n,), which is less."""
        pairs = self.pairs
        near = self.contacts.distance - self.required <= pairs.approach(able)
        return Surroundings(pairs.subset(near), self.contacts.where(near), self.required[near], able)


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
    """The longest part of the cage's ``step`` (m, 2) found that, restored, keeps all distances, meets nothing and
    lowers the energy.

    value: the energy at x (m + n, 2); decrease: predicted by the model.
    """
    m = bodies.m
    fraction = np.ones(m)
    motion = np.zeros_like(x)
    closest = float(around.required.min(initial=np.inf))
    near = around.within(_expected(bodies, step, around))
    for attempt in range(ATTEMPTS):
        tried = x.copy()
        tried[:m] += fraction[:, None] * step
        restored, after = restore(bodies, near.pairs, tried, near.required, near.contacts.side)
        moved = np.hypot(*(restored[:m] - x[:m]).T)
        if (moved > near.able[:m]).any() and near is not around:
            near = around
            restored, after = restore(bodies, near.pairs, tried, near.required, near.contacts.side)
            moved = np.hypot(*(restored[:m] - x[:m]).T)
        if (moved > around.able[:m]).any():
            fraction *= SHORTEN
            continue
        np.subtract(restored[:m], x[:m], out=motion[:m])
        hit, _ = impacts(near.pairs, x, motion, near.contacts.distance, closest)
        failing = np.concatenate([hit, np.flatnonzero(after.distance < near.required)])
        if len(failing) == 0:
            restored_value = energy.value(restored[:m], bodies.cage_successor)
            if restored_value < value - SUFFICIENT_DECREASE * float(fraction.min()) * max(decrease, 0.0):
                return Trial(restored, fraction, restored_value, True)
            # vertices that were shortened by themselves may have left a step that goes uphill
            shortest = float(fraction.min())
            fraction = np.full(m, shortest if shortest < float(fraction.max()) else SHORTEN * shortest)
            continue
        pairs = near.pairs
        vertex = np.concatenate([pairs.point[failing], pairs.start[failing], pairs.end[failing]])
        vertex = np.unique(vertex[vertex < m])
        if attempt >= WIDEN:
            vertex = np.unique(
                np.concatenate([vertex, bodies.cage_successor[vertex], bodies.cage_predecessor[vertex]])
            )  # fmt: skip
        fraction[vertex] *= SHORTEN if attempt < GIVE_UP else 0.0
    return Trial(x, fraction, value, False)


def _expected(bodies: Bodies, step: FloatArray, around: Surroundings) -> FloatArray:
    """(m + n,) how far each vertex will hardly move with its step and the restoration after it."""
    length = np.hypot(step[:, 0], step[:, 1])
    beside = np.maximum(length[bodies.cage_predecessor], length[bodies.cage_successor])
    expected = around.able.copy()
    reserve = RESERVE * np.maximum(length, beside) + float(around.required.max(initial=0.0))
    expected[: bodies.m] = np.minimum(expected[: bodies.m], reserve)
    return expected
