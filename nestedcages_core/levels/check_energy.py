"""What an energy must obey, tried out on cages."""

from __future__ import annotations

import numpy as np

from ..energies import CageEnergy, Energy
from ..errors import NestedCagesError
from ..geometry.arrays import FloatArray, IntArray
from .check_decimation import shapes
from .nested_cages import nested_cages

TRIED, SHAKEN = 4, 0.1
"""Number of cages that are tried next to a coarse mesh, and how far their vertices are from its, in mean edges."""

STEP, ACCURACY = 1e-5, 1e-5
"""Motion of vertices for finite differences, in mean edges, and the relative error that these may have."""


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
    coarse, random = nested_cages(star, 12)[0].cage, np.random.default_rng(0)
    unit, successor = float(coarse.edge_lengths.mean()), coarse.successor
    at_rest = energy.at(coarse)
    for _ in range(TRIED):
        cage = coarse.vertices + SHAKEN * unit * random.uniform(-1.0, 1.0, coarse.vertices.shape)
        given = cage.copy()
        for bound in (at_rest, at_rest.after(cage)):
            problem = _problem(bound, cage, successor, unit, random)
            if problem:
                raise _wrong(energy, problem)
        if not np.array_equal(cage, given):
            raise _wrong(energy, "changes the vertices that it is asked about")
    if np.isnan(at_rest.value(np.zeros_like(coarse.vertices), successor)):
        raise _wrong(energy, "is NaN where all vertices are in one place")
    nested_cages(star, 12, energy=energy)  # certifies the cage, or raises


def _problem(bound: CageEnergy, cage: FloatArray, successor: IntArray, unit: float, random: np.random.Generator) -> str:
    """What is wrong with the value and the derivatives of an energy at a cage (m, 2); nothing: ""."""
    value, gradient = bound.value(cage, successor), bound.gradient(cage, successor)
    if not np.isfinite(value) or value != bound.value(cage, successor):
        return f"has the value {value!r} next to its rest shape, or another one each time"
    if gradient.shape != cage.shape or not np.isfinite(gradient).all():
        return f"must have a finite gradient of the shape {cage.shape}, not {gradient.shape}"
    hessian, projected = (
        blocks.dense(len(cage)) for blocks in (bound.hessian(cage, successor), bound.projected_hessian(cage, successor))
    )
    step = STEP * unit * random.uniform(-1.0, 1.0, cage.shape)
    ahead, behind, slope = cage + step, cage - step, 2.0 * float((gradient * step).sum())
    change = bound.value(ahead, successor) - bound.value(behind, successor)
    if abs(change - slope) > ACCURACY * float(np.abs(gradient * step).sum() + STEP * unit**2):
        return f"has a gradient that is not the derivative of its value, which changes by {change:.6g}, not {slope:.6g}"
    changes = (bound.gradient(ahead, successor) - bound.gradient(behind, successor)).ravel()
    if np.abs(changes - 2.0 * hessian @ step.ravel()).max() > ACCURACY * (np.abs(hessian) @ np.abs(step.ravel())).max():
        return "has a Hessian that is not the derivative of its gradient"
    for matrix, what in ((projected, "positive semi-definite"), (projected - hessian, "at least the Hessian")):
        if np.linalg.eigvalsh(matrix).min() < -ACCURACY * max(1.0, float(np.abs(matrix).max())):
            return f"has a projected Hessian that is not {what}"
    return ""


def _wrong(energy: Energy, what: str) -> NestedCagesError:
    return NestedCagesError(f"{type(energy).__name__} {what}.", code="method.wrong", name=type(energy).__name__)
