"""Automatic differentiation: its rules against central differences, and against it the closed forms of all energies."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from nestedcages_core import (
    ElementEnergy,
    Mesh,
    NestedCagesError,
    OuterHull,
    Settings,
    nested_cages,
)
from nestedcages_core.energies.base import assembled_hessian, positive_part
from nestedcages_core.energies.choices.autodiff import Jet, plain_points_of, points_of
from support.shapes import ring

STEP = 1e-5  # of central differences; coordinates are of order 1

FORMULAS: dict[str, Callable] = {
    "+": lambda u, v: u + v + 1.5,
    "-": lambda u, v: 2.0 - (u - v) - 0.5,
    "*": lambda u, v: 3.0 * u * v * u,
    "/": lambda u, v: u / v + 1.0 / v + v / 7.0,
    "-u": lambda u, v: -u * +v,
    "u ** 3": lambda u, v: u**3 * v**-1.5,
    "u ** v": lambda u, v: u**v + 2.0**v,
    "square": lambda u, v: np.square(u) * np.reciprocal(v),
    "sqrt": lambda u, v: np.sqrt(u * v),
    "exp": lambda u, v: np.exp(u - v),
    "log": lambda u, v: np.log(u + 2.0 * v),
    "sin": lambda u, v: np.sin(u * v),
    "cos": lambda u, v: np.cos(u) * v,
    "arctan": lambda u, v: np.arctan(u / v),
    "arctan2": lambda u, v: np.arctan2(u - 1.4, v - 1.0) + np.arctan2(u, 2.0) + np.arctan2(-1.0, v),
    "hypot": lambda u, v: np.hypot(u, v) + np.hypot(u, 1.0),
    "abs": lambda u, v: np.abs(u - 1.5) * v,
    "max": lambda u, v: np.maximum(u, v) * np.maximum(u, 1.2),
    "min": lambda u, v: np.minimum(u, v) * np.minimum(1.2, v),
}


@pytest.mark.parametrize("formula", FORMULAS.values(), ids=FORMULAS.keys())
def test_every_rule_agrees_with_differences(formula: Callable) -> None:
    x = np.random.default_rng(5).uniform(0.6, 2.0, size=(20, 2))
    jet = formula(*Jet.unknowns(x))
    assert jet.value == pytest.approx(formula(*x.T), rel=1e-14)
    for axis in (0, 1):
        step = STEP * np.eye(2)[axis]
        ahead, behind = x + step, x - step
        slope = (formula(*ahead.T) - formula(*behind.T)) / (2 * STEP)
        assert jet.gradient[:, axis] == pytest.approx(slope, rel=1e-6, abs=1e-8)
        slopes = formula(*Jet.unknowns(ahead)).gradient - formula(*Jet.unknowns(behind)).gradient
        assert jet.hessian[:, axis] == pytest.approx(slopes / (2 * STEP), rel=1e-5, abs=1e-7)
    assert jet.hessian == pytest.approx(jet.hessian.transpose(0, 2, 1), abs=1e-14)


@pytest.mark.parametrize("power", [0, 1, 2, 3])
def test_small_powers_have_derivatives_at_zero(power: int) -> None:
    (u,) = Jet.unknowns(np.zeros((1, 1)))
    jet = u**power
    assert (jet.value[0], jet.gradient[0, 0], jet.hessian[0, 0, 0]) == (0.0**power, power == 1, 2.0 * (power == 2))


@pytest.mark.parametrize("place", [(1.0, 0.1), (0.1, 1.0), (-1.0, 0.1), (-1.0, -0.1), (-0.1, -1.0), (0.0, 1.0)])
def test_angles_are_right_all_around(place: tuple[float, float]) -> None:
    x, y = Jet.unknowns(np.array([place]))
    angle, squared = np.arctan2(y, x), place[0] ** 2 + place[1] ** 2
    assert angle.value[0] == np.arctan2(place[1], place[0])
    assert angle.gradient[0] == pytest.approx(np.array([-place[1], place[0]]) / squared)
    assert np.trace(angle.hessian[0]) == pytest.approx(0.0, abs=1e-14)  # angles are harmonic


def test_a_function_without_a_rule_is_refused_with_those_that_have_one() -> None:
    (u,) = Jet.unknowns(np.ones((1, 1)))
    with pytest.raises(TypeError, match=r"np\.tanh has no derivative rule; write the energy with np\.absolute"):
        np.tanh(u)
    with pytest.raises(TypeError, match="no derivative rule"):
        u < 1.0  # noqa: B015


def test_points_calculate_with_jets_and_numbers_alike() -> None:
    corners = np.random.default_rng(6).normal(size=(5, 2, 2))
    for a, b in (points_of(corners), plain_points_of(corners)):
        c = 2.0 * (a + b) / 4.0 - b * 0.5
        x, y = (part.value if isinstance(part, Jet) else part for part in (c.x, c.y))
        assert np.stack([x, y], axis=1) == pytest.approx(0.5 * corners[:, 0])


def test_elements_may_meet_themselves() -> None:
    """A cell whose first and last corner are one vertex: its Hessian is that of the function of three vertices."""
    hessian = positive_part(np.random.default_rng(7).normal(size=(1, 8, 8)))
    corners = np.array([[0, 1, 2, 0]])
    gather = np.zeros((8, 6))
    for corner, vertex in enumerate(corners[0]):
        gather[2 * corner : 2 * corner + 2, 2 * vertex : 2 * vertex + 2] = np.eye(2)
    assert assembled_hessian(corners, hessian).dense(3) == pytest.approx(gather.T @ hessian[0] @ gather, abs=1e-13)


def test_the_positive_part_has_no_negative_eigenvalues_and_keeps_the_others() -> None:
    random = np.random.default_rng(8)
    frame = np.linalg.qr(random.normal(size=(4, 4)))[0]
    part = positive_part((frame * [-2.0, -1e-3, 1.0, 3.0] @ frame.T)[None])[0]
    assert part == pytest.approx(frame * [0.0, 0.0, 1.0, 3.0] @ frame.T, abs=1e-14)


# Energies of one's own


@pytest.fixture
def plate() -> Mesh:
    wobble = np.random.default_rng(2).normal(scale=0.02, size=(19, 2))
    return Mesh.from_loops([ring(10, 1.0) + wobble[:10], ring(6, 0.5) + wobble[10:16], ring(3, 0.2) + wobble[16:]])


def test_a_formula_without_a_value_is_infinite(plate: Mesh) -> None:
    inside = ElementEnergy.per_vertex(lambda now, rest: -np.log(2.0 - now[0].dot(now[0]))).at(plate)
    assert np.isfinite(inside.value(plate.vertices, plate.successor))
    assert inside.value(3.0 * plate.vertices, plate.successor) == np.inf


def test_a_formula_must_depend_on_the_corners_as_they_are(plate: Mesh) -> None:
    constant = ElementEnergy.per_vertex(lambda now, rest: rest[0].dot(rest[0])).at(plate)
    with pytest.raises(TypeError, match="must depend on the current corners"):
        constant.gradient(plate.vertices, plate.successor)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("power", [1.0, 1.5], ids=["no slope", "no curvature"])
def test_a_formula_must_have_derivatives_at_the_coarse_mesh(power: float) -> None:
    """Powers of a length where the length is zero, as all are at the start."""
    energy = ElementEnergy.per_vertex(lambda now, rest: (now[0] - rest[0]).length() ** power)
    with pytest.raises(NestedCagesError, match="derivatives that are not finite numbers"):
        nested_cages(Mesh.from_loops([ring(30)]), [8], Settings(decimation=OuterHull(), energy=energy))
