"""What a constraint must obey, tried out on cages."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from ..constraints.base import Bound, Constraint, terms_of
from ..constraints.checked import checked, wrong
from ..errors import NestingError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh, MeshLike
from .check_decimation import shapes
from .nested_cages import nested_cages
from .units import SolverUnits

TRIED, SHAKEN = 8, 0.05
"""Number of cages that are tried next to one that keeps the constraint, and how far their vertices are from its, in
mean edges."""

STEP, ACCURACY = 1e-6, 1e-4
"""Motion of vertices for finite differences, in mean edges, and the error that these may have."""

CURVED = 10.0
"""Error of rows per room, in mean edges: rows are exact at the limit, where the room is 0."""


def check_constraint(constraint: Constraint, about: MeshLike | None = None, count: int = 12) -> None:
    """Try out that a constraint obeys what `nested_cages` relies on.

    It makes a cage that keeps the constraint, and asks the hooks about cages next to that one. `rows` must hold the
    derivatives of the room that is left, exact at the limit, and list all that motions within the radius can break.
    `short` must be above 0 where rows are missed. A cage that lacks nothing must have no `fault`. What `snapped` has
    moved must stay where it is. The same call must give the same answer.

    Parameters
    ----------
    constraint : Constraint
        What is tried, such as ``Box((-2.0, -2.0), (2.0, 2.0))``.
    about : MeshLike, optional
        A shape with cages that keep it. By default a star of five points around the origin with a radius of 1.3.
    count : int
        Vertices of the cages.

    Raises
    ------
    NestedCagesError
        With a sentence that names the hook and says what it does otherwise, or where there is no such cage.

    Examples
    --------
    >>> import nestedcages_core as core
    >>> core.check_constraint(core.LeastAngle(40.0))
    """
    fine = shapes()["a star"] if about is None else Mesh.of(about)
    placed = checked(constraint, fine, 1, SolverUnits.of(fine))
    with suppress(NestingError):  # others, such as edges along axes, need a start of their own
        _check_next_to(placed, nested_cages(fine, count)[0].cage, fine)
    _check_next_to(placed, nested_cages(fine, count, constraints=[constraint])[0].cage, fine)


def _check_next_to(constraint: Constraint, cage: Mesh, fine: Mesh) -> None:
    """Check the hooks with cages next to a cage of a fine mesh. Raises NestedCagesError."""
    units = SolverUnits.of(fine)
    coarse = units.from_input(cage)
    bound = constraint.bound(coarse, units.from_input(fine), units)
    random, unit = np.random.default_rng(0), float(coarse.edge_lengths.mean())
    for _ in range(TRIED):
        shaken = coarse.vertices + SHAKEN * unit * random.uniform(-1.0, 1.0, coarse.vertices.shape)
        snapped = constraint.snapped(cage, units.to_input(shaken)[None], 1)
        moved = float(np.abs(constraint.snapped(cage, snapped, 1) - snapped).max())
        if moved > ACCURACY * STEP * fine.diagonal:
            raise wrong(constraint, "snapped", f"must leave what it has snapped, but moves it by {moved:.3g}")
        tried = units.points(snapped[0])
        _check_rows(bound, tried, unit, random)
        lacks = type(bound) is Bound or bound.short(tried).any()
        fault = None if lacks else constraint.fault(cage.moved(snapped[0]), fine)
        if fault is not None:
            raise wrong(constraint, "fault", f"must accept a cage that is short of nothing, but says: {fault}")


def _check_rows(bound: Bound, cage: FloatArray, unit: float, random: np.random.Generator) -> None:
    """Check rows and what is short at a cage (m, 2) with edges of a mean length. Raises NestedCagesError."""
    everything = 100.0 * unit
    rows, room = terms_of([bound], cage, everything)
    if not np.array_equal(room, terms_of([bound], cage, everything)[1]):
        raise wrong(bound, "rows", "must answer the same each time")
    slopes = np.concatenate([np.zeros((0, cage.size)), *(group.dense(len(cage)) for group in rows)])
    along = random.uniform(-1.0, 1.0, cage.shape)
    ahead, behind = (terms_of([bound], cage + way * STEP * unit * along, everything)[1] for way in (1.0, -1.0))
    if not ahead.shape == behind.shape == room.shape:
        raise wrong(bound, "rows", "must list the same inequalities for the same radius, next to a cage")
    error = np.abs((ahead - behind) / (2.0 * STEP * unit) - slopes @ along.ravel()) - CURVED * np.abs(room) / unit
    if error.max(initial=0.0) > ACCURACY * max(1.0, float(np.abs(slopes).max(initial=0.0))):
        k = int(error.argmax())
        raise wrong(bound, "rows", f"must be the derivatives of its room: row {k} is off by {error[k]:.3g}")
    lack = bound.short(cage)
    first = 0
    for group in rows:
        missed = room[first : first + group.count] < 0.0
        first += group.count
        if not (lack[group.vertex[:, missed]] > 0.0).all():
            raise wrong(bound, "short", "must be above 0 at the vertices of rows that are missed")
    radius = SHAKEN * unit
    near, _ = terms_of([bound], cage, radius)
    broken = np.flatnonzero(bound.short(cage + radius * along))
    listed = np.concatenate([np.zeros(0, np.int64), *(group.vertex.ravel() for group in near)])
    if type(bound).short is Bound.short and not np.isin(broken, listed).all():
        raise wrong(bound, "rows", "must list all inequalities that motions within the radius can break")
