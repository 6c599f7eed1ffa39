"""Contact by sequential quadratic programming: fine meshes come home, to the last bit, by motions that meet nothing."""

from __future__ import annotations

import numpy as np
import pytest

from nestedcages_core import ArcLength, Mesh, SequentialQP, TwoSidedFlow
from nestedcages_core.contact import ContactOutcome
from nestedcages_core.contact.contact_response import ContactResponse, Distances, FeasibilityRule
from nestedcages_core.contact.linearisation import measure
from nestedcages_core.contact.pairs import Bodies, find_pairs
from nestedcages_core.solver.quadratic_program import InteriorPoint
from nestedcages_core.tasks import drain, mapped
from support.shapes import annulus, assert_free_of_crossings, assert_nested, letter_a, ring, star


def unit(mesh: Mesh) -> Mesh:
    """The mesh with a diagonal of 1."""
    return mesh.moved(mesh.vertices / mesh.diagonal)


def come_home(
    fine: Mesh, coarse: Mesh, path: list[np.ndarray], contact: SequentialQP | None = None
) -> tuple[ContactOutcome, list[np.ndarray]]:
    """From the first place of the path through the others; all positions on the way.

    The same array yielded again is no step.
    """
    steps = [np.concatenate([coarse.vertices, path[0]])]
    stage = (contact or SequentialQP()).reinflate(Bodies.of(coarse, fine), steps[0], path[1:], clearance=1e-5)

    def record(x: np.ndarray) -> None:
        if x is not steps[-1]:
            steps.append(x)

    return drain(mapped(stage, record)), steps


def flowed(fine: Mesh, count: int) -> tuple[Mesh, list[np.ndarray]]:
    """A coarse mesh on the fine one, and the way back out of it."""
    coarse = ArcLength().decimate(fine, count)
    return coarse, list(drain(TwoSidedFlow().run(fine, coarse)).steps[::-1])


@pytest.mark.parametrize("name", ["annulus", "letter", "star"])
def test_fine_mesh_comes_home_without_a_crossing(name: str) -> None:
    fine = unit({"annulus": annulus(48), "letter": letter_a(3), "star": star(5, 90)}[name])
    coarse, path = flowed(fine, {"annulus": 20, "letter": 40, "star": 16}[name])
    outcome, steps = come_home(fine, coarse, path)
    m = len(coarse.vertices)
    assert outcome.reached_target and outcome.reason == ""
    np.testing.assert_array_equal(steps[-1][m:], fine.vertices)  # bit by bit
    np.testing.assert_array_equal(steps[-1], outcome.x)
    assert_free_of_crossings(coarse, fine, *np.split(np.array(steps), [len(coarse.vertices)], axis=1))
    assert_nested(coarse.moved(outcome.x[:m]), fine)
    assert len(steps) < 30


def test_discs_come_home_in_one_step() -> None:
    fine, coarse = unit(annulus(64)), unit(annulus(16))
    shrunk = fine.vertices * np.where(np.arange(128) < 64, 0.95, 1.05)[:, None]
    outcome, steps = come_home(fine, coarse, [shrunk, fine.vertices])
    assert outcome.reached_target
    assert len(steps) == 2


def test_nothing_to_do_takes_no_step() -> None:
    fine, coarse = unit(annulus(32)), Mesh.from_loops([ring(8, 0.6), ring(8, 0.1)])
    outcome, steps = come_home(fine, coarse, [fine.vertices, fine.vertices])
    assert outcome.reached_target and len(steps) == 1
    np.testing.assert_array_equal(outcome.x[:16], coarse.vertices)


def test_the_recorded_path_leads_where_the_straight_line_is_blocked() -> None:
    """A disc goes around the corner of an L."""
    fine = Mesh.from_loops([0.05 * ring(12)])
    outline = np.array([[-0.2, -0.2], [1.2, -0.2], [1.2, 0.2], [0.2, 0.2], [0.2, 1.2], [-0.2, 1.2]])
    coarse = Mesh.from_loops([outline])
    path = [fine.vertices + np.array(place) for place in ((1, 0), (0.5, 0), (0, 0), (0, 0.5), (0, 1))]
    outcome, steps = come_home(fine.moved(path[-1]), coarse, path, SequentialQP(iterations=40))
    assert outcome.reached_target
    np.testing.assert_array_equal(outcome.x[6:], path[-1])
    assert_free_of_crossings(coarse, fine, *np.split(np.array(steps), [len(coarse.vertices)], axis=1))


def test_what_blocks_the_way_is_said_and_the_last_state_is_valid() -> None:
    """Home is farther away than the cap on the steps allows."""
    fine, coarse = unit(star(5, 90)), unit(Mesh.from_loops([ring(7, 1.2)]))
    inside, far = 0.3 * fine.vertices, np.add(fine.vertices, [50.0, 0.0])
    outcome, steps = come_home(fine, coarse, [inside, far], SequentialQP(iterations=3))
    assert not outcome.reached_target
    assert "fine vertex" in outcome.reason
    assert_free_of_crossings(coarse, fine, *np.split(np.array(steps), [len(coarse.vertices)], axis=1))


@pytest.fixture
def pushed() -> tuple[Bodies, np.ndarray, np.ndarray]:
    """A ring in a coarse one, and its motion outwards through the coarse edges."""
    fine, coarse = Mesh.from_loops([ring(60, 0.9)]), Mesh.from_loops([ring(10, 1.0)])
    return Bodies.of(coarse, fine), np.concatenate([coarse.vertices, fine.vertices]), 0.1 * fine.vertices


def test_the_cage_answers_with_room_for_the_motion(pushed: tuple[Bodies, np.ndarray, np.ndarray]) -> None:
    bodies, x, motion = pushed
    answer = ContactResponse(bodies, Distances(1e-3, 1e-3, 0.02), InteriorPoint()).to(motion, x, 0.3)
    np.testing.assert_array_equal(answer.motion[bodies.m :], motion)
    after = measure(answer.pairs, x + answer.motion)
    assert after.distance.min() > 0.01  # by first order 0.021, less the turning of the edges
    assert np.linalg.norm(answer.motion[: bodies.m], axis=1).max() < 0.2


def test_the_cage_stands_still_where_nothing_comes_near(pushed: tuple[Bodies, np.ndarray, np.ndarray]) -> None:
    bodies, x, motion = pushed
    far = x.copy()
    far[: bodies.m] *= 3.0
    answer = ContactResponse(bodies, Distances(1e-3, 1e-3, 0.02), InteriorPoint()).to(motion, far, 0.3)
    assert np.abs(answer.motion[: bodies.m]).max() < 1e-6


def test_feasible_fractions_leave_distances(pushed: tuple[Bodies, np.ndarray, np.ndarray]) -> None:
    bodies, x, motion = pushed
    through = np.concatenate([np.zeros((bodies.m, 2)), 2.0 * motion])  # the cage does not give way
    pairs = find_pairs(bodies, x, 1.0)
    contacts = measure(pairs, x)
    rule = FeasibilityRule(bodies, 1e-3, 0.02)
    fraction = rule.fraction(pairs, contacts, x, through, 1e-3)
    assert 0.0 < fraction < 1.0
    assert measure(pairs, x + fraction * through).distance.min() > 1e-3
    single = rule.fractions(pairs, contacts, x, through)
    assert measure(pairs, x + single[:, None] * through).distance.min() > 0.0
    assert single[bodies.m :].mean() > fraction  # vertices under the coarse corners may go farther
