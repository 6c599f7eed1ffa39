"""Reinflation by each contact: the fine mesh returns to the last bit, by motions that meet nothing."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import IPC, ArcLength, FlowResult, Level, Mesh, SequentialQP, Settings, nested_cages
from support.judging import assert_right, codes, rejected
from support.marks import slow_after
from support.shapes import annulus, assert_free_of_crossings, assert_nested, letter_a, ring, star

ONLY_THE_CONTACT = Settings(fallback=None, tightening=core.Tightening(iterations=0))
CONTACTS = {"SQP": SequentialQP(), "IPC": IPC()}
BY_CONTACT = pytest.mark.parametrize("contact", CONTACTS.values(), ids=CONTACTS)


@dataclass(frozen=True)
class Recorded:
    """A flow along places of the whole mesh, relative to where it is, in its own diagonals."""

    places: tuple[tuple[float, float], ...]

    def run(self, fine: Mesh, coarse: Mesh, *, tick: Callable[[float], None]) -> FlowResult:
        tick(0.5)
        steps = fine.vertices + fine.diagonal * np.array(self.places)[:, None]
        return FlowResult(steps, len(steps) - 1, "recorded")


def assert_returns(fine: Mesh, coarse: Mesh, settings: Settings) -> Level:
    (level,) = nested_cages(fine, [coarse], settings)
    way = level.reinflation
    assert level.report.start == "flow"
    assert_right(level)
    assert_free_of_crossings(level.cage, fine, way.cage_steps, way.fine_steps)
    assert_nested(level.cage, fine)
    return level


def on_the_curve(fine: Mesh, count: int) -> tuple[Mesh, Mesh]:
    return fine, ArcLength().decimate(fine, count)


WIDTH = 1e-3
SLIT = [[0, 0], [1, 0], [1, 0.5], [0.5 + WIDTH, 0.5], [0.5, 0.1], [0.5 - WIDTH, 0.5], [0, 0.5]]
WEDGE = [[0.01, 0.01], [0.99, 0.01], [0.99, 0.49], [0.5, 0.05], [0.01, 0.49]]
CASES = {
    "discs": (annulus(60), annulus(16)),
    "letter": on_the_curve(letter_a(3), 40),
    "star": on_the_curve(star(5, 90), 16),
    "a slit much thinner than a barrier": (Mesh.from_loops([SLIT]), Mesh.from_loops([WEDGE])),
    "discs of few vertices": (annulus(16), annulus(16)),
    "discs of many": (annulus(256), annulus(16)),
    "a letter of few vertices": on_the_curve(letter_a(), 12),
}


@pytest.mark.parametrize("case", slow_after(4, CASES))
@BY_CONTACT
def test_the_fine_mesh_returns_and_the_cage_gives_way(contact: Any, case: str) -> None:
    fine, coarse = CASES[case]
    level = assert_returns(fine, coarse, replace(ONLY_THE_CONTACT, contact=contact))
    assert level.report.iterations["reinflation"] > 0
    assert len(level.reinflation.cage_steps) < 40
    assert level.report.clearance > 0.0


@BY_CONTACT
def test_tightened_cages_of_discs_reach_the_optimum_from_either_contact(contact: Any) -> None:
    """Sixteen edges around each ring, which touch them at their middle."""
    fine, coarse = annulus(256), annulus(16)
    level = assert_returns(fine, coarse, Settings(contact=contact, fallback=None))
    touch = 0.5 * np.cos(np.pi / 256) * np.cos(np.pi / 16)  # the hole, between vertices
    assert level.cage.area == pytest.approx(16.0 * np.tan(np.pi / 16) * (1.0 - touch**2), rel=2e-4)


@pytest.mark.parametrize("contact", [SequentialQP(iterations=40), SequentialQP(), IPC()])
def test_the_recorded_path_leads_where_the_straight_line_is_blocked(contact: Any) -> None:
    """A disc goes around the corner of an L."""
    outline = np.array([[-0.2, -0.2], [1.2, -0.2], [1.2, 0.2], [0.2, 0.2], [0.2, 1.2], [-0.2, 1.2]])
    fine = Mesh.from_loops([0.05 * ring(12, centre=(0.0, 20.0))])
    corner = np.array([(0, 1), (0, 0.5), (0, 0), (0.5, 0), (1, 0)]) - (0, 1)
    flow = Recorded(tuple(map(tuple, corner / fine.diagonal)))
    level = assert_returns(fine, Mesh.from_loops([outline]), replace(ONLY_THE_CONTACT, contact=contact, flow=flow))
    assert np.array_equal(level.flow.steps[0], fine.vertices)
    assert level.flow.steps[-1].mean(axis=0) == pytest.approx((1.0, 0.0), abs=1e-9)


def test_discs_return_in_one_step_and_what_is_home_takes_none() -> None:
    level = assert_returns(annulus(64), annulus(16), replace(ONLY_THE_CONTACT, contact=SequentialQP()))
    assert len(level.reinflation.cage_steps) == 2
    wide = Mesh.from_loops([ring(8, 1.7), ring(8, 0.3)])
    (level,) = nested_cages(annulus(32), [wide], ONLY_THE_CONTACT)
    assert len(level.reinflation.cage_steps) == 1
    assert level.cage == wide


BLOCKED = [SequentialQP(iterations=1), SequentialQP(iterations=3), IPC(solver=core.ProjectedNewton(max_iterations=1))]


@pytest.mark.parametrize("contact", BLOCKED)
def test_what_cannot_return_is_an_error_and_another_contact_or_start_makes_a_cage(contact: Any) -> None:
    fine, coarse = on_the_curve(star(9, 180), 18)
    with rejected("reinflation.blocked", core.ReinflationError) as caught:
        nested_cages(fine, [coarse], replace(ONLY_THE_CONTACT, contact=contact))
    assert list(caught.value.partial) == []
    assert_returns(fine, coarse, replace(ONLY_THE_CONTACT, contact=[contact, SequentialQP(), IPC()]))
    (level,) = nested_cages(fine, [coarse], Settings(contact=contact))
    assert level.report.start != "flow"
    assert "note.start" in codes(level)
    assert core.verify(level.cage, fine, level.report.clearance)
