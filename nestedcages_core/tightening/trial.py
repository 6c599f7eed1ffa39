"""From the step of a quadratic program to a state that keeps all distances: restore, check, shorten where needed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .._types import FloatArray
from ..contact.ccd import impacts
from ..contact.linearisation import Contacts
from ..contact.pairs import Bodies, Pairs
from ..energies import CageEnergy
from .restoration import restore

ATTEMPTS = 10
"""Number of times that a step is shortened."""

SHORTEN = 0.4
"""Factor by which the steps of failing vertices are shortened."""

WIDEN = 3
"""Attempt from which the neighbours of failing vertices are shortened as well."""

GIVE_UP = 7
"""Attempt from which failing vertices stand still."""

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


def find_trial(
    bodies: Bodies,
    pairs: Pairs,
    contacts: Contacts,
    x: FloatArray,
    step: FloatArray,
    *,
    required: FloatArray,
    longest: float,
    value: float,
    decrease: float,
    energy: CageEnergy,
) -> Trial:
    """The longest part of the cage's ``step`` (m, 2) found that, restored, keeps all distances, meets nothing and
    lowers the energy.

    required: (K,) distances to keep; longest: longest motion of a vertex for which ``pairs`` hold all that can meet;
    value: the energy at x (m + n, 2); decrease: predicted by the model.
    """
    m = bodies.m
    fraction = np.ones(m)
    motion = np.zeros_like(x)
    closest = float(required.min(initial=np.inf))
    for attempt in range(ATTEMPTS):
        tried = x.copy()
        tried[:m] += fraction[:, None] * step
        tried, after = restore(bodies, pairs, tried, required, contacts.side)
        np.subtract(tried[:m], x[:m], out=motion[:m])
        if float(np.hypot(motion[:m, 0], motion[:m, 1]).max()) > longest:
            fraction *= SHORTEN
            continue
        hit, _ = impacts(pairs, x, motion, contacts.distance, closest)
        failing = np.concatenate([hit, np.flatnonzero(after.distance < required)])
        if len(failing) == 0:
            tried_value = energy.value(tried[:m], bodies.cage_successor)
            if tried_value < value - SUFFICIENT_DECREASE * float(fraction.min()) * max(decrease, 0.0):
                return Trial(tried, fraction, tried_value, True)
            # vertices that were shortened by themselves may have left a step that goes uphill
            shortest = float(fraction.min())
            fraction = np.full(m, shortest if shortest < float(fraction.max()) else SHORTEN * shortest)
            continue
        vertex = np.concatenate([pairs.point[failing], pairs.start[failing], pairs.end[failing]])
        vertex = np.unique(vertex[vertex < m])
        if attempt >= WIDEN:
            vertex = np.unique(
                np.concatenate([vertex, bodies.cage_successor[vertex], bodies.cage_predecessor[vertex]])
            )  # fmt: skip
        fraction[vertex] *= SHORTEN if attempt < GIVE_UP else 0.0
    return Trial(x, fraction, value, False)
