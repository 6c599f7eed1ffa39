"""The log barrier of Incremental Potential Contact on point-edge pairs, with closed-form derivatives.

    b(d) = -(d - d̂)² log(d / d̂) for 0 < d < d̂,  0 beyond,  infinite at contact          (Li et al. 2020, equation 6)

B in Gurditta & Jacobson 2022, section 3.2, is the sum over all pairs. Here each pair has its own weight.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..energies import Blocks
from ..energies.base import assembled_gradient, assembled_hessian
from ..geometry.arrays import FloatArray
from ..geometry.distance import PointEdge, bending, coefficients, distance_gradient, interior, tangents
from ..geometry.vectors import inner
from ..solver.sparse_lu import definite_solution
from .pairs import Pairs


class BarrierTerms(NamedTuple):
    """The barrier of K pairs and its derivatives with respect to the distance."""

    value: FloatArray
    """(K,) b, a length²."""
    first: FloatArray
    """(K,) b', a length."""
    second: FloatArray
    """(K,) b'', without unit."""


def barrier(distance: FloatArray, d_hat: float) -> BarrierTerms:
    """b(d), b'(d), b''(d) for distances (K,); infinite where d ≤ 0."""
    inside = (distance < d_hat) & (distance > 0.0)
    d = np.where(inside, distance, d_hat)
    gap = d - d_hat
    logarithm = np.log(d / d_hat)
    ratio = gap / d
    value = -gap * gap * logarithm
    first = -gap * (2.0 * logarithm + ratio)
    second = -2.0 * logarithm - 4.0 * ratio + ratio * ratio
    contact = distance <= 0.0
    if contact.any():
        value[contact], first[contact], second[contact] = np.inf, -np.inf, np.inf
    return BarrierTerms(value, first, second)


def barrier_hessian_factors(
    terms: BarrierTerms, weight: FloatArray, pair: PointEdge, a: FloatArray, b: FloatArray
) -> FloatArray:
    """Factors U (K, 3, 6): Uᵀ U is a positive semi-definite part of the weighted Hessian of each pair's barrier.

    weight: (K,); a, b: (K, 2) ends of the edges. The Hessian is w (b'' ∂d ∂dᵀ + b' ∂²d) with b' < 0. Its terms are
    projected one by one, without an eigensolver. b'' ∂d ∂dᵀ and the d q qᵀ of -∂²d are semi-definite. Since c_t ⊥ q,
    c_t qᵀ + q c_tᵀ has the eigenvalues ± |c_t| |q|, the positive one with the eigenvector (ĉ_t + q̂)/√2. Where an end
    point is closest, -∂²d has no positive part.
    """
    c = coefficients(pair)
    gradient = (c[:, :, None] * pair.normal[:, None, :]).reshape(-1, 6)
    c_t = (c[:, :, None] * tangents(pair, a, b)[:, None, :]).reshape(-1, 6)
    q = bending(pair)
    push = np.where(interior(pair), -terms.first, 0.0) * weight
    c_t_length = np.sqrt((c * c).sum(axis=1))
    q_length = np.sqrt(2.0) / pair.length
    factors = np.empty((len(push), 3, 6))
    factors[:, 0] = np.sqrt(weight * terms.second)[:, None] * gradient
    turning = np.sqrt(0.5 * push * c_t_length * q_length)
    factors[:, 1] = (turning / c_t_length)[:, None] * c_t + (turning / q_length)[:, None] * q
    factors[:, 2] = np.sqrt(push * pair.distance)[:, None] * q
    return factors


@dataclass(frozen=True, eq=False)
class BarrierSum:
    """Σ w b(d) over K pairs at positions x (m + n, 2)."""

    x: FloatArray
    pairs: Pairs
    measured: PointEdge
    weight: FloatArray
    """(K,) w."""
    terms: BarrierTerms

    @classmethod
    def at(
        cls, x: FloatArray, pairs: Pairs, measured: PointEdge, *, weight: FloatArray | float, d_hat: float
    ) -> BarrierSum:
        """The sum for one range and one weight or (K,) of them."""
        return cls(x, pairs, measured, np.broadcast_to(weight, len(pairs)), barrier(measured.distance, d_hat))

    @property
    def value(self) -> float:
        """The sum; infinite in contact."""
        return inner(self.weight, self.terms.value)

    def gradient(self) -> FloatArray:
        """(m + n, 2)."""
        push = (self.weight * self.terms.first)[:, None] * distance_gradient(self.measured)
        return assembled_gradient(self.pairs.corners, push.reshape(-1, 3, 2), len(self.x))

    def newton_direction(self, gradient: FloatArray, restoring: FloatArray, cage: Blocks) -> FloatArray:
        """-H⁻¹ gradient, (m + n, 2), for the projected Hessian of the sum and of two other terms.

        gradient: (m + n, 2) of the whole energy; restoring: (n,) stiffness of the fine vertices; cage: positive
        semi-definite Hessian over the m cage vertices.
        """
        starts, ends = self.x[self.pairs.start], self.x[self.pairs.end]
        factors = barrier_hessian_factors(self.terms, self.weight, self.measured, starts, ends)
        own = assembled_hessian(self.pairs.corners, factors.transpose(0, 2, 1) @ factors)
        fine = np.arange(len(self.x) - len(restoring), len(self.x))
        home = Blocks(fine, fine, restoring[:, None, None] * np.eye(2))
        return -definite_solution(Blocks.sum([(1.0, own), (1.0, home), (1.0, cage)]), gradient)
