"""An energy from the formula of one element, with derivatives by automatic differentiation.

For example edges that keep their lengths, added to the area:

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

from ...errors import invalid_setting
from ...geometry.arrays import FloatArray, IntArray
from ...geometry.mesh import Mesh
from ..base import Blocks, CageEnergy, assembled_gradient, assembled_hessian, positive_part
from .autodiff import Jet, Number, Point, plain_points_of, points_of

Corners: TypeAlias = tuple[Point, ...]
"""The k corners of all E elements, with coordinates that are jets or arrays (E,)."""

Formula: TypeAlias = Callable[[Corners, Corners], Number]
"""f(now, rest): one number per element, from its k corners now and in the coarse mesh. Unit of length: the bounding-box
diagonal of the fine mesh."""


@dataclass(frozen=True)
class ElementEnergy:
    """Σ f(now, rest) over elements of a few vertices each, for any formula f."""

    elements: Callable[[Mesh], IntArray]
    """Maps a coarse mesh to the corners (E, k) of the elements, indices of its vertices."""
    formula: Formula
    """f."""

    def __post_init__(self) -> None:
        for name in ("elements", "formula"):
            if not callable(getattr(self, name)):
                raise invalid_setting(f"ElementEnergy: {name} must be a function, not {getattr(self, name)!r}.")

    @classmethod
    def per_vertex(cls, formula: Formula) -> ElementEnergy:
        """One element per vertex."""
        return cls(lambda mesh: np.arange(len(mesh.vertices))[:, None], formula)

    @classmethod
    def per_edge(cls, formula: Formula) -> ElementEnergy:
        """One element per edge: its start and its end, with the solid on the left."""
        return cls(lambda mesh: np.stack([np.arange(len(mesh.vertices)), mesh.successor], axis=1), formula)

    @classmethod
    def per_turn(cls, formula: Formula) -> ElementEnergy:
        """One element per vertex: its predecessor, itself, its successor."""
        return cls(
            lambda mesh: np.stack([mesh.predecessor, np.arange(len(mesh.vertices)), mesh.successor], axis=1), formula
        )

    def at(self, coarse: Mesh) -> BoundElementEnergy:
        """The energy of a cage whose rest shape is the coarse mesh."""
        corners = self.elements(coarse)
        return BoundElementEnergy(corners, plain_points_of(coarse.vertices[corners]), self.formula)


@dataclass(frozen=True, eq=False)
class BoundElementEnergy(CageEnergy):
    """An element energy of one cage."""

    corners: IntArray
    """(E, k)."""
    rest: Corners
    """The corners in the coarse mesh."""
    formula: Formula

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """The sum over the elements; infinite where the formula is not finite."""
        with np.errstate(divide="ignore", invalid="ignore"):
            values = np.asarray(self.formula(plain_points_of(vertices[self.corners]), self.rest), np.float64)
        total = float(values.sum())
        return total if np.isfinite(total) else float("inf")

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2)."""
        gradients = self._jet(vertices).gradient
        return assembled_gradient(self.corners, gradients.reshape(*self.corners.shape, 2), len(vertices))

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Exact."""
        return assembled_hessian(self.corners, self._jet(vertices).hessian)

    def projected_hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Each element's Hessian without its negative eigenvalues."""
        return assembled_hessian(self.corners, positive_part(self._jet(vertices).hessian))

    def _jet(self, vertices: FloatArray) -> Jet:
        """f of each element, with derivatives."""
        jet = self.formula(points_of(vertices[self.corners]), self.rest)
        if not isinstance(jet, Jet):
            raise TypeError("The formula of an energy must depend on the current corners, its first argument.")
        return jet
