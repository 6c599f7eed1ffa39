"""Method objects check their parameters and parts when they are made."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import IPC, Area, ElementEnergy, PaperContact, SequentialQP, Tightening
from support.judging import rejected

NO_NUMBERS = [np.nan, np.inf, "1", None, True]
POSITIVE = [0.0, -1.0, *NO_NUMBERS], 0.5
NOT_NEGATIVE = [-1.0, *NO_NUMBERS], 0
BELOW_ONE = [0.0, 1.0, -0.1, np.nan, None], 0.3
FLAG = [1, "yes", None], True


def count(least: int) -> tuple[list[Any], Any]:
    return [least - 1, 1.5, "1", None, True], np.int64(least)


RULES: dict[type, dict[str, tuple[list[Any], Any]]] = {  # of each parameter, what is refused and what is taken
    core.InteriorPoint: {"complementarity": POSITIVE, "primal": POSITIVE, "dual": POSITIVE, "iterations": count(0)},
    core.ProjectedNewton: {"tolerance": NOT_NEGATIVE, "max_iterations": count(0)},
    SequentialQP: {"gap": POSITIVE, "stride": POSITIVE, "iterations": count(1)},
    IPC: {**dict.fromkeys(("barrier_range", "restoring", "barrier", "stride"), POSITIVE), "cages": NOT_NEGATIVE},
    Tightening: {
        **dict.fromkeys(("first_radius", "largest_radius"), POSITIVE),
        **dict.fromkeys(("least_gain", "apart"), NOT_NEGATIVE),
        "iterations": count(0),
    },
    core.TwoSidedFlow: {
        **dict.fromkeys(("margin", "spacing", "smoothing", "longest_step"), POSITIVE),
        **dict.fromkeys(("vertex_limit", "limit"), count(1)),
    },
    core.ShapeKeeping: {"strength": NOT_NEGATIVE},
    core.GradientDescent: {
        **dict.fromkeys(("first_step", "smallest_step"), POSITIVE),
        **dict.fromkeys(("contraction", "sufficient_decrease"), BELOW_ONE),
        "steps": count(0),
        "refuse_infinite": FLAG,
    },
    PaperContact: {"d_hat": POSITIVE, "absolute": FLAG},
    core.PaperFlow: {
        "step": POSITIVE,
        "limit": count(1),
        "samples": count(1),
        **dict.fromkeys(("exact_parity", "over_length", "absolute"), FLAG),
    },
    core.PaperWeights: dict.fromkeys(("restoring", "cages", "barrier"), NOT_NEGATIVE),
    core.Repairs: {"parity": FLAG, "exact_home": FLAG},
    core.Harmonic: dict.fromkeys(("spacing", "at_corners"), ([0.0, 2.0, -1.0, np.nan], 1.0)),
}
CASES = [(method, name, *rule) for method, rules in RULES.items() for name, rule in rules.items()]


@pytest.mark.parametrize(("method", "name", "wrong", "right"), CASES, ids=[f"{c[0].__name__} {c[1]}" for c in CASES])
def test_parameters_are_checked(method: type, name: str, wrong: list[Any], right: Any) -> None:
    for value in wrong:
        with rejected("setting.invalid"):
            method(**{name: value})
    method(**{name: right})


PARTS: list[tuple[type, str]] = [
    (IPC, "solver"), (IPC, "energy"), (SequentialQP, "quadratic_programs"), (Tightening, "solver"),
    (PaperContact, "solver"), (PaperContact, "energy"),
]  # fmt: skip
OTHERS: list[Callable[[Any], object]] = [
    lambda part: core.OnCurve(around=part),
    lambda part: core.OwnDecimation(part),
    lambda part: ElementEnergy(elements=part, formula=len),
    lambda part: ElementEnergy(elements=len, formula=part),
]


@pytest.mark.parametrize("wrong", ["AREA", None, 1.0, [1], Area], ids=["text", "none", "number", "list", "class"])
def test_parts_of_a_wrong_kind_are_rejected(wrong: Any) -> None:
    for method, name in PARTS:
        with rejected("setting.invalid"):
            method(**{name: wrong})
    for make in OTHERS if wrong is not Area else ():
        with rejected("setting.invalid"):
            make(wrong)
