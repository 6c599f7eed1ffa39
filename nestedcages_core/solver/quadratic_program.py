"""Quadratic programs over the vertices of a cage, by Mehrotra's predictor-corrector interior-point method.

    minimise   G·D + ½ Dᵀ (W + δ I) D + ½ Σ e² / ε
    subject to r + J D + e ≥ 0,   |D_i| ≤ Δ_i along two axes

Without softness (ε = 0) the constraints hold strictly (e = 0). Complementarity, feasibility and stationarity are solved
for together, first for the affine step, then for one that is centred and corrected to second order by what the affine
step has shown (Mehrotra 1992; Nocedal & Wright, Numerical Optimization, section 16.6).

W may be indefinite: where the matrix of a Newton system is not positive definite, the system is damped until it is. The
constraints that become active on the way make it definite in the end, unless the bounds alone end the descent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..energies import Blocks
from ..errors import NestedCagesError
from ..geometry.arrays import FloatArray
from .banded import BandedSystem, BandOrder, Rows

START_MULTIPLIER, START_SLACK = 1.0, 0.1
"""Multipliers start at this fraction of their expected size, slacks at least at this fraction of the radius (of five
values each, those with which typical programs need the fewest systems)."""

STEP_TO_BOUNDARY = 0.99
"""Fraction of the way to the nearest bound that a step may take."""

SMALLEST_CENTRING = 1e-4
"""Lower bound of Mehrotra's centring parameter (affine complementarity / complementarity)³."""

FAILED_CORRECTOR = 0.02
"""Step lengths below which the corrector is dropped for a plain centring step."""

FIRST_DAMPING = 0.05
"""First damping tried when the Newton system is not positive definite, relative to the largest block of W."""

MORE_DAMPING, LESS_DAMPING, SMALLEST_DAMPING = 3.0, 1.0 / 3.0, 1e-3
"""Factors of the further tries, and of the first try of the next system; fraction of the first damping below which none
is tried."""

MAX_DAMPINGS = 100
"""Cap on the tries for one system: the last damping is 1e46 times the largest block of W."""

DAMPING_MARGIN = 3.0
"""Factor of the damping that succeeded: a matrix that is hardly positive definite lets roundings decide the way."""

TINY = float(np.finfo(float).tiny)
"""Guards divisions."""

NOT_FINITE = (
    "The energy of the cage has derivatives that are not finite numbers; write it so that they exist wherever the cage "
    "may be, the coarse mesh included."
)
"""What is wrong with such a program, and where no damping makes a matrix positive definite."""


@dataclass(frozen=True, eq=False)
class QuadraticProgram:
    """The data of one program; m vertices, K rows."""

    gradient: FloatArray
    """(m, 2) G."""
    hessian: Blocks
    """W over the m vertices; it may be indefinite."""
    rows: Sequence[Rows]
    """J, K rows in all, in groups that touch equally many vertices."""
    offset: FloatArray
    """(K,) r, the value of each constraint at D = 0."""
    radius: FloatArray
    """(m,) Δ > 0, largest motion of each vertex along each of its axes."""
    axes: FloatArray
    """(m, 2, 2) the two axes of each vertex: vertex, axis, component. Axes that turn with the cage make its motion
    independent of the coordinates."""
    shift: float = 0.0
    """δ ≥ 0."""
    softness: FloatArray | None = None
    """(K,) ε ≥ 0 of each row; 0 makes it hard, and None all of them."""
    scale: float | None = None
    """Size that the multipliers are expected to have; None: the length of the longest row of G."""
    order: BandOrder | None = None
    """A numbering of the vertices that will do unless the rows couple distant ones; None: one is made."""


@dataclass(frozen=True, eq=False)
class QPSolution:
    """Where the method stopped."""

    step: FloatArray
    """(m, 2) D."""
    multipliers: FloatArray
    """(K,) multipliers of the rows, ≥ 0."""
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
    """Largest violation of a constraint at the end, relative to the mean radius."""
    dual: float = 0.02
    """Longest residual of stationarity of a vertex at the end, relative to the scale of the multipliers."""

    def solve(self, program: QuadraticProgram, absolute: float = 0.0) -> QPSolution:
        """Solve; ``absolute`` is a complementarity, in units of the energy, that is small enough in any case.

        Raises: NestedCagesError for an energy whose derivatives are not finite.
        """
        return _Iteration(self, program).run(absolute)


