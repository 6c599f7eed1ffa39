"""How a point that several bones move follows them: keeping volume, or linearly as game engines do.

Two bones that share a joint move a point around it: relative to the first bone, z becomes joint + m (z - joint), with m
in the complex plane a function of the second bone's weight w and of the angle θ between them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from ...geometry.arrays import FloatArray

Complex = np.ndarray[tuple[int, ...], np.dtype[np.complex128]]


class Motions(NamedTuple):
    """Bones in the complex plane: each takes z to turn z + shift."""

    turns: Complex
    """(B,) of size 1."""
    shifts: Complex
    """(B,)."""
    halves: FloatArray
    """(B,) half the angle from rest, in radians, not wrapped."""


class Skin(Protocol):
    """A way to blend bones."""

    def moved(self, points: FloatArray, weights: FloatArray, motions: Motions) -> FloatArray:
        """(P, 2) points at rest, moved by bones with weights (P, B), rows of sum 1."""
        ...

    def multiplier(self, weight: FloatArray, angle: FloatArray) -> Complex:
        """m for weights of the second bone and angles in radians, broadcast."""
        ...

    def speed(self, weight: FloatArray, rate: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
        """Upper bound of |d(m e^(-i rate θ))/dθ| for low ≤ θ ≤ high, all within ±π: of a point at distance 1 from the
        joint, seen from a frame that turns by rate θ."""
        ...

    def weight(self, share: FloatArray) -> FloatArray:
        """Weights from 0 to 1 that turn points by about their shares, from 0 to 1, of the joint's angle."""
        ...


@dataclass(frozen=True)
class PreserveVolume:
    """Blended dual quaternions (Kavan et al. 2007), as Blender's *Preserve Volume*: |m| = 1, points keep to circles."""

    even_at: float = 135.0
    """Angle in degrees at which weights turn points exactly by their shares; at others nearly so."""

    def moved(self, points: FloatArray, weights: FloatArray, motions: Motions) -> FloatArray:
        real = np.exp(1j * motions.halves)
        dual = 0.5 * motions.shifts * np.conj(real)
        strongest = real[weights.argmax(axis=1)]
        signs = np.where(np.real(real[None] * np.conj(strongest)[:, None]) < 0.0, -1.0, 1.0)
        blended, moved = (weights * signs) @ real, (weights * signs) @ dual
        size = np.abs(blended)
        blended, moved = blended / size, moved / size
        z = blended**2 * (points[:, 0] + 1j * points[:, 1]) + 2.0 * moved * blended
        return np.stack((z.real, z.imag), axis=1)

    def multiplier(self, weight: FloatArray, angle: FloatArray) -> Complex:
        blend = 1.0 - weight + weight * np.exp(0.5j * angle)
        return np.asarray((blend / np.abs(blend)) ** 2)

    def speed(self, weight: FloatArray, rate: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
        # d arg m/dθ is monotonic in cos(θ/2), so its extremes are those at the ends
        nearest = np.where((low <= 0.0) & (high >= 0.0), 0.0, np.minimum(np.abs(low), np.abs(high)))
        farthest = np.maximum(np.abs(low), np.abs(high))
        ends = [np.abs(_turning(weight, np.cos(0.5 * angle)) - rate) for angle in (nearest, farthest)]
        return np.asarray(np.maximum(*ends))

    def weight(self, share: FloatArray) -> FloatArray:
        return _on_chord(share, 0.5 * np.deg2rad(self.even_at))


@dataclass(frozen=True)
class Linear:
    """Weighted sums of where bones take a point, as in game engines: |m| < 1 between bones, so limbs get thinner."""

    even_at: float = 110.0
    """Angle in degrees at which weights turn points exactly by their shares; at others nearly so."""

    def moved(self, points: FloatArray, weights: FloatArray, motions: Motions) -> FloatArray:
        z = (weights @ motions.turns) * (points[:, 0] + 1j * points[:, 1]) + weights @ motions.shifts
        return np.stack((z.real, z.imag), axis=1)

    def multiplier(self, weight: FloatArray, angle: FloatArray) -> Complex:
        return np.asarray(1.0 - weight + weight * np.exp(1j * angle))

    def speed(self, weight: FloatArray, rate: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
        # |w (1 - rate) e^(iθ) - rate (1 - w)| grows with |θ|
        ahead, behind = weight * (1.0 - rate), rate * (1.0 - weight)
        farthest = np.maximum(np.abs(low), np.abs(high))
        return np.asarray(np.abs(ahead * np.exp(1j * farthest) - behind))

    def weight(self, share: FloatArray) -> FloatArray:
        return _on_chord(share, np.deg2rad(self.even_at))


def _turning(weight: FloatArray, cosine: FloatArray) -> FloatArray:
    """d arg m/dθ of blended dual quaternions, at the cosine of θ/2."""
    both = weight * (1.0 - weight) * cosine
    return np.asarray((weight**2 + both) / ((1.0 - weight) ** 2 + weight**2 + 2.0 * both))


def _on_chord(share: FloatArray, angle: float) -> FloatArray:
    """The weight of e^(i angle) in its blend with 1 whose argument is share · angle."""
    ahead, behind = np.sin(share * angle), np.sin((1.0 - share) * angle)
    return np.asarray(ahead / (ahead + behind))
