"""The energy of reinflation, λ_R R + λ_cages E_cages + λ_B B, and its projected Newton direction.

The unknowns are all positions x = (C; F). Fine vertices are coupled to the cage but hardly to each other, so they are
eliminated: their block of
the Hessian is made block-diagonal from above (for a pair with two fine vertices, (u + w)² ≤ 2 u² + 2 w², so the matrix
stays positive definite and
the direction a descent direction), and what is left is a system in the 2 m unknowns of the cage.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg.lapack
import scipy.sparse as sp
import scipy.sparse.linalg

from .._types import FloatArray, IntArray
from ..distance import PointEdge, distance_gradient
from ..energies import CageEnergy
from ..energies.restoring import Restoring
from ..solver import Model
from .barrier import barrier, barrier_hessian_factors
from .barrier_ranges import BarrierRanges
from .ccd import impacts, largest_safe_step
from .pairs import Bodies, CandidateList, Pairs

CAGE_VERTEX_WEIGHT = 0.25
"""Boundary length that a cage vertex stands for in C-F pairs, as a fraction of the mean coarse edge length."""

OWN_VERTEX_WEIGHT = 0.1
"""The same in C-C pairs, where a light touch is enough to keep the cage off itself."""

DENSE_LIMIT = 150
"""Number of cage vertices up to which a dense Cholesky factorisation is faster than a sparse one (measured)."""

REST_MARGIN = 0.2
"""Fraction of its distance that every pair must keep when the fine mesh goes the rest of its way at once."""

SKIN = 0.5
"""Skin of the candidate list as a fraction of the mean coarse edge length."""

REGULARISATION = 1e-6
"""Added to the diagonal of the cage's system: keeps it definite when an energy leaves a motion free (area has curvature
of order 1)."""


SMALLEST_SHIFT = 1e-14
"""First shift of a system's unit diagonal that rounding has made indefinite."""

SHIFT_GROWTH = 100.0
"""Factor on a shift that was too small."""

MAX_SHIFTS = 10
"""Cap on the shifts tried: the last is 1e4 times the diagonal."""


@dataclass(frozen=True)
class Weights:
    """The paper's λ, in units of the fine mesh's size and per length of boundary."""

    restoring: float
    cages: float
    barrier: float


