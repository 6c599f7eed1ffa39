"""What methods written elsewhere must obey, tried out on some shapes."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from ..constraints.base import Bound, Constraint, terms_of
from ..constraints.checked import checked, wrong
from ..decimation import Decimation, Starts
from ..decimation.base import Count
from ..energies import CageEnergy, Energy
from ..errors import NestedCagesError, NestingError
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh, MeshLike
from .nested_cages import nested_cages
from .units import SolverUnits

COUNT = 12
"""Vertices of cages that are made."""

TRIED, SHAKEN = 8, 0.05
"""Number of cages that are tried next to one, and how far their vertices are from its, in mean edges."""

STEP, ACCURACY = 1e-5, 1e-5
"""Motion of vertices for finite differences of energies, in mean edges, and the relative error that these may have."""

ROW_STEP, ROW_ACCURACY, CURVED = 1e-6, 1e-4, 10.0
"""The same for rows, and their error per room, in mean edges: rows are exact at the limit, where the room is 0."""


def shapes() -> dict[str, Mesh]:
    """A star, a ring and two parts."""

    def ring(size: int, radius: float, x: float = 0.0, dent: float = 0.0) -> FloatArray:
        angle = 2.0 * np.pi * np.arange(size) / size
        away = radius * (1.0 + dent * np.cos(5.0 * angle + 0.3))
        return np.stack([x + away * np.cos(angle), away * np.sin(angle)], axis=1)

    return {
        "a star": Mesh.from_loops([ring(60, 1.0, dent=0.3)]),
        "a ring": Mesh.from_loops([ring(40, 1.0), ring(30, 0.5, 0.1)]),
        "two parts": Mesh.from_loops([ring(40, 1.0), ring(50, 0.8, 2.5, dent=0.1)]),
    }


def check_decimation(decimation: Decimation) -> None:
    """Try out that a decimation obeys what `nested_cages` relies on.

    For a star, a ring and two parts it makes meshes of several total numbers of vertices, and of numbers per loop. Each
    must be a valid `Mesh` with one loop for each loop of the shape, in its order and direction, and at most as many
    vertices as wanted; the same call must make the same mesh, and leave the shape as it is. Too few vertices must raise
    `NestingError`. A decimation may raise it elsewhere too, but must make a mesh for each shape. At last it starts a
    cage.

    Parameters
    ----------
    decimation : Decimation
        An object with the method ``decimate(fine, count, *, clearance)``, such as ``LineCycles()``.

    Raises
    ------
    NestedCagesError
        With a sentence that says what it does otherwise, and for which shape and number.

    Examples
    --------
    >>> import nestedcages_core as core
    >>> core.check_decimation(core.ArcLength())
    """
    for name, fine in shapes().items():
        sizes = [len(loop) for loop in fine.loops]
        counts: list[Count] = [6 * len(sizes), 9 * len(sizes), [max(3, size // 2) for size in sizes]]
        made = [_try_decimation(decimation, name, fine, count) for count in counts]
        _require(any(made), decimation, f"makes no mesh around {name}")
        with suppress(NestingError):
            decimation.decimate(fine, 3 * len(sizes) - 1)
            _require(
                False, decimation, f"makes a mesh of {3 * len(sizes) - 1} vertices around {name}, less than 3 a loop"
            )
    nested_cages(shapes()["a star"], COUNT, decimation=decimation, fallback=None)  # certifies the cage, or raises


def _try_decimation(decimation: Decimation, name: str, fine: Mesh, count: Count) -> bool:
    """Whether there is a mesh for a number of vertices. Raises NestedCagesError where it is not as it must be."""
    before = fine.vertices.copy()
    try:
        meshes = [decimation.decimate(fine, count, clearance=0.0)]
        again = decimation.decimate(fine, count)
        if isinstance(decimation, Starts):
            meshes += [start.coarse for start in decimation.starts(fine, count, clearance=0.0)]
    except NestingError:
        return False
    where = f"around {name}, for {count} vertices,"
    _require(np.array_equal(fine.vertices, before), decimation, f"{where} changes the shape")
    for mesh in meshes:
        _require(isinstance(mesh, Mesh), decimation, f"{where} makes {mesh!r} instead of a Mesh")
        alike = np.array_equal(mesh.loop_signs, fine.loop_signs)
        _require(alike, decimation, f"{where} makes other loops than the shape has, or in another order")
        _require(len(mesh.vertices) <= int(np.sum(count)), decimation, f"{where} makes {len(mesh.vertices)}")
    same = np.array_equal(meshes[0].vertices, again.vertices)
    _require(same, decimation, f"{where} makes another mesh each time")
    return True


def check_energy(energy: Energy) -> None:
    """Try out that an energy obeys what `nested_cages` relies on.

    Value and derivatives must be finite next to the rest shape. Gradient and Hessian must be those of the value, by
    finite differences; the projected Hessian must be positive semi-definite and no less than the Hessian. The same call
    must give the same answer, and leave the vertices as they are. Of a cage whose vertices are all in one place the
    value may be infinite, but not NaN. At last it makes a cage.

    Parameters
    ----------
    energy : Energy
        An object with the method ``at(coarse)``, such as ``BoundaryARAP()``.

    Raises
    ------
    NestedCagesError
        With a sentence that says what it does otherwise.

    Examples
    --------
    >>> import nestedcages_core as core
    >>> core.check_energy(core.Area())
    """
    star = shapes()["a star"]
    coarse, random = nested_cages(star, COUNT)[0].cage, np.random.default_rng(0)
    unit, successor = float(coarse.edge_lengths.mean()), coarse.successor
    at_rest = energy.at(coarse)
    for _ in range(TRIED):
        cage = coarse.vertices + SHAKEN * unit * random.uniform(-1.0, 1.0, coarse.vertices.shape)
        before = cage.copy()
        for bound in (at_rest, at_rest.after(cage)):
            _check_derivatives(energy, bound, cage, successor, STEP * unit * random.uniform(-1.0, 1.0, cage.shape))
        _require(np.array_equal(cage, before), energy, "changes the vertices that it is asked about")
    nowhere = at_rest.value(np.zeros_like(coarse.vertices), successor)
    _require(not np.isnan(nowhere), energy, "is NaN where all vertices are in one place")
    nested_cages(star, COUNT, energy=energy)  # certifies the cage, or raises


def _check_derivatives(
    energy: Energy, bound: CageEnergy, cage: FloatArray, successor: IntArray, step: FloatArray
) -> None:
    """Check the value and the derivatives of an energy at a cage (m, 2), by a step (m, 2). Raises NestedCagesError."""
    value, gradient = bound.value(cage, successor), bound.gradient(cage, successor)
    same = bool(np.isfinite(value)) and value == bound.value(cage, successor)
    _require(same, energy, f"has the value {value!r} next to its rest shape, or another one each time")
    finite = gradient.shape == cage.shape and bool(np.isfinite(gradient).all())
    _require(finite, energy, f"must have a finite gradient of the shape {cage.shape}, not {gradient.shape}")
    hessian = bound.hessian(cage, successor).dense(len(cage))
    projected = bound.projected_hessian(cage, successor).dense(len(cage))
    ahead, behind, slope = cage + step, cage - step, 2.0 * float((gradient * step).sum())
    change = bound.value(ahead, successor) - bound.value(behind, successor)
    close = abs(change - slope) <= ACCURACY * float(np.abs(gradient * step).sum() + np.abs(step).max() ** 2 / STEP)
    said = f"has a gradient that is not the derivative of its value, which changes by {change:.6g}, not {slope:.6g}"
    _require(close, energy, said)
    changes = (bound.gradient(ahead, successor) - bound.gradient(behind, successor)).ravel()
    error = np.abs(changes - 2.0 * hessian @ step.ravel()).max()
    close = bool(error <= ACCURACY * (np.abs(hessian) @ np.abs(step.ravel())).max())
    _require(close, energy, "has a Hessian that is not the derivative of its gradient")
    for matrix, what in ((projected, "positive semi-definite"), (projected - hessian, "at least the Hessian")):
        least, largest = np.linalg.eigvalsh(matrix).min(), float(np.abs(matrix).max())
        _require(least >= -ACCURACY * max(1.0, largest), energy, f"has a projected Hessian that is not {what}")


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
        if moved > ROW_ACCURACY * ROW_STEP * fine.diagonal:
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
    ahead, behind = (terms_of([bound], cage + way * ROW_STEP * unit * along, everything)[1] for way in (1.0, -1.0))
    if not ahead.shape == behind.shape == room.shape:
        raise wrong(bound, "rows", "must list the same inequalities for the same radius, next to a cage")
    error = np.abs((ahead - behind) / (2.0 * ROW_STEP * unit) - slopes @ along.ravel()) - CURVED * np.abs(room) / unit
    if error.max(initial=0.0) > ROW_ACCURACY * max(1.0, float(np.abs(slopes).max(initial=0.0))):
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


def _require(valid: bool, method: object, otherwise: str) -> None:
    """Raise NestedCagesError unless something is valid, with what the method does otherwise."""
    if not valid:
        name = type(method).__name__
        raise NestedCagesError(f"{name} {otherwise}.", code="method.wrong", name=name)
