"""Cells that like to keep their shape: the common form of the as-rigid-as-possible and as-similar-as-possible energies.

A cell has k corners with rest places p, and a stiffness K, a symmetric positive semi-definite matrix (k, k) that
vanishes on constants. With points as complex numbers, turning and scaling are multiplications, and its energy is

    ½ min over r of (z - r p)ᴴ K (z - r p)   with |r| = 1 (rigid) or any r (similar).

With q = K p, s = qᴴ z and M = pᴴ K p the minimum is at r = s / |s| (rigid) or r = s / M (similar), and

    gradient K z - r q,   Hessian K - g gᵀ / |s| (rigid) or K - (g gᵀ + h hᵀ) / M (similar),   g = i r̂ q, h = r̂ q,

where r̂ = r / |r| and products of complex numbers inside g gᵀ are read as vectors of the plane. The rigid one is
indefinite where |s| < M, that is, under compression; M in the place of |s| makes it semi-definite, since gᵀ K⁺ g = M.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from .._types import FloatArray, IntArray
from .assembly import add_up, blocks_of
from .base import Blocks

ComplexArray: TypeAlias = npt.NDArray[np.complex128]

COLLAPSED = 1e-12
"""Fraction of M below which |s| is not divided by: such a cell has shrunk to a point and no direction is its own."""


@dataclass(frozen=True, eq=False)
class Cells:
    """The energy of E cells of k corners each; see :class:`nestedcages_core.energies.base.CageEnergy`."""

    corners: IntArray
    """(E, k) vertices; one may occur twice in a cell."""
    rest: ComplexArray
    """(E, k) p, the places at rest, relative to the first corner."""
    stiffness: FloatArray
    """(E, k, k) K; unit: none."""
    similar: bool
    """Whether scaling is free as well."""

    @classmethod
    def of(cls, corners: IntArray, places: FloatArray, stiffness: FloatArray, *, similar: bool) -> Cells:
        """Cells whose vertices rest at ``places`` (m, 2)."""
        return cls(corners, _complex(places, corners), stiffness, similar)

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """Unit: length²."""
        state = self._state(vertices)
        left = state.z - state.turn[:, None] * self.rest
        return 0.5 * float((left.conj() * _times(self.stiffness, left)).real.sum())

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2): K (z - r p), since r is optimal."""
        state = self._state(vertices)
        force = _times(self.stiffness, state.z - state.turn[:, None] * self.rest)
        return add_up(self.corners, _vectors(force), len(vertices))

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Exact."""
        return self._blocks(vertices, projected=False)

    def projected_hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Positive semi-definite, cell by cell, in closed form."""
        return self._blocks(vertices, projected=True)

    def after(self, cage: FloatArray) -> Cells:
        """Itself: shape is measured against the coarse mesh at all times."""
        return self

    def _state(self, vertices: FloatArray) -> _State:
        z = _complex(vertices, self.corners)
        q = _times(self.stiffness, self.rest)
        moment = (self.rest.conj() * q).real.sum(axis=1)
        s = (q.conj() * z).sum(axis=1)
        size = np.maximum(np.abs(s), COLLAPSED * moment)
        direction = s / size
        return _State(z, q, moment, size, direction, s / moment if self.similar else direction)

    def _blocks(self, vertices: FloatArray, *, projected: bool) -> Blocks:
        state = self._state(vertices)
        count, k = self.corners.shape
        hessian = np.zeros((count, k, 2, k, 2))
        for axis in (0, 1):
            hessian[:, :, axis, :, axis] = self.stiffness
        hessian = hessian.reshape(count, 2 * k, 2 * k)
        along = state.direction[:, None] * state.q
        across = _vectors(1j * along).reshape(count, 2 * k)
        if self.similar:
            radial = _vectors(along).reshape(count, 2 * k)
            softening = across[:, :, None] * across[:, None, :] + radial[:, :, None] * radial[:, None, :]
            return blocks_of(self.corners, hessian - softening / state.moment[:, None, None])
        size = np.maximum(state.size, state.moment) if projected else state.size
        return blocks_of(self.corners, hessian - across[:, :, None] * across[:, None, :] / size[:, None, None])


@dataclass(frozen=True, eq=False)
class _State:
    """What the derivatives of E cells share."""

    z: ComplexArray
    """(E, k) corners now."""
    q: ComplexArray
    """(E, k)."""
    moment: FloatArray
    """(E,) M."""
    size: FloatArray
    """(E,) |s|."""
    direction: ComplexArray
    """(E,) r̂."""
    turn: ComplexArray
    """(E,) r."""


def stiffness_of(k: int, start: IntArray, end: IntArray, weight: FloatArray) -> FloatArray:
    """(E, k, k) K with zᴴ K z = Σ w |z_end - z_start|² over Q edges in each cell.

    start, end: (Q,) corners of the edges within a cell; weight: (E, Q).
    """
    incidence = np.zeros((len(start), k))
    edge = np.arange(len(start))
    incidence[edge, end] += 1.0
    incidence[edge, start] -= 1.0
    stiffness: FloatArray = np.einsum("qi,eq,qj->eij", incidence, weight, incidence)
    return stiffness


def _complex(vertices: FloatArray, corners: IntArray) -> ComplexArray:
    """(E, k) the corners as complex numbers, relative to the first one of their cell."""
    places = (vertices - vertices[0])[corners]
    z: ComplexArray = places[..., 0] + 1j * places[..., 1]
    return z - z[:, :1]


def _vectors(z: ComplexArray) -> FloatArray:
    """(E, k, 2) from complex numbers (E, k)."""
    return np.stack([z.real, z.imag], axis=-1)


def _times(matrix: FloatArray, z: ComplexArray) -> ComplexArray:
    """K z for each cell."""
    product: ComplexArray = (matrix @ z[:, :, None])[:, :, 0]
    return product
