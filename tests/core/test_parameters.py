"""Method objects check their parameters when they are made, and say what is allowed."""

from __future__ import annotations

import numpy as np
import pytest

from nestedcages_core import NestedCagesError, RandomSamples, ShapeKeeping
from nestedcages_core.energies.choices import ElementEnergy
from nestedcages_core.published.gurditta_jacobson_2022 import (
    GradientDescent,
    PaperContact,
    PaperFlow,
    PaperWeights,
    Repairs,
    SignedDistanceFlow,
)
from nestedcages_core.published.sacht_2015 import ElTopo
from nestedcages_core.published.sellan_2022 import LevelSet
from nestedcages_core.solver.newton import ProjectedNewton
from nestedcages_core.solver.quadratic_program import InteriorPoint

POSITIVE = {
    InteriorPoint: ("complementarity", "primal", "dual"),
    GradientDescent: ("first_step", "smallest_step"),
    PaperContact: ("d_hat",),
    PaperFlow: ("step",),
    SignedDistanceFlow: ("step",),
    ElTopo: ("proximity", "room", "final_proximity", "first_step", "smallest_step", "still"),
}
NOT_NEGATIVE = {
    ProjectedNewton: ("tolerance",),
    ShapeKeeping: ("strength",),
    PaperWeights: ("restoring", "cages", "barrier"),
}
COUNTS = {  # and the least count
    ProjectedNewton: {"max_iterations": 0},
    InteriorPoint: {"iterations": 0},
    GradientDescent: {"steps": 0},
    PaperFlow: {"limit": 1, "samples": 1},
    SignedDistanceFlow: {"limit": 1},
    ElTopo: {"iterations": 1},
    LevelSet: {"cells": 1},
    RandomSamples: {"samples": 1, "seed": 0, "step": 0},
}
BELOW_ONE = {GradientDescent: ("contraction", "sufficient_decrease")}
FLAGS = {
    GradientDescent: ("refuse_infinite",),
    Repairs: ("parity", "exact_home"),
    PaperContact: ("absolute",),
    PaperFlow: ("exact_parity", "over_length", "absolute"),
    SignedDistanceFlow: ("by_longest_side",),
    LevelSet: ("change_loops",),
}


def each(table: dict) -> pytest.MarkDecorator:
    cases = [(method, name) for method, names in table.items() for name in names]
    return pytest.mark.parametrize(("method", "name"), cases, ids=lambda case: getattr(case, "__name__", case))


def refused(method: type, name: str, value: object, rule: str) -> None:
    with pytest.raises(NestedCagesError) as error:
        method(**{name: value})
    assert str(error.value) == f"{method.__name__}: {name} {rule}, not {value!r}."


@each(POSITIVE)
def test_positive_numbers(method: type, name: str) -> None:
    for value in [0.0, -1.0, np.nan, np.inf, "1", None, True]:
        refused(method, name, value, "must be positive and finite")
    method(**{name: 0.5})


@each(NOT_NEGATIVE)
def test_numbers_from_zero(method: type, name: str) -> None:
    for value in [-1.0, np.nan, np.inf, "1", None, True]:
        refused(method, name, value, "must be finite and at least 0")
    method(**{name: 0})


@each(COUNTS)
def test_counts(method: type, name: str) -> None:
    least = COUNTS[method][name]
    for value in [-1, 1.5, "1", None, True]:
        refused(method, name, value, f"must be a whole number of at least {least}")
    method(**{name: np.int64(least)})


@each(BELOW_ONE)
def test_numbers_below_one(method: type, name: str) -> None:
    for value in [0.0, 1.0, -0.1, np.nan, None]:
        refused(method, name, value, "must be above 0 and below 1")
    method(**{name: 0.3})


@each(FLAGS)
def test_flags(method: type, name: str) -> None:
    for value in [1, "yes", None]:
        refused(method, name, value, "must be True or False")
    method(**{name: True})


@pytest.mark.parametrize("name", ["elements", "formula"])
def test_functions(name: str) -> None:
    functions = {"elements": len, "formula": len, name: 3}
    with pytest.raises(NestedCagesError, match=f"ElementEnergy: {name} must be a function, not 3"):
        ElementEnergy(**functions)
