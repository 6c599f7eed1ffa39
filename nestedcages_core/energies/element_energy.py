"""An energy from a formula for one element: derivatives and their assembly come from automatic differentiation.

A new energy in ten lines, edges that keep their lengths, beside the area:

>>> import numpy as np
>>> from nestedcages_core import Area, ElementEnergy, Mesh, Settings, WeightedSum, nested_cages
>>> def stretch(now, rest):
...     (start, end), (start_before, end_before) = now, rest
...     return ((end - start).length() - (end_before - start_before).length()) ** 2
>>> energy = WeightedSum(((1.0, Area()), (5.0, ElementEnergy.per_edge(stretch))))
>>> angle = 2.0 * np.pi * np.arange(60) / 60
>>> disc = Mesh.from_loops([np.stack([np.cos(angle), np.sin(angle)], axis=1)])
>>> nested_cages(disc, [8], Settings(energy=energy)).levels[0].report.strict
True
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from .assembly import add_up, blocks_of, positive_part
from .autodiff import Jet, Number, Point, plain_points_of, points_of
from .base import Blocks

Corners: TypeAlias = tuple[Point, ...]
"""The k corners of all E elements; the coordinates of a corner are jets or arrays (E,)."""

Formula: TypeAlias = Callable[[Corners, Corners], Number]
"""f(now, rest): one number per element from its k corners now and in the coarse mesh; lengths in bounding-box diagonals
of the fine mesh."""


@dataclass(frozen=True)
class ElementEnergy:
    """Σ f(corners) over elements of a few vertices each, for any formula f."""

    elements: Callable[[Mesh], IntArray]
    """The corners (E, k) of the elements of a coarse mesh: any choice of its vertices."""
    formula: Formula

    @classmethod
    def per_vertex(cls, formula: Formula) -> ElementEnergy:
        """Elements of one vertex each."""
        return cls(lambda mesh: np.arange(len(mesh.vertices))[:, None], formula)

    @classmethod
    def per_edge(cls, formula: Formula) -> ElementEnergy:
        """Elements of an edge each: its start and its end, the solid on its left."""
        return cls(lambda mesh: np.stack([np.arange(len(mesh.vertices)), mesh.successor], axis=1), formula)

    @classmethod
    def per_turn(cls, formula: Formula) -> ElementEnergy:
        """Elements of a vertex with its two neighbours: the one before, itself, the one after."""
        return cls(
            lambda mesh: np.stack([mesh.predecessor, np.arange(len(mesh.vertices)), mesh.successor], axis=1), formula
        )

    def at(self, coarse: Mesh) -> BoundElementEnergy:
        """The energy of a cage that starts as the coarse mesh."""
        corners = self.elements(coarse)
        return BoundElementEnergy(corners, plain_points_of(coarse.vertices[corners]), self.formula)


@dataclass(frozen=True, eq=False)
class BoundElementEnergy:
    """An element energy of a given cage; see :class:`nestedcages_core.energies.base.CageEnergy`."""

    corners: IntArray
    """(E, k)."""
    rest: Corners
    """The corners in the coarse mesh."""
    formula: Formula

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """The sum over the elements, without derivatives; infinite where the formula has no value."""
        with np.errstate(divide="ignore", invalid="ignore"):
            values = np.asarray(self.formula(plain_points_of(vertices[self.corners]), self.rest), np.float64)
        total = float(values.sum())
        return total if np.isfinite(total) else float("inf")

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2)."""
        forces = self._jet(vertices).gradient
        return add_up(self.corners, forces.reshape(*self.corners.shape, 2), len(vertices))

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Exact."""
        return blocks_of(self.corners, self._jet(vertices).hessian)

    def projected_hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Each element's Hessian without its negative eigenvalues."""
        return blocks_of(self.corners, positive_part(self._jet(vertices).hessian))

    def after(self, cage: FloatArray) -> BoundElementEnergy:
        """Itself: formulas do not see steps."""
        return self

    def _jet(self, vertices: FloatArray) -> Jet:
        """f of every element with its derivatives."""
        jet = self.formula(points_of(vertices[self.corners]), self.rest)
        if not isinstance(jet, Jet):
            raise TypeError("The formula of an energy must depend on the corners as they are now.")
        return jet
