"""The ablation switches off mechanisms that are there, and compares what it should."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

from nestedcages_core import Mesh
from nestedcages_core.tightening import tightening

sys.path.append(str(Path(__file__).resolve().parents[1] / "benchmarks"))  # whose files import each other by name

from ablation import Case, Made, compare, run, switched_off
from mechanisms import MECHANISMS


@pytest.mark.parametrize("name", MECHANISMS)
def test_what_is_switched_off_is_there_and_comes_back(name: str) -> None:
    before = tightening.MAX_ESCAPES
    with switched_off(MECHANISMS[name].patches):
        pass
    assert MECHANISMS[name].settings() is not None
    assert before == tightening.MAX_ESCAPES


def test_lost_cages_and_ratios_are_counted() -> None:
    case = Case("triangle", Mesh.from_loops([[(0, 0), (1, 0), (0, 1)]]), 3)
    with_it = [Made(True, 0.1, 1.0, "flow"), Made(True, 0.1, 1.0, "flow")]
    without = [Made(True, 0.2, 3.0, "outer hull"), Made(False, float("nan"), 1.0, "")]
    bought = compare(with_it, without, [case, case])
    assert (bought.successes, bought.flows, bought.changed, bought.time) == (1, 2, 1, 2.0)
    assert bought.worst == pytest.approx(2.0, rel=0.01)
    assert run((case, None)).certified


def test_what_stays_cites_its_line() -> None:
    """Beside the code stands "See docs/ablation.md: one; another." or "(docs/ablation.md: one)"; variants share it."""
    cited: set[str] = set()
    for path in (Path(__file__).resolve().parents[1] / "nestedcages_core").rglob("*.py"):
        for names in re.findall(r"docs/ablation\.md: ([^)\"]*?)(?:\)|\.\n|\.\")", path.read_text(encoding="utf-8")):
            cited |= {" ".join(name.split()) for name in names.split(";")}
    known = {re.sub(r" \(.*\)$", "", name) for name in MECHANISMS}
    assert {name.removesuffix(": outer hull alone") for name in known} == cited
