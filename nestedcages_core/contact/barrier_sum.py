"""The barrier of all pairs at one position: its value, its gradient, and the Newton direction of an energy with it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..energies import Blocks
from ..energies.blocks import assembled_gradient
from ..geometry.arrays import FloatArray
from ..geometry.distance import PointEdge, distance_gradient
from ..geometry.vectors import inner
from .barrier import BarrierTerms, barrier, barrier_hessian_factors
from .condensation import newton_direction
from .pairs import Pairs


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
        cls, x: FloatArray, pairs: Pairs, measured: PointEdge, *, weight: FloatArray | float, d_hat: FloatArray | float
    ) -> BarrierSum:
        """The sum for one weight and range or (K,) of them."""
        count = len(pairs)
        terms = barrier(measured.distance, np.broadcast_to(d_hat, count))
        return cls(x, pairs, measured, np.broadcast_to(weight, count), terms)

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
        return newton_direction(self.pairs.corners, factors, restoring, cage, gradient)
