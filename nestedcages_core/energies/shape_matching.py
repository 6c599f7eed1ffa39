"""ShapeMatching that like to keep their shape: the common form of the energies that measure strain.

A cell has k corners with rest places p, and a stiffness K, a symmetric positive semi-definite matrix (k, k) that
vanishes on constants. With points as complex numbers, turning and growing are multiplications by a number r, and the
energy of a cell at the places z is

    ½ min over r of (z - r p)ᴴ K (z - r p).

With q = K p, s = qᴴ z and M = pᴴ K p the gradient is K z - r q at the best r, and the Hessian K - g gᵀ / a:

    a cell may turn (|r| = 1):   r = s / |s|,    g = i r q,   a = |s|;
    a cell may grow (r real):    r = Re s / M,   g = q,       a = M;

complex numbers in g gᵀ are read as vectors of the plane. Since gᵀ K⁺ g = M, the Hessian is positive semi-definite where
a ≥ M, and indefinite where a cell that may turn is compressed; M in the place of a makes it semi-definite there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import FloatArray, IntArray
from .assembly import add_up, blocks_of
from .base import Blocks

ComplexArray: TypeAlias = npt.NDArray[np.complex128]

COLLAPSED = 1e-12
"""Fraction of M below which |s| is not divided by: such a cell has shrunk to a point and no direction is its own."""


class Fit(NamedTuple):
    """The best r of E cells, and how it follows them."""

    factor: ComplexArray
    """(E,) r."""
    following: ComplexArray
    """(E,) g / q."""
    divisor: FloatArray
    """(E,) a."""


class LocalFit(Protocol):
    """What a cell may do without strain."""

    def fit(self, s: ComplexArray, moment: FloatArray) -> Fit:
        """The best factors for s and M (E,)."""
        ...


@dataclass(frozen=True)
class RotationFit:
    """ShapeMatching may turn."""

    def fit(self, s: ComplexArray, moment: FloatArray) -> Fit:
        """r = s / |s|."""
        size = np.maximum(np.abs(s), COLLAPSED * moment)
        r: ComplexArray = s / size
        return Fit(r, 1j * r, size)


@dataclass(frozen=True)
class ScaleFit:
    """ShapeMatching may grow and shrink."""

    def fit(self, s: ComplexArray, moment: FloatArray) -> Fit:
        """r = Re s / M."""
        return Fit((s.real / moment).astype(np.complex128), np.ones_like(s), moment)


@dataclass(frozen=True, eq=False)
class ShapeMatching:
    """The energy of E cells of k corners each; see :class:`nestedcages_core.energies.base.CageEnergy`."""

    corners: IntArray
    """(E, k) vertices; one may occur twice in a cell."""
    rest: ComplexArray
    """(E, k) p, the places at rest, relative to the first corner."""
    stiffness: FloatArray
    """(E, k, k) K; unit: none."""
    freedom: LocalFit

    @classmethod
    def of(cls, corners: IntArray, places: FloatArray, stiffness: FloatArray, freedom: LocalFit) -> ShapeMatching:
        """ShapeMatching whose vertices rest at ``places`` (m, 2)."""
        return cls(corners, _complex(places, corners), stiffness, freedom)

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """Unit: length²."""
        strain = self._strain(vertices)
        return 0.5 * float((strain.conj() * _times(self.stiffness, strain)).real.sum())

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2): K (z - r p), since r is the best one."""
        return add_up(self.corners, _vectors(_times(self.stiffness, self._strain(vertices))), len(vertices))

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Exact."""
        return self._blocks(vertices, 0.0)

    def projected_hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Positive semi-definite, cell by cell, in closed form."""
        return self._blocks(vertices, 1.0)

    def after(self, cage: FloatArray) -> ShapeMatching:
        """Itself: shape is measured against the coarse mesh at all times."""
        return self

    def _fit(self, z: ComplexArray) -> tuple[Fit, ComplexArray, FloatArray]:
        """The fit to the places z (E, k), q and M."""
        q = _times(self.stiffness, self.rest)
        moment = (self.rest.conj() * q).real.sum(axis=1)
        return self.freedom.fit((q.conj() * z).sum(axis=1), moment), q, moment

    def _strain(self, vertices: FloatArray) -> ComplexArray:
        """(E, k) z - r p."""
        z = _complex(vertices, self.corners)
        fit, _, _ = self._fit(z)
        return z - fit.factor[:, None] * self.rest

    def _blocks(self, vertices: FloatArray, least: float) -> Blocks:
        """K - g gᵀ / a with a no less than ``least`` · M."""
        fit, q, moment = self._fit(_complex(vertices, self.corners))
        count, k = self.corners.shape
        hessian = np.zeros((count, k, 2, k, 2))
        for axis in (0, 1):
            hessian[:, :, axis, :, axis] = self.stiffness
        g = _vectors(fit.following[:, None] * q).reshape(count, 2 * k)
        softened = g[:, :, None] * g[:, None, :] / np.maximum(fit.divisor, least * moment)[:, None, None]
        return blocks_of(self.corners, hessian.reshape(count, 2 * k, 2 * k) - softened)


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
    z: ComplexArray = vertices[corners] @ np.array([1.0, 1.0j])
    return z - z[:, :1]


def _vectors(z: ComplexArray) -> FloatArray:
    """(E, k, 2) from complex numbers (E, k)."""
    return np.stack([z.real, z.imag], axis=-1)


def _times(matrix: FloatArray, z: ComplexArray) -> ComplexArray:
    """K z for each cell."""
    product: ComplexArray = (matrix @ z[:, :, None])[:, :, 0]
    return product
