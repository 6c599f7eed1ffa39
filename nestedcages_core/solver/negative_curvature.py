"""The motion of least curvature among those that keep the active constraints: the way off a saddle.

At a point where the gradient vanishes along the active constraints, the energy still falls along a motion of negative
curvature. The motion is the eigenvector of the smallest eigenvalue of W with the active constraints held by stiff
springs, found by inverse iteration (Golub & Van Loan, Matrix Computations, section 8.2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import NestedCagesError
from ..geometry.arrays import BoolArray, FloatArray
from .banded import BandedSystem, BandOrder
from .quadratic_program import MAX_DAMPINGS, NOT_FINITE, QuadraticProgram, block_scale

SPRING = 1e6
"""Stiffness of the springs, relative to the largest block of W: held to six digits."""

ITERATIONS = 12
"""Steps of the inverse iteration: it starts from a generic vector, and any motion of negative curvature will do."""

FIRST_SHIFT, SHIFT_GROWTH = 0.03, 3.0
"""Shift that is tried first to make the matrix positive definite, relative to the largest block of W; factor of the
others."""

NEGATIVE = 1e-6
"""Curvature above minus this fraction of the largest block of W counts as none."""


@dataclass(frozen=True, eq=False)
class NegativeCurvature:
    """A motion and its curvature."""

    motion: FloatArray
    """(m, 2), its longest row of length 1."""
    curvature: float
    """Second derivative of the energy along it; negative."""


def negative_curvature(program: QuadraticProgram, order: BandOrder, active: BoolArray) -> NegativeCurvature | None:
    """A motion of negative curvature that keeps the active rows (K,) of the program true; None at a minimum."""
    hessian, rows = program.hessian, program.rows
    size = 2 * len(program.radius)
    scale = block_scale(hessian)
    order = order.including(hessian, rows)
    system = BandedSystem(order, hessian, rows, program.axes)
    h = np.zeros(len(active) + 2 * size)
    h[: len(active)] = np.where(active, SPRING * scale, 0.0)
    system.set_matrix(h)
    if scale == 0.0 or system.factorise(0.0):
        return None
    shift = FIRST_SHIFT * scale
    for _ in range(MAX_DAMPINGS):
        if system.factorise(shift):
            break
        shift *= SHIFT_GROWTH
    else:
        raise NestedCagesError(NOT_FINITE)
    v = np.cos(np.arange(size) ** 2)  # orthogonal to no eigenvector of a symmetric shape
    growth = 1.0
    for _ in range(ITERATIONS):
        v /= np.sqrt(v @ v)
        w = system.solve(v)
        growth = float(v @ w)
        v = w
    curvature = 1.0 / growth - shift
    if curvature > -NEGATIVE * scale:
        return None
    motion = system.of_vertices(v)
    longest = np.sqrt((motion**2).sum(axis=1).max())
    return NegativeCurvature(motion / longest, curvature * float(v @ v) / float(longest) ** 2)
