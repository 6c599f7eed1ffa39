"""Convex quadratic programs over the vertices of a cage, by Mehrotra's predictor-corrector interior-point method.

    minimise   G·D + ½ Dᵀ (W + δ I) D + |e|² / (2 ε)
    subject to r + J D + e ≥ 0,   |D_i| ≤ Δ_i in each coordinate

with the shift δ raised until the matrix of the Newton system is positive definite. Without softness (ε = 0) the
constraints hold strictly (e = 0). Complementarity, feasibility and stationarity are solved for together, first for the
affine step, then for one that is centred and corrected to second order by what the affine step has shown (Mehrotra
1992; Nocedal & Wright, Numerical Optimization, section 16.6).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .._types import FloatArray
from ..energies import Blocks
from .normal_equations import NormalEquations, Rows, normal_equations

START_MULTIPLIER = 0.1
"""Multipliers start at this fraction of the largest entry of the gradient, slacks at least at this fraction of the
radius."""

STEP_TO_BOUNDARY = 0.98
"""Fraction of the way to the nearest bound that a step may take."""

SMALLEST_CENTRING = 1e-4
"""Lower bound of Mehrotra's centring parameter (affine complementarity / complementarity)³."""

FAILED_CORRECTOR = 0.02
"""Step lengths below which the corrector is dropped for a plain centring step."""

FIRST_SHIFT = 0.05
"""First shift δ tried when the Newton system is not positive definite, relative to the largest entry of W."""

SHIFT_GROWTH = 3.0
"""Factor of the further tries."""

TINY = float(np.finfo(float).tiny)
"""Guards divisions."""


@dataclass(frozen=True, eq=False)
class QuadraticProgram:
    """The data of one program; m vertices, K rows."""

    gradient: FloatArray
    """(m, 2) G."""
    hessian: Blocks
    """W over the m vertices; it may be indefinite."""
    rows: Rows
    """J, K rows."""
    offset: FloatArray
    """(K,) r, the value of each constraint at D = 0."""
    radius: FloatArray
    """(m,) Δ > 0, largest motion of each vertex along each axis."""
    shift: float = 0.0
    """First δ ≥ 0."""
    softness: float = 0.0
    """ε ≥ 0; 0 makes the constraints hard."""
    scale: float | None = None
    """Size that the multipliers are expected to have; None: the largest entry of G."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Where the method stopped."""

    step: FloatArray
    """(m, 2) D."""
    multipliers: FloatArray
    """(K,) multipliers of the rows, ≥ 0."""
    shift: float
    """The δ that was needed."""
    decrease: float
    """Predicted decrease -(G·D + ½ Dᵀ (W + δ I) D)."""
    iterations: int
    """Number of factorised systems."""
    converged: bool
    """Whether all tolerances were met."""


@dataclass(frozen=True)
class InteriorPoint:
    """Mehrotra's predictor-corrector method."""

    iterations: int = 40
    """Cap on the number of systems."""
    complementarity: float = 0.03
    """Stop when the complementarity is below this fraction of the predicted decrease: a tenth of a per cent of it would
    cost two more systems and change the next outline by less than its linearisation does."""
    primal: float = 1e-3
    """Largest violation of a constraint at the end, relative to the median radius."""
    dual: float = 0.02
    """Largest entry of the residual of stationarity at the end, relative to the scale of the multipliers."""

    def solve(self, program: QuadraticProgram, absolute: float = 0.0) -> Solution:
        """Solve; ``absolute`` is a complementarity, in units of the energy, that is small enough in any case."""
        equations = normal_equations(program.hessian, program.rows, len(program.radius))
        return _Iteration(self, program, equations).run(absolute)


