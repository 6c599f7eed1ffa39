"""Cages on certain numbers: the multiples of a length, what float32 can hold, or both."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from math import frexp

import numpy as np

from ...errors import Fault, NestingError
from ...geometry.arrays import FloatArray
from ...geometry.lattice import Grid
from ...geometry.mesh import Mesh
from ...geometry.precision import MOST_ROUNDS
from ...level.plan import EdgeCost, Need, Plan
from ...level.steps import as_stored
from ...tasks import Stage
from .search import put_on_grid

FINER = ("0.5", "0.2", "0.1", "0.05", "0.02", "0.01")
"""Finer grids that are tried for the error message, relative to one without a cage."""

ROUNDING = 0.71
"""Upper bound of the distance from a point to the numbers next to it, in spacings."""


@dataclass(frozen=True)
class Lattice:
    """The multiples of a length, or all doubles, as a type with fewer digits holds them, if there is one."""

    lattice: Grid | None
    stored: str | None
    largest: float
    """Largest coordinate of the drawing, which sets the spacing of the numbers of a type."""
    rounds: int = MOST_ROUNDS
    """Maximum number of improvements of places on a length."""

    @property
    def spacing(self) -> float:
        """Distance between neighbours; without a length that next to twice the largest coordinate."""
        if self.lattice is not None:
            return self.lattice.spacing
        return float(2.0 ** (frexp(2.0 * self.largest)[1] - np.finfo(self.stored or float).nmant - 1))

    @property
    def grid(self) -> float | None:
        """The length."""
        return None if self.lattice is None else self.lattice.spacing

    @property
    def room(self) -> float:
        """What rounding takes at most; cages on multiples of a length are searched with it."""
        return ROUNDING * self.spacing if self.lattice is None else 0.0

    def exact(self, points: FloatArray) -> FloatArray:
        """The multiples that points (..., 2) are next to."""
        return points if self.lattice is None else self.lattice.points(self.lattice.places(points))

    def nearest(self, points: FloatArray) -> FloatArray:
        """The same as they are stored."""
        return as_stored(self.exact(points), self.stored)

    def settled(
        self, cage: Mesh, fine: Mesh, clearance: float, side: int, cost: EdgeCost | None
    ) -> Stage[float, FloatArray | None]:
        """(m, 2) multiples of least cost, searched around the cage; None if none are found. Else its vertices."""
        if self.lattice is None:
            yield 1.0
            return self.nearest(cage.vertices)
        found = yield from put_on_grid(
            cage, fine, self.lattice, clearance=clearance, side=side, edge_cost=cost, rounds=self.rounds
        )
        return None if found is None else as_stored(found, self.stored)

    def hasty(self) -> Lattice:
        """The same, on which places are not improved once there are some."""
        return replace(self, rounds=0)

    def finer(self) -> Iterator[Lattice]:
        """Grids that are finer by usual factors."""
        if self.lattice is not None:
            for part in FINER:
                yield replace(self, lattice=Grid(float(self.lattice.ratio * Fraction(part))))


@dataclass(frozen=True)
class OnNumbers(Need):
    """Cages whose coordinates are certain numbers."""

    numbers: Lattice

    @classmethod
    def of(cls, fine: Mesh, grid: float | None, stored: str | None) -> OnNumbers | None:
        """The need of a grid, the name of a type that stores coordinates, or both; None for neither.

        Raises NestingError.
        """
        largest = float(np.abs(fine.vertices).max())
        if grid is None:
            return None if stored is None else cls(Lattice(None, stored, largest))
        lattice = Grid(grid)
        if not lattice.resolves(fine.vertices):
            raise NestingError(
                f"The grid of {grid:.6g} is finer than floating-point numbers are at these coordinates; "
                "ask for a coarser one, or move the shape closer to the origin.",
                code="numbers.unresolved",
                spacing=grid,
            )
        extent = float(np.ptp(fine.vertices, axis=0).max())
        if grid > extent:
            raise NestingError(
                f"The grid of {grid:.6g} is larger than the drawing, which is {extent:.3g} wide or high: ask for one "
                f"of at most {extent:.3g}.",
                code="numbers.no_room",
                spacing=grid,
            )
        return cls(Lattice(lattice, stored, largest))

    def fill(self, plan: Plan) -> Plan:
        """The numbers."""
        return replace(plan, numbers=self.numbers)

    def fault(self, plan: Plan, cage: Mesh) -> Fault | None:
        """Whether all coordinates are such numbers."""
        numbers = plan.numbers if plan.numbers is not None else self.numbers
        if np.array_equal(numbers.nearest(cage.vertices), cage.vertices):
            return None
        return Fault("The cage is not on the numbers asked for.", "numbers.missed")
