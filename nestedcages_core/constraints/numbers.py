"""Cages on certain numbers: the multiples of a length, what float32 can hold, or both."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import frexp

import numpy as np

from ..energies.base import EdgeCost
from ..errors import Fault, NestingError
from ..geometry.arrays import BoolArray, FloatArray
from ..geometry.lattice import Grid, as_stored
from ..geometry.mesh import Mesh
from ..progress import Tick, no_tick
from .base import Constraint
from .grid_search import Allowed, put_on_grid

ROOMS = (0.8, 64.0)
"""Spacings added to the clearance where a cage does not fit on the numbers, tried in turn. The nearest point is at most
0.71 spacings away, so even plain rounding then keeps the clearance; it may still close gaps between parts of the cage.
"""

FARTHEST_NUMBER = 0.71
"""Upper bound of the distance from a point to the numbers next to it, in spacings."""


@dataclass(frozen=True)
class Numbers(Constraint):
    """Cages whose coordinates are multiples of a length, or any doubles, as a type with fewer digits holds them."""

    is_rule = False
    settles = True

    lattice: Grid | None
    stored: str | None
    largest: float
    """Largest coordinate of the drawing, which sets the spacing of the numbers of a type."""

    @classmethod
    def about(cls, drawing: Mesh, grid: float | None, stored: str | None) -> Numbers:
        """The numbers of a grid, of the type with a name, or both. Raises NestingError."""
        largest = float(np.abs(drawing.vertices).max())
        if grid is None:
            return cls(None, stored, largest)
        lattice = Grid(grid)
        if not lattice.resolves(drawing.vertices):
            raise NestingError(
                f"The grid of {grid:.6g} is finer than floating-point numbers are at these coordinates; "
                "ask for a coarser one, or move the shape closer to the origin.",
                code="numbers.unresolved",
                spacing=grid,
            )
        extent = float(np.ptp(drawing.vertices, axis=0).max())
        if grid > extent:
            raise NestingError(
                f"The grid of {grid:.6g} is larger than the drawing, which is {extent:.3g} wide or high: ask for one "
                f"of at most {extent:.3g}.",
                code="numbers.no_room",
                spacing=grid,
            )
        return cls(lattice, stored, largest)

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
        """What rounding takes at most, which all cages have in reserve; those on a grid are searched with it."""
        return FARTHEST_NUMBER * self.spacing if self.lattice is None else 0.0

    @property
    def rooms(self) -> tuple[float, ...]:
        """Distances to keep in addition to the clearance until a cage moves onto the numbers, to try in turn.

        A grid has points farther away only where those of the type that stores it are farther apart.
        """
        coarse = replace(self, lattice=None).spacing if self.stored else 0.0
        if self.grid is None or coarse > self.grid:
            return tuple(room * (coarse or self.spacing) for room in ROOMS)
        return (ROOMS[0] * self.spacing,)

    def exact(self, points: FloatArray) -> FloatArray:
        """The multiples that points (..., 2) are next to."""
        return points if self.lattice is None else self.lattice.points(self.lattice.places(points))

    def nearest(self, points: FloatArray) -> FloatArray:
        """The same as they are stored."""
        return as_stored(self.exact(points), self.stored)

    def settled(
        self,
        cage: Mesh,
        fine: Mesh,
        clearance: float,
        side: int,
        allowed: Allowed | None,
        cost: EdgeCost | None,
        tick: Tick = no_tick,
    ) -> tuple[FloatArray | None, BoolArray]:
        """(m, 2) multiples of least cost, searched around the cage; None if none are found. Else its vertices.

        And (m,) the vertices at which edges have no place.
        """
        if self.lattice is None:
            return self.nearest(cage.vertices), np.zeros(len(cage.vertices), bool)
        found, stuck = put_on_grid(
            cage,
            fine,
            self.lattice,
            allowed,
            clearance=clearance,
            side=side,
            edge_cost=cost,
            tick=tick,
        )
        return None if found is None else as_stored(found, self.stored), stuck

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        """Whether all coordinates are such numbers."""
        if np.array_equal(self.nearest(cage.vertices), cage.vertices):
            return None
        return Fault("The cage is not on the numbers asked for.", "numbers.missed")
