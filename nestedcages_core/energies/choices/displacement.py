"""Displacement of the cage from the coarse mesh, or from the previous step (Sacht et al. 2015, section 4.3)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.mesh import Mesh
from ...geometry.vectors import inner
from ..base import Blocks, CageEnergy


@dataclass(frozen=True)
class InitialDisplacement:
    """½ Σ w |c - c₀|² / L from the coarse mesh c₀; w: boundary length of a vertex, L: mean coarse edge length.

    At a displacement of L the force per boundary length equals the pressure of the area.
    """

    def at(self, coarse: Mesh) -> Displacement:
        """The displacement from the coarse mesh."""
        return Displacement.of(coarse, follows_steps=False)


@dataclass(frozen=True)
class StepDisplacement:
    """½ Σ w |c - c₀|² / L from the cage c₀ at the start of the step: the cage moves no more than it must."""

    def at(self, coarse: Mesh) -> Displacement:
        """The displacement from the coarse mesh, until a step starts elsewhere."""
        return Displacement.of(coarse, follows_steps=True)


@dataclass(frozen=True, eq=False)
class Displacement(CageEnergy):
    """½ Σ w |c - c₀|²: a quadratic energy with a diagonal Hessian."""

    origin: FloatArray
    """(m, 2) c₀."""
    weight: FloatArray
    """(m,) w: boundary length of each vertex over the mean edge length."""
    follows_steps: bool
    """Whether c₀ is the cage at the start of each step."""

    @classmethod
    def of(cls, coarse: Mesh, *, follows_steps: bool) -> Displacement:
        """The displacement from a coarse mesh."""
        lengths = coarse.edge_lengths
        weight = 0.5 * (lengths + lengths[coarse.predecessor]) / float(lengths.mean())
        return cls(coarse.vertices, weight, follows_steps)

    def after(self, cage: FloatArray) -> Displacement:
        """The displacement from the start of the next step, if c₀ follows the steps."""
        return replace(self, origin=cage) if self.follows_steps else self

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """Unit: length²."""
        away = vertices - self.origin
        return 0.5 * inner(self.weight, (away * away).sum(axis=1))

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2)."""
        return self.weight[:, None] * (vertices - self.origin)

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Constant: w on the diagonal."""
        vertex = np.arange(len(self.weight))
        return Blocks(vertex, vertex, self.weight[:, None, None] * np.eye(2))