class IncrementalPotential:
    """λ_R R + λ_cages E_cages + λ_B B as an objective for a solver; infinite (E_cont) where a step would pass through a
    contact.

    Containment is kept by construction: the start is contained, and a step is only taken as far as continuous collision
    detection
    shows that no point meets an edge on the way. The walls of the barrier make value and line search agree with that.
    """

    def __init__(
        self,
        bodies: Bodies,
        energy: CageEnergy,
        restoring: Restoring,
        weights: Weights,
        ranges: BarrierRanges,
        candidates: CandidateList,
    ) -> None:
        self.bodies = bodies
        self.energy = energy
        self.restoring = restoring
        self.weights = weights
        self.ranges = ranges
        self.candidates = candidates
        self.skin = SKIN * bodies.cage_edge_length
        self._x: FloatArray | None = None
        self._pairs: Pairs | None = None
        self._measured: PointEdge | None = None

    def value(self, x: FloatArray) -> float:
        """The energy at x (m + n, 2); infinite at contact and for a negative area."""
        m = self.bodies.m
        cages = self.energy.value(x[:m], self.bodies.cage_successor)
        if not np.isfinite(cages):
            return np.inf
        pairs, pair, d_hat = self._active(x)
        terms = barrier(pair.distance, d_hat)
        contact = float(self._pair_weight(pairs, d_hat) @ terms.value)
        return self.weights.restoring * self.restoring.value(x[m:]) + self.weights.cages * cages + contact

    def newton(self, x: FloatArray) -> Model:
        """Value, gradient and projected Newton direction at x, all with respect to (C; F)."""
        m, n = self.bodies.m, self.bodies.n
        pairs, pair, d_hat = self._active(x)
        weight = self._pair_weight(pairs, d_hat)
        terms = barrier(pair.distance, d_hat)
        cage, fine = x[:m], x[m:]
        value = (
            self.weights.restoring * self.restoring.value(fine)
            + self.weights.cages * self.energy.value(cage, self.bodies.cage_successor)
            + float(weight @ terms.value)
        )
        corners = np.stack([pairs.point, pairs.start, pairs.end], axis=1)
        push = ((weight * terms.first)[:, None] * distance_gradient(pair)).reshape(-1, 2)
        gradient = np.empty_like(x)
        for axis in (0, 1):
            gradient[:, axis] = np.bincount(corners.ravel(), push[:, axis], m + n)
        gradient[:m] += self.weights.cages * self.energy.gradient(cage, self.bodies.cage_successor)
        gradient[m:] += self.weights.restoring * self.restoring.gradient(fine)

        factors = barrier_hessian_factors(terms, weight, pair, x[pairs.start], x[pairs.end])
        return Model(value, gradient, self._direction(cage, corners, factors, gradient))

    def largest_step(self, x: FloatArray, direction: FloatArray) -> float:
        """Fraction of ``direction`` free of impacts, with a safety margin."""
        squared = direction[:, 0] ** 2 + direction[:, 1] ** 2
        m = self.bodies.m
        cage, fine = float(np.sqrt(squared[:m].max())), float(np.sqrt(squared[m:].max()))
        pairs, pair = self._measure(x, self.ranges.largest + cage + max(cage, fine))
        return largest_safe_step(pairs, x, direction, pair.distance)

    def finished(self, x: FloatArray) -> bool:
        """Whether the fine mesh can go straight to its target without coming much closer to the cage anywhere."""
        motion = np.zeros_like(x)
        m = self.bodies.m
        motion[m:] = self.restoring.target - x[m:]
        length = float(np.sqrt((motion * motion).sum(axis=1).max()))
        pairs, pair = self._measure(x, self.ranges.largest + length)
        after = pairs.measure(x + motion).distance
        if (after <= REST_MARGIN * np.minimum(pair.distance, self.ranges.largest)).any():
            return False
        return len(impacts(pairs, x, motion, pair.distance)[0]) == 0

    def _measure(self, x: FloatArray, reach: float) -> tuple[Pairs, PointEdge]:
        """All candidate pairs within reach and their distances, remembered for the last x."""
        pairs = self.candidates.within(x, reach, self.skin)
        if self._x is not x or self._pairs is not pairs or self._measured is None:
            self._x, self._pairs, self._measured = x, pairs, pairs.measure(x)
        return pairs, self._measured

    def _active(self, x: FloatArray) -> tuple[Pairs, PointEdge, FloatArray]:
        """The pairs within their range, their distances and ranges."""
        pairs, pair = self._measure(x, self.ranges.largest)
        d_hat = self.ranges.of(self.bodies, pairs)
        active = pair.distance < d_hat
        return pairs.subset(active), PointEdge(*(field[active] for field in pair)), d_hat[active]

    def _pair_weight(self, pairs: Pairs, d_hat: FloatArray) -> FloatArray:
        """(K,) λ_B times boundary length over d̂: the pressure is then of order λ_B whatever the range."""
        weight = np.empty(len(pairs))
        weight[pairs.fine_cage] = self.bodies.fine_weight[pairs.point[pairs.fine_cage] - self.bodies.m]
        weight[pairs.cage_fine] = CAGE_VERTEX_WEIGHT * self.bodies.cage_edge_length
        weight[pairs.cage_cage] = OWN_VERTEX_WEIGHT * self.bodies.cage_edge_length
        weight *= self.weights.barrier / d_hat
        return weight

    def _direction(self, cage: FloatArray, corners: IntArray, factors: FloatArray, gradient: FloatArray) -> FloatArray:
        """-(projected Hessian)⁻¹ gradient: fine vertices eliminated, the cage solved for, the fine vertices put
        back."""
        m, n = self.bodies.m, self.bodies.n
        of_cage, of_fine = self._jacobians(corners, factors)
        blocks = np.zeros((n, 2, 2))
        blocks[:, 0, 0] = blocks[:, 1, 1] = self.weights.restoring * self.restoring.weight
        pieces = factors.reshape(-1, 3, 3, 2)
        for corner in (0, 1, 2):
            vertex = corners[:, corner] - m
            fine = np.flatnonzero(vertex >= 0)
            if len(fine):
                share = 1.0 if corner == 0 else 2.0  # see the module's docstring
                piece = pieces[fine, :, corner]
                own = share * (piece.transpose(0, 2, 1) @ piece)
                for i in (0, 1):
                    for j in (0, 1):
                        blocks[:, i, j] += np.bincount(vertex[fine], own[:, i, j], n)
        inverse = _inverse_2x2(blocks)
        coupling = (of_fine.T @ of_cage).tocsr()
        weighted = _block_diagonal(inverse) @ coupling
        system = of_cage.T @ of_cage - coupling.T @ weighted
        right = -gradient[:m].ravel() + weighted.T @ gradient[m:].ravel()
        motion = np.empty((m + n, 2))
        motion[:m] = self._solve(cage, system, right).reshape(m, 2)
        rest = gradient[m:] + (coupling @ motion[:m].ravel()).reshape(n, 2)
        motion[m:] = -(inverse @ rest[:, :, None])[:, :, 0]
        return motion

    def _jacobians(self, corners: IntArray, factors: FloatArray) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """The factors as sparse matrices (3 K, 2 m) and (3 K, 2 n)."""
        m, n = self.bodies.m, self.bodies.n
        count = len(corners)
        rows = np.broadcast_to(np.arange(3 * count).reshape(count, 3, 1, 1), (count, 3, 3, 2)).ravel()
        columns = np.broadcast_to((2 * corners[:, None, :, None] + np.arange(2)), (count, 3, 3, 2)).ravel()
        values = factors.ravel()
        in_cage = columns < 2 * m
        in_fine = ~in_cage
        cage = sp.csr_matrix((values[in_cage], (rows[in_cage], columns[in_cage])), shape=(3 * count, 2 * m))
        fine = sp.csr_matrix((values[in_fine], (rows[in_fine], columns[in_fine] - 2 * m)), shape=(3 * count, 2 * n))
        return cage, fine

    def _solve(self, cage: FloatArray, system: sp.spmatrix, right: FloatArray) -> FloatArray:
        """Solve for the cage with the projected Hessian of its energy added."""
        m = self.bodies.m
        blocks = self.energy.projected_hessian(cage, self.bodies.cage_successor)
        matrix = system + self.weights.cages * blocks.sparse(m) + REGULARISATION * sp.identity(2 * m)
        # pressures across a gap of 1e-6 are 1e12 times those of the area: equal diagonals keep both
        diagonal = matrix.diagonal()
        scale = 1.0 / np.sqrt(np.maximum(diagonal, SMALLEST_SHIFT * diagonal.max()))
        scaled = sp.diags(scale) @ matrix @ sp.diags(scale)
        solve = _dense_solver(scaled.toarray()) if m <= DENSE_LIMIT else _sparse_solver(scaled.tocsc())
        return np.asarray(scale * solve(scale * right))


