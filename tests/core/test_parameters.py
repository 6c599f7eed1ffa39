"""Method objects check their parameters and parts when they are made, and say what is allowed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from nestedcages_core import (
    IPC,
    Area,
    Harmonic,
    NestedCagesError,
    OnCurve,
    OwnDecimation,
    RandomSamples,
    SequentialQP,
    ShapeKeeping,
    Tightening,
)
from nestedcages_core.energies.choices import ElementEnergy
from nestedcages_core.geometry.triangulation import Sampling
from nestedcages_core.published.gurditta_jacobson_2022 import (
    GradientDescent,
    PaperContact,
    PaperFlow,
    PaperWeights,
    Repairs,
    SignedDistanceFlow,
)
from nestedcages_core.solver.newton import ProjectedNewton
from nestedcages_core.solver.quadratic_program import InteriorPoint

POSITIVE = {
    InteriorPoint: ("complementarity", "primal", "dual"),
    GradientDescent: ("first_step", "smallest_step"),
    PaperContact: ("d_hat",),
    PaperFlow: ("step",),
    SignedDistanceFlow: ("step",),
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
    RandomSamples: {"samples": 1, "seed": 0, "step": 0},
}
BELOW_ONE = {GradientDescent: ("contraction", "sufficient_decrease")}
FLAGS = {
    GradientDescent: ("refuse_infinite",),
    Repairs: ("parity", "exact_home"),
    PaperContact: ("absolute",),
    PaperFlow: ("exact_parity", "over_length", "absolute"),
}


NOT_NUMBERS = [np.nan, np.inf, "1", None, True]
RULES: list[tuple[dict, list, object, str]] = [  # of which methods and names, what is refused, what is taken, and why
    (POSITIVE, [0.0, -1.0, *NOT_NUMBERS], 0.5, "must be positive and finite"),
    (NOT_NEGATIVE, [-1.0, *NOT_NUMBERS], 0, "must be finite and at least 0"),
    (BELOW_ONE, [0.0, 1.0, -0.1, np.nan, None], 0.3, "must be above 0 and below 1"),
    (FLAGS, [1, "yes", None], True, "must be True or False"),
    *(
        ({method: (name,)}, [-1, 1.5, "1", None, True], np.int64(least), f"must be a whole number of at least {least}")
        for method, names in COUNTS.items()
        for name, least in names.items()
    ),
]
CASES = [(method, name, *rule) for table, *rule in RULES for method, names in table.items() for name in names]


@pytest.mark.parametrize(
    ("method", "name", "wrong", "right", "rule"), CASES, ids=[f"{c[0].__name__} {c[1]}" for c in CASES]
)
def test_parameters_are_checked(method: type, name: str, wrong: list, right: object, rule: str) -> None:
    for value in wrong:
        with pytest.raises(NestedCagesError) as error:
            method(**{name: value})
        assert str(error.value) == f"{method.__name__}: {name} {rule}, not {value!r}."
    method(**{name: right})


OTHERS: list[tuple[Callable[[], object], str]] = [
    *((lambda name=name: ElementEnergy(**{"elements": len, "formula": len, name: 3}),
       f"ElementEnergy: {name} must be a function, not 3") for name in ("elements", "formula")),
    (lambda: OnCurve(around=8), "OnCurve: around must be an object such as LineCycles"),  # type: ignore[arg-type]
    (lambda: OwnDecimation([1]), "OwnDecimation: function must be callable"),  # type: ignore[arg-type]
    (lambda: Harmonic(spacing=0.0), "Harmonic: spacing must be above 0 and at most 1, not 0.0"),
    (lambda: Harmonic(at_corners=2.0), "Harmonic: at_corners must be above 0 and at most 1, not 2.0"),
    (lambda: Harmonic(spacing=float("nan")), "at most 1, not nan"),
    (lambda: Sampling(-1.0), "must be a positive length, not -1.0"),
    (lambda: Sampling(1.0, growth=-0.5), "Sampling: growth must be finite and at least 0, not -0.5"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "sentence"), OTHERS)
def test_bad_parameters_are_rejected(make: Callable[[], object], sentence: str) -> None:
    with pytest.raises(NestedCagesError, match=sentence):
        make()


PARTS = [
    *((IPC, part) for part in ("solver", "energy")),
    *((PaperContact, part) for part in ("solver", "energy", "step_filter", "broad_phase")),
    (SequentialQP, "quadratic_programs"),
    (SignedDistanceFlow, "quadrature"),
    (Tightening, "solver"),
]


@pytest.mark.parametrize(("method", "part"), PARTS, ids=[f"{method.__name__} {part}" for method, part in PARTS])
@pytest.mark.parametrize("wrong", ["AREA", Area, None, 1.0], ids=["text", "class", "none", "number"])
def test_parts_of_a_wrong_kind_are_rejected(method: type, part: str, wrong: object) -> None:
    with pytest.raises(NestedCagesError, match=rf"^{method.__name__}: {part} must be .*, not "):
        method(**{part: wrong})