class _Iteration:
    """State of one solve, the unknowns those of the banded system.

    Slacks and multipliers are ordered: K rows, then the 2m lower, then the 2m upper bounds. The residuals of
    feasibility and stationarity are linear in the steps, so they are kept up to date instead of computed anew, and the
    predicted decrease follows from them without a product with W.
    """

    def __init__(self, method: InteriorPoint, program: QuadraticProgram) -> None:
        self.method = method
        m, self.K = len(program.radius), len(program.offset)
        order = program.order or BandOrder.of(m, program.hessian.row, program.hessian.column)
        order = order.including(program.hessian, program.rows)
        self.system = BandedSystem(order, program.hessian, program.rows, program.axes)
        size = 2 * m
        self.G = self.system.along_axes(program.gradient)
        radius = self.system.per_unknown(program.radius)
        self.softness = program.softness
        self.shift = program.shift
        self.length = float(radius.mean())
        self.scale = program.scale or max(_longest(self.G), TINY)
        self.damping = 0.0
        self.first_damping = FIRST_DAMPING * block_scale(program.hessian) or FIRST_DAMPING
        if not (np.isfinite(self.scale) and np.isfinite(self.first_damping)):
            raise NestedCagesError(NOT_FINITE)

        # start: slacks at least a little inside, multipliers so that no product is larger than the others
        K = self.K
        self.D = np.zeros(size)
        self.spread = np.zeros(K + 2 * size)
        self.s = np.concatenate([program.offset, radius, radius])
        np.maximum(self.s[:K], START_SLACK * self.length, out=self.s[:K])
        self.z = np.full(len(self.s), START_MULTIPLIER * self.scale)
        self.z[:K] *= np.minimum(1.0, self.length / self.s[:K])
        self.primal = np.zeros(len(self.s))
        self.primal[:K] = program.offset - self.s[:K]
        if self.softness is not None:
            self.primal[:K] += self.softness * self.z[:K]
        self.dual = self.G - self.system.transposed(self.z)

    def run(self, absolute: float) -> QPSolution:
        method, K = self.method, self.K
        converged = False
        for iteration in range(method.iterations + 1):
            complementarity = float(self.z @ self.s)
            decrease = -0.5 * float(self.D @ (self.G + self.dual) + self.spread @ self.z)
            converged = (
                complementarity <= method.complementarity * abs(decrease) + absolute
                and float(np.abs(self.primal[:K]).max(initial=0.0)) <= method.primal * self.length
                and _longest(self.dual) <= method.dual * self.scale
            )
            if converged or iteration == method.iterations:
                break
            self._factorise()
            self._step(complementarity / len(self.s))
        return QPSolution(self.system.of_vertices(self.D), self.z[:K].copy(), decrease, iteration, converged)

    def _factorise(self) -> None:
        """Factorise the Newton system, damped where it is not positive definite."""
        self.denominator = self.s
        if self.softness is not None:
            self.denominator = self.s.copy()
            self.denominator[: self.K] += self.softness * self.z[: self.K]
        self.h = self.z / self.denominator
        self.system.set_matrix(self.h)
        damping = least = LESS_DAMPING * self.damping if self.damping > SMALLEST_DAMPING * self.first_damping else 0.0
        for _ in range(MAX_DAMPINGS):
            if self.system.factorise(self.shift + damping):
                break
            damping = max(MORE_DAMPING * damping, self.first_damping)
        else:
            raise NestedCagesError(NOT_FINITE)
        if damping > least:
            damping *= DAMPING_MARGIN
            self.system.factorise(self.shift + damping)
        self.damping = damping

    def _step(self, mean: float) -> None:
        """One predictor-corrector step from the mean complementarity."""
        s, z = self.s, self.z
        affine = -z * (s + self.primal)
        d, spread, ds, dz = self._direction(affine)
        after = float((z + min(1.0, _reach(z, dz)) * dz) @ (s + min(1.0, _reach(s, ds)) * ds)) / len(s)
        centring = min(max((after / mean) ** 3, SMALLEST_CENTRING), 1.0)
        d, spread, ds, dz = self._direction(affine + (centring * mean - ds * dz))
        step, dual_step = STEP_TO_BOUNDARY * _reach(s, ds), STEP_TO_BOUNDARY * _reach(z, dz)
        if max(step, dual_step) < FAILED_CORRECTOR:
            d, spread, ds, dz = self._direction(affine + mean)
            step, dual_step = STEP_TO_BOUNDARY * _reach(s, ds), STEP_TO_BOUNDARY * _reach(z, dz)
        step, dual_step = min(step, 1.0), min(dual_step, 1.0)
        # undamped, a whole step would undo both residuals: A d + primal + ε dz = ds, (W + δ I) d + dual = Aᵀ dz
        curved = self.system.transposed(dz) - self.dual
        self.dual = (1.0 - dual_step) * self.dual + (step - dual_step) * curved - (step * self.damping) * d
        self.primal = (1.0 - step) * self.primal
        if self.softness is not None:
            self.primal[: self.K] += (dual_step - step) * self.softness * dz[: self.K]
        self.D = self.D + step * d
        self.spread = self.spread + step * spread
        self.s = s + step * ds
        self.z = z + dual_step * dz

    def _direction(self, products: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Newton direction d with its changes of the rows, of the slacks and of the multipliers.

        It makes z ds + s dz = products + z primal, and feasible and stationary what is linear.
        """
        y = products / self.denominator
        d = self.system.solve(self.system.transposed(y) - self.dual)
        spread = self.system.constraints(d)
        dz = y - self.h * spread
        ds = spread + self.primal
        if self.softness is not None:
            ds[: self.K] += self.softness * dz[: self.K]
        return d, spread, ds, dz


def block_scale(hessian: Blocks) -> float:
    """Largest Frobenius norm of a block."""
    return float(np.sqrt((hessian.value**2).sum(axis=(1, 2)).max(initial=0.0)))


def _longest(vectors: FloatArray) -> float:
    """Length of the longest of the vectors whose components follow each other."""
    return float(np.sqrt((vectors.reshape(-1, 2) ** 2).sum(axis=1).max()))


def _reach(x: FloatArray, dx: FloatArray) -> float:
    """Largest multiple of dx that keeps x > 0 from becoming negative."""
    steepest = float((dx / x).min())
    return -1.0 / steepest if steepest < 0.0 else float("inf")
