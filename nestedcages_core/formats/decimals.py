"""Few decimals: written exactly as certified or not at all."""

from __future__ import annotations

from collections.abc import Iterable
from decimal import Context, Decimal

import numpy as np

from ..errors import NestedCagesError, invalid_file
from ..geometry.lattice import Grid
from ..geometry.mesh import Mesh
from ..geometry.vectors import format_point

MAX_DECIMALS = 15
"""Maximum number of decimals that every double can have."""

ENOUGH_DIGITS = Context(prec=60)
"""Digits for sums of decimals: enough for two doubles of comparable size."""


def check_decimals(meshes: Iterable[Mesh], decimals: int | None) -> None:
    """Raise NestedCagesError if a vertex has more decimals, since rounding would invalidate the certificate."""
    if decimals is None:
        return
    if isinstance(decimals, bool) or not isinstance(decimals, int | np.integer) or not 0 <= decimals <= MAX_DECIMALS:
        raise invalid_file(f"The decimals must be a whole number from 0 to {MAX_DECIMALS}, not {decimals!r}.")
    grid = Grid.of_decimals(int(decimals))
    for mesh in meshes:
        off = (grid.points(grid.places(mesh.vertices)) != mesh.vertices).any(axis=1)
        if off.any() or not grid.resolves(mesh.vertices):
            vertex = int(off.argmax())
            raise NestedCagesError(
                f"Vertex {vertex} at {format_point(mesh.vertices[vertex])} has more than {decimals} decimals, and "
                f"rounding would undo what is certified; make the cage with Settings(grid={grid.spacing:g}).",
                code="numbers.unresolved",
                vertex=vertex,
                place=mesh.vertices[vertex],
            )


def turned_over(mesh: Mesh, height: float) -> Mesh:
    """A mesh with height - y for y, rounded once from decimal arithmetic: few decimals stay few."""
    whole = Decimal(repr(float(height)))
    y = [float(ENOUGH_DIGITS.subtract(whole, Decimal(repr(y)))) for y in mesh.vertices[:, 1].tolist()]
    points = np.stack((mesh.vertices[:, 0], y), axis=1)
    return Mesh.from_loops([points[loop] for loop in mesh.loops])
