"""Method objects check their parameters when they are made, and name the range."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from nestedcages_core import Harmonic, NestedCagesError, OnCurve, OuterHull, OwnDecimation
from nestedcages_core.geometry.triangulation import Sampling

BAD = {
    "restarts 0": (lambda: OuterHull(restarts=0), r"OuterHull: restarts must be a whole number of at least 1, not 0\."),
    "restarts 2.5": (lambda: OuterHull(restarts=2.5), "at least 1, not 2.5"),  # type: ignore[arg-type]
    "seed": (lambda: OuterHull(seed=-1), "OuterHull: seed must be a whole number of at least 0, not -1"),
    "hull": (lambda: OnCurve(hull=8), "OnCurve: hull must be an OuterHull, not 8"),  # type: ignore[arg-type]
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