class _Iteration:
    """State of one solve. Slacks and multipliers are ordered: K rows, then the 2m lower, then the 2m upper bounds."""

    def __init__(self, method: InteriorPoint, program: QuadraticProgram, equations: NormalEquations) -> None:
        self.method, self.equations = method, equations
        self.G = program.gradient.ravel()
        self.K, self.N = len(program.offset), len(self.G)
        radius = np.repeat(program.radius, 2)
        self.offset = np.concatenate([program.offset, radius, radius])
        self.softness = np.zeros(self.K + 2 * self.N)
        self.softness[: self.K] = program.softness
        self.shift = program.shift
        self.length = float(np.median(program.radius))
        self.scale = program.scale or max(float(np.abs(self.G).max()), TINY)
        self.first_shift = FIRST_SHIFT * float(np.abs(program.hessian.value).max(initial=0.0)) or FIRST_SHIFT
        # start: slacks at least a little inside, multipliers so that no product is larger than the others
        multiplier, length = START_MULTIPLIER * self.scale, START_MULTIPLIER * self.length
        self.D = np.zeros(self.N)
        self.s = self.offset.copy()
        np.maximum(self.s[: self.K], length, out=self.s[: self.K])
        self.z = np.full(len(self.s), multiplier)
        self.z[: self.K] *= np.minimum(1.0, self.length / self.s[: self.K])

    def run(self, absolute: float) -> Solution:
        method, equations = self.method, self.equations
        converged = False
        for iteration in range(method.iterations + 1):
            primal = self.offset + self._spread(self.D) + self.softness * self.z - self.s
            curved = equations.hessian_times(self.D)
            lagrangian = curved + self.G - self._gather(self.z)
            complementarity = float(self.z @ self.s)
            squared = float(self.D @ self.D)
            decrease = -float(self.G @ self.D + 0.5 * (curved @ self.D)) - 0.5 * self.shift * squared
            dual = lagrangian + self.shift * self.D
            converged = (
                complementarity <= method.complementarity * abs(decrease) + absolute
                and (self.K == 0 or float(np.abs(primal[: self.K]).max()) <= method.primal * self.length)
                and float(np.abs(dual).max()) <= method.dual * self.scale
            )
            if converged or iteration == method.iterations:
                break
            self._factorise()
            self._step(primal, lagrangian + self.shift * self.D, complementarity / len(self.s))
        return Solution(
            self.D.reshape(-1, 2), self.z[: self.K].copy(), self.shift, decrease, iteration, converged
        )  # fmt: skip

    def _factorise(self) -> None:
        """Factorise the Newton system, with a larger shift where it is not positive definite."""
        self.denominator = self.s + self.softness * self.z
        self.h = self.z / self.denominator
        self.equations.set_matrix(
            self.h[: self.K], self.h[self.K : self.K + self.N] + self.h[self.K + self.N :]
        )  # fmt: skip
        while not self.equations.factorise(self.shift):
            self.shift = max(SHIFT_GROWTH * self.shift, self.first_shift)

    def _step(self, primal: FloatArray, dual: FloatArray, mean: float) -> None:
        """One predictor-corrector step from the residuals of feasibility and stationarity and the mean
        complementarity."""
        s, z = self.s, self.z
        affine = -z * (s + primal)
        d, ds, dz = self._direction(affine, primal, dual)
        after = float((z + min(1.0, _reach(z, dz)) * dz) @ (s + min(1.0, _reach(s, ds)) * ds)) / len(s)
        centring = min(max((after / mean) ** 3, SMALLEST_CENTRING), 1.0)
        d, ds, dz = self._direction(affine + (centring * mean - ds * dz), primal, dual)
        step, dual_step = STEP_TO_BOUNDARY * _reach(s, ds), STEP_TO_BOUNDARY * _reach(z, dz)
        if step < FAILED_CORRECTOR and dual_step < FAILED_CORRECTOR:
            d, ds, dz = self._direction(affine + mean, primal, dual)
            step, dual_step = STEP_TO_BOUNDARY * _reach(s, ds), STEP_TO_BOUNDARY * _reach(z, dz)
        step, dual_step = min(step, 1.0), min(dual_step, 1.0)
        self.D = self.D + step * d
        self.s = s + step * ds
        self.z = z + dual_step * dz

    def _direction(
        self, products: FloatArray, primal: FloatArray, dual: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Newton direction (d, ds, dz) towards z s + z ds + s dz = products + z (s + primal), feasible and
        stationary."""
        y = products / self.denominator
        d = self.equations.solve(self._gather(y) - dual)
        spread = self._spread(d)
        dz = y - self.h * spread
        return d, spread + primal + self.softness * dz, dz

    def _spread(self, d: FloatArray) -> FloatArray:
        """(K + 4m,) change of all slacks by the step d."""
        out = np.empty(self.K + 2 * self.N)
        out[: self.K] = self.equations.rows_times(d)
        out[self.K : self.K + self.N] = d
        np.negative(d, out=out[self.K + self.N :])
        return out

    def _gather(self, z: FloatArray) -> FloatArray:
        """(2m,) transpose of :meth:`_spread`."""
        out = self.equations.transposed_times(z[: self.K])
        out += z[self.K : self.K + self.N]
        out -= z[self.K + self.N :]
        return out


def _reach(x: FloatArray, dx: FloatArray) -> float:
    """Largest multiple of dx that keeps x > 0 from becoming negative."""
    steepest = float((dx / x).min())
    return -1.0 / steepest if steepest < 0.0 else float("inf")
