"""Displacement of the cage: from the coarse mesh, or from the step before (Sacht et al. 2015, section 4.3)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from .base import Blocks


@dataclass(frozen=True)
class InitialDisplacement:
    """½ Σ w |c - c₀|² / L from the coarse mesh c₀; w: boundary length of a vertex, L: mean coarse edge length.

    A vertex L away from its place weighs as much per length of boundary as the pressure of the area.
    """

    def at(self, coarse: Mesh) -> Displacement:
        """The displacement from the coarse mesh."""
        return Displacement.of(coarse, follows=False)


@dataclass(frozen=True)
class StepDisplacement:
    """The same from where the step begins: the cage gives way as little as it must and forgets where it came from."""

    def at(self, coarse: Mesh) -> Displacement:
        """The displacement from the coarse mesh, until a step begins elsewhere."""
        return Displacement.of(coarse, follows=True)


@dataclass(frozen=True, eq=False)
class Displacement:
    """½ Σ w |c - place|²: a quadratic energy whose Hessian is diagonal."""

    place: FloatArray
    """(m, 2) where the vertices belong."""
    weight: FloatArray
    """(m,) boundary length of each vertex over the mean edge length."""
    follows: bool
    """Whether the place is that at the beginning of each step."""

    @classmethod
    def of(cls, coarse: Mesh, *, follows: bool) -> Displacement:
        """The displacement from a coarse mesh."""
        lengths = coarse.edge_lengths
        weight = 0.5 * (lengths + lengths[coarse.predecessor]) / float(lengths.mean())
        return cls(coarse.vertices, weight, follows)

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """Unit: length²."""
        away = vertices - self.place
        return 0.5 * float(self.weight @ (away * away).sum(axis=1))

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2)."""
        return self.weight[:, None] * (vertices - self.place)

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Constant: w on the diagonal."""
        vertex = np.arange(len(self.weight))
        return Blocks(vertex, vertex, self.weight[:, None, None] * np.eye(2))

    def projected_hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """The Hessian itself, which is positive definite."""
        return self.hessian(vertices, successor)

    def after(self, cage: FloatArray) -> Displacement:
        """From where the next step begins, if the place follows the steps."""
        return replace(self, place=cage) if self.follows else self
