"""Method objects check their parameters when they are made, and name the range."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from nestedcages_core import (
    IPC,
    Area,
    Harmonic,
    LevelSet,
    NestedCagesError,
    OnCurve,
    OwnDecimation,
    SequentialQP,
    Tightening,
)
from nestedcages_core.geometry.triangulation import Sampling
from nestedcages_core.published.gurditta_jacobson_2022 import PaperContact, SignedDistanceFlow
from nestedcages_core.published.sacht_2015 import ElTopo

BAD = {
    "around": (lambda: OnCurve(around=8), "OnCurve: around must be an object such as LineCycles"),  # type: ignore[arg-type]
    "function": (lambda: OwnDecimation([1]), "OwnDecimation: function must be callable"),  # type: ignore[arg-type]
    "spacing": (lambda: Harmonic(spacing=0.0), "Harmonic: spacing must be above 0 and at most 1, not 0.0"),
    "corners": (lambda: Harmonic(at_corners=2.0), "Harmonic: at_corners must be above 0 and at most 1, not 2.0"),
    "nan": (lambda: Harmonic(spacing=float("nan")), "at most 1, not nan"),
    "length": (lambda: Sampling(-1.0), "must be a positive length, not -1.0"),
    "growth": (lambda: Sampling(1.0, growth=-0.5), "Sampling: growth must be finite and at least 0, not -0.5"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_parameters_are_rejected(name: str) -> None:
    make: Callable[[], object]
    make, sentence = BAD[name]
    with pytest.raises(NestedCagesError, match=sentence):
        make()


PARTS = [
    *((IPC, part) for part in ("solver", "energy", "step_filter", "broad_phase")),
    *((PaperContact, part) for part in ("solver", "energy", "step_filter", "broad_phase")),
    (SequentialQP, "quadratic_programs"),
    (ElTopo, "energy"),
    (ElTopo, "final_energy"),
    (SignedDistanceFlow, "quadrature"),
    (LevelSet, "simplification"),
    (Tightening, "solver"),
]


@pytest.mark.parametrize(("method", "part"), PARTS, ids=[f"{method.__name__} {part}" for method, part in PARTS])
@pytest.mark.parametrize("wrong", ["AREA", Area, None, 1.0], ids=["text", "class", "none", "number"])
def test_parts_of_a_wrong_kind_are_rejected(method: type, part: str, wrong: object) -> None:
    with pytest.raises(NestedCagesError, match=rf"^{method.__name__}: {part} must be .*, not "):
        method(**{part: wrong})
