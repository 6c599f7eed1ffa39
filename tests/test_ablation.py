"""The ablation switches off mechanisms that are there, and compares what it should."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest

from nestedcages_core import Mesh
from nestedcages_core.tightening import tightening

sys.path.append(str(Path(__file__).resolve().parents[1] / "benchmarks"))  # whose files import each other by name

from ablation import POSITIONS, Case, Made, compare, run, switched_off
from mechanisms import MECHANISMS


def test_what_is_switched_off_is_there_and_comes_back() -> None:
    before = tightening.THINNEST_SKIN
    for mechanism in MECHANISMS.values():
        with switched_off(mechanism.patches):
            pass
        assert mechanism.settings() is not None
        assert before == tightening.THINNEST_SKIN


def test_ratios_are_those_of_cases_with_needles_apart() -> None:
    triangle = Mesh.from_loops([[(0, 0), (1, 0), (0, 1)]])
    chosen = [Case("glyph 1 at 3", triangle, 3), Case("needles 2 at 3", triangle, 3)]
    none = Made(False, float("nan"), 1.0)
    base = [[Made(True, 0.1, 1.0), Made(True, 0.1, 1.0)], [Made(True, 0.1, 1.0)] * 2]
    other = [[Made(True, 0.4, 3.0), Made(True, 0.1, 3.0)], [none, Made(True, 0.3, 2.0)]]
    bought = compare(chosen, base, other)
    assert bought.lost == 1
    assert bought.changed == pytest.approx(2 / 3)
    assert bought.ratios == pytest.approx([2.0], rel=0.01)  # the geometric mean of 4 and 1
    assert bought.needles == pytest.approx([3.0], rel=0.01)
    assert bought.time == pytest.approx(8.0 / 3.0)
    assert bought.row("room", "name").startswith("| room | name | 1 | 67 % | 1.99")


def test_positions_are_rigid_motions_of_the_same_case() -> None:
    triangle = Mesh.from_loops([[(0, 0), (2, 0), (0, 1)]])
    case = Case("triangle", triangle, triangle)
    for position in range(len(POSITIONS)):
        placed = case.placed(position)
        np.testing.assert_allclose(placed.fine.edge_lengths, triangle.edge_lengths)
        assert placed.level == placed.fine
    assert case.placed(0).fine == triangle
    assert run((Case("triangle", triangle, 3).placed(1), None)).certified


def test_what_stays_cites_its_line() -> None:
    """Beside the code stands "See docs/ablation.md: one; another." or "(docs/ablation.md: one)"; variants share it."""
    cited: set[str] = set()
    for path in (Path(__file__).resolve().parents[1] / "nestedcages_core").rglob("*.py"):
        for names in re.findall(r"docs/ablation\.md: ([^)\"]*?)(?:\)|\.\n|\.\")", path.read_text(encoding="utf-8")):
            cited |= {" ".join(name.split()) for name in names.split(";")}
    known = {re.sub(r" \(.*\)$", "", name) for name in MECHANISMS}
    assert {name.removesuffix(": outer hull alone") for name in known if not name.endswith(" together")} == cited
