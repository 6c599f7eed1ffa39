"""The interface of energies, and a base class from which a new one needs its value, gradient and Hessian only.

>>> import numpy as np
>>> from dataclasses import dataclass
>>> from nestedcages_core.energies import Blocks, CageEnergy
>>> @dataclass(frozen=True)
... class Springs(CageEnergy):
...     "½ k Σ |b - a|² over the edges a → b."
...     k: float = 1.0
...     def value(self, vertices, successor):
...         return 0.5 * self.k * float(((vertices[successor] - vertices) ** 2).sum())
...     def gradient(self, vertices, successor):
...         pull = self.k * (vertices - vertices[successor])
...         gradient = pull.copy()
...         gradient[successor] -= pull
...         return gradient
...     def hessian(self, vertices, successor):
...         vertex, eye = np.arange(len(successor)), np.broadcast_to(np.eye(2), (len(successor), 2, 2))
...         return Blocks.sum([(2.0 * self.k, Blocks(vertex, vertex, eye)), (-self.k, Blocks(vertex, successor, eye))])
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar, Protocol

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from .blocks import Blocks


class Energy(Protocol):
    """A choice of energy, made before the cage is known. Unit: length², as of an area."""

    def at(self, coarse: Mesh) -> CageEnergy:
        """The energy of a cage whose rest shape is the coarse mesh."""
        ...


class CageEnergy(ABC):
    """An energy of the cage's vertices (m, 2), joined by edges from each vertex v to successor[v] (m,).

    Energies without a rest shape are their own choice; those without memory of the steps are their own successors.
    """

    is_area: ClassVar[bool] = False
    """Whether it is the area of the cage and nothing else."""

    def at(self, coarse: Mesh) -> CageEnergy:
        """The energy of a cage whose rest shape is the coarse mesh."""
        return self

    def after(self, cage: FloatArray) -> CageEnergy:
        """The energy of the next step, which starts with the cage's vertices (m, 2)."""
        return self

    def with_area(self, measure: CageEnergy) -> CageEnergy:
        """The energy with another measure in the place of the area of the cage, if that is a part of it."""
        return self

    @abstractmethod
    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """The energy; infinite where the cage is invalid."""

    def on_edge(self, vertex: int, start: FloatArray, end: FloatArray) -> FloatArray:
        """(K,) the terms that belong to one edge, or to its first vertex, for places (K, 2) of its two ends."""
        return np.zeros(len(start))

    @abstractmethod
    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2) first derivative."""

    @abstractmethod
    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Exact second derivative, which may be indefinite."""

    def projected_hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """A positive semi-definite matrix no less than the Hessian: its blocks without their negative eigenvalues."""
        return self.hessian(vertices, successor).projected()
