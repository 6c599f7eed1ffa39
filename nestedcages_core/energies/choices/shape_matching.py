"""Shape matching: the strain of elements that may turn, or grow, at no cost.

The common form of the energies that measure strain (shape matching after Müller et al. 2005; weights after Chao et al.
2010). An element has k corners with rest positions p and a stiffness K (k, k), symmetric and positive semi-definite,
with K 1 = 0. With points as complex numbers, rotation and scaling are products with a number r, and the energy of an
element at the positions z is

    ½ min over r of (z - r p)ᴴ K (z - r p).

With q = K p, s = qᴴ z and M = pᴴ K p the gradient is K z - r q at the best r, and the Hessian K - g gᵀ / a:

    rotation (|r| = 1):   r = s / |s|,    g = i r q,   a = |s|;
    scaling (r real):     r = Re s / M,   g = q,       a = M,

with g as a vector of the plane in g gᵀ. Since gᵀ K⁺ g = M, the Hessian is positive semi-definite where a ≥ M, and
indefinite where a rotating element is compressed. Replacing a by max(a, M) makes it semi-definite.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.precision import INPUT_ROUND_OFF
from ..base import Blocks, CageEnergy, assembled_gradient, assembled_hessian

ComplexArray: TypeAlias = npt.NDArray[np.complex128]


class Fit(NamedTuple):
    """The best r of E elements, and its derivative."""

    factor: ComplexArray
    """(E,) r."""
    derivative: ComplexArray
    """(E,) g / q."""
    divisor: FloatArray
    """(E,) a."""


LocalFit: TypeAlias = Callable[[ComplexArray, FloatArray], Fit]
"""The motions of an element that cost nothing: the best r for s and M (E,)."""


def rotation_fit(s: ComplexArray, moment: FloatArray) -> Fit:
    """Rotations: r = s / |s|."""
    size = np.maximum(np.abs(s), INPUT_ROUND_OFF * moment)
    r: ComplexArray = s / size
    return Fit(r, 1j * r, size)


def scale_fit(s: ComplexArray, moment: FloatArray) -> Fit:
    """Uniform scalings: r = Re s / M."""
    return Fit((s.real / moment).astype(np.complex128), np.ones_like(s), moment)


@dataclass(frozen=True, eq=False)
class ShapeMatching(CageEnergy):
    """The energy of E elements with k corners each."""

    corners: IntArray
    """(E, k) vertices; one may occur twice in an element."""
    rest: ComplexArray
    """(E, k) p, relative to the first corner."""
    stiffness: FloatArray
    """(E, k, k) K, without unit."""
    local_fit: LocalFit

    @classmethod
    def of(cls, corners: IntArray, rest: FloatArray, stiffness: FloatArray, local_fit: LocalFit) -> ShapeMatching:
        """Elements of vertices with the rest positions ``rest`` (m, 2)."""
        return cls(corners, _complex(rest, corners), stiffness, local_fit)

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """Unit: length²."""
        strain = self._strain(vertices)
        return 0.5 * float((strain.conj() * _times(self.stiffness, strain)).real.sum())

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2) K (z - r p): the derivative of r drops out, since r is optimal."""
        gradients = _vectors(_times(self.stiffness, self._strain(vertices)))
        return assembled_gradient(self.corners, gradients, len(vertices))

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Exact."""
        return self._blocks(vertices, 0.0)

    def projected_hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Positive semi-definite, element by element, in closed form."""
        return self._blocks(vertices, 1.0)

    def _fit(self, z: ComplexArray) -> tuple[Fit, ComplexArray, FloatArray]:
        """The fit to the positions z (E, k), q and M."""
        q = _times(self.stiffness, self.rest)
        moment = (self.rest.conj() * q).real.sum(axis=1)
        return self.local_fit((q.conj() * z).sum(axis=1), moment), q, moment

    def _strain(self, vertices: FloatArray) -> ComplexArray:
        """(E, k) z - r p."""
        z = _complex(vertices, self.corners)
        fit, _, _ = self._fit(z)
        return z - fit.factor[:, None] * self.rest

    def _blocks(self, vertices: FloatArray, least: float) -> Blocks:
        """K - g gᵀ / a with a at least ``least`` · M."""
        fit, q, moment = self._fit(_complex(vertices, self.corners))
        count, k = self.corners.shape
        hessian = np.zeros((count, k, 2, k, 2))
        for axis in (0, 1):
            hessian[:, :, axis, :, axis] = self.stiffness
        g = _vectors(fit.derivative[:, None] * q).reshape(count, 2 * k)
        softening = g[:, :, None] * g[:, None, :] / np.maximum(fit.divisor, least * moment)[:, None, None]
        return assembled_hessian(self.corners, hessian.reshape(count, 2 * k, 2 * k) - softening)


def edge_stiffness(k: int, start: IntArray, end: IntArray, weight: FloatArray) -> FloatArray:
    """(E, k, k) K with zᴴ K z = Σ w |z_end - z_start|² over Q edges per element.

    start, end: (Q,) corners of the edges within an element; weight: (E, Q).
    """
    incidence = np.zeros((len(start), k))
    edge = np.arange(len(start))
    incidence[edge, end] += 1.0
    incidence[edge, start] -= 1.0
    stiffness: FloatArray = np.einsum("qi,eq,qj->eij", incidence, weight, incidence)
    return stiffness


def _complex(vertices: FloatArray, corners: IntArray) -> ComplexArray:
    """(E, k) the corners as complex numbers, relative to the first corner of their element."""
    z: ComplexArray = vertices[corners] @ np.array([1.0, 1.0j])
    return z - z[:, :1]


def _vectors(z: ComplexArray) -> FloatArray:
    """(E, k, 2) from complex numbers (E, k)."""
    return np.stack([z.real, z.imag], axis=-1)


def _times(matrix: FloatArray, z: ComplexArray) -> ComplexArray:
    """K z for each element."""
    product: ComplexArray = (matrix @ z[:, :, None])[:, :, 0]
    return product
