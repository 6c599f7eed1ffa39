"""Directions of negative curvature, to leave a saddle.

Where the gradient vanishes along the active constraints, the energy still falls along a direction of negative
curvature: the eigenvector of the smallest eigenvalue of W, with the active constraints held by stiff springs. It is
found by inverse iteration (Golub & Van Loan, Matrix Computations, section 8.2).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..errors import NestedCagesError
from ..geometry.arrays import BoolArray, FloatArray
from ..geometry.precision import MOST_ROUNDS, MOST_STEPS, NEGLIGIBLE
from ..geometry.vectors import inner
from .banded import BandedSystem, BandOrder
from .quadratic_program import DAMPING_GROWTH, FIRST_DAMPING, NOT_FINITE, QuadraticProgram, block_scale


class NegativeCurvature(NamedTuple):
    """A direction of negative curvature."""

    direction: FloatArray
    """(m, 2), its longest row of length 1."""
    curvature: float
    """Second derivative of the energy along it; negative."""


def negative_curvature(program: QuadraticProgram, order: BandOrder, active: BoolArray) -> NegativeCurvature | None:
    """A direction of negative curvature along the active rows (K,) of the program; None at a minimum."""
    hessian, rows = program.hessian, program.rows
    size = 2 * len(program.radius)
    scale = block_scale(hessian)
    order = order.including(hessian, rows)
    system = BandedSystem(order, hessian, rows, program.axes)
    h = np.zeros(len(active) + 2 * size)
    h[: len(active)] = np.where(active, scale / NEGLIGIBLE, 0.0)  # stiff: constraints hold to six digits
    system.set_matrix(h)
    if scale == 0.0 or system.factorise(0.0):
        return None
    shift = FIRST_DAMPING * scale
    for _ in range(MOST_STEPS):
        if system.factorise(shift):
            break
        shift *= DAMPING_GROWTH
    else:
        raise NestedCagesError(NOT_FINITE, code="solver.not_finite")
    v = np.cos(np.arange(size) ** 2)  # generic: not orthogonal to the eigenvectors of symmetric shapes
    growth = 1.0
    for _ in range(MOST_ROUNDS):
        v /= np.sqrt(inner(v, v))
        w = system.solve(v)
        growth = inner(v, w)
        v = w
    curvature = 1.0 / growth - shift
    if curvature > -NEGLIGIBLE * scale:
        return None
    motion = system.of_vertices(v)
    longest = np.sqrt((motion**2).sum(axis=1).max())
    return NegativeCurvature(motion / longest, curvature * inner(v, v) / float(longest) ** 2)