def _dense_solver(matrix: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Solver of a system with a unit diagonal by Cholesky factorisation, shifted until rounding leaves it definite."""
    shift = 0.0
    for _ in range(MAX_SHIFTS):
        factor, failed = scipy.linalg.lapack.dpotrf(matrix, lower=1)
        if not failed:
            return lambda right: np.asarray(scipy.linalg.lapack.dpotrs(factor, right, lower=1)[0])
        grown = max(SHIFT_GROWTH * shift, SMALLEST_SHIFT)
        matrix[np.diag_indices(len(matrix))] += grown - shift
        shift = grown
    return np.copy  # the diagonal alone: a descent direction whatever the rest is


def _sparse_solver(matrix: sp.csc_matrix) -> Callable[[FloatArray], FloatArray]:
    """The same for a sparse matrix, by LU factorisation, which needs the shift only to stay away from zero pivots."""
    definite = matrix + SMALLEST_SHIFT * sp.identity(matrix.shape[0], format="csc")
    factor = scipy.sparse.linalg.splu(
        definite, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    return lambda right: np.asarray(factor.solve(right))


def _inverse_2x2(blocks: FloatArray) -> FloatArray:
    """Inverses of (k, 2, 2) matrices."""
    a, b, c, d = blocks[:, 0, 0], blocks[:, 0, 1], blocks[:, 1, 0], blocks[:, 1, 1]
    inverse = np.empty_like(blocks)
    inverse[:, 0, 0], inverse[:, 0, 1], inverse[:, 1, 0], inverse[:, 1, 1] = d, -b, -c, a
    inverse /= (a * d - b * c)[:, None, None]
    return inverse


def _block_diagonal(blocks: FloatArray) -> sp.bsr_matrix:
    """(2 k, 2 k) sparse matrix with the (k, 2, 2) blocks on its diagonal."""
    count = len(blocks)
    return sp.bsr_matrix((blocks, np.arange(count), np.arange(count + 1)), shape=(2 * count, 2 * count))
