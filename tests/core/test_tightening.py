"""Tightening: cages at a local optimum, at the clearance, by motions that meet nothing."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from nestedcages_core import Mesh, nested_cages
from nestedcages_core.contact.linearisation import measure
from nestedcages_core.contact.pairs import Bodies, CandidateList, find_pairs
from nestedcages_core.energies import Area
from nestedcages_core.energies.choices import InitialDisplacement
from nestedcages_core.geometry.predicates import BoxTree
from nestedcages_core.geometry.smallest_gap import smallest_gap
from nestedcages_core.solver.quadratic_program import InteriorPoint
from nestedcages_core.tasks import drain, mapped
from nestedcages_core.tightening import Tightening, TighteningOutcome
from nestedcages_core.tightening.reach_clearance import restore, widen
from support.shapes import annulus, assert_free_of_crossings, assert_nested, letter_a, lines, polygon, ring, star

CLEARANCE = 1e-5
"""As a fraction of the diagonal."""


def tighten(
    fine: Mesh, coarse: Mesh, clearance: float | None = None, settings: Tightening | None = None
) -> tuple[TighteningOutcome, list[np.ndarray]]:
    """The outcome, and the cage before and after every step."""
    steps = [coarse.vertices]
    stage = (settings or Tightening()).run(
        Bodies.of(coarse, fine),
        coarse.vertices,
        fine.vertices,
        clearance=CLEARANCE * fine.diagonal if clearance is None else clearance,
        energy=Area(),
    )
    return drain(mapped(stage, steps.append)), steps


def wide_annulus(count: int = 16) -> Mesh:
    """Around annulus(...): outer ring grown, hole shrunk."""
    return Mesh.from_loops([ring(count, 1.15), ring(count, 0.42)])


def wide_letter() -> Mesh:
    """A generous outline of the letter A."""
    outside = polygon(letter_a()).buffer(0.1, join_style="mitre").simplify(0.02)
    return Mesh.from_geometry(outside)


def distance_of(cage: Mesh, fine: Mesh) -> float:
    """By shapely: between the two boundaries."""
    return float(lines(cage.vertices, cage).distance(lines(fine.vertices, fine)))


CASES = {
    "annulus": (annulus(64), wide_annulus()),
    "letter": (letter_a(), wide_letter()),
    "star": (star(7, 140), Mesh.from_loops([ring(20, 1.6)])),
    "triangle": (Mesh.from_loops([ring(30)]), Mesh.from_loops([ring(3, 3.0)])),
}


@pytest.fixture(scope="module", params=CASES)
def case(request: pytest.FixtureRequest) -> tuple[Mesh, Mesh, TighteningOutcome, list[np.ndarray]]:
    fine, coarse = CASES[request.param]
    return fine, coarse, *tighten(fine, coarse)


def test_cage_is_nested_at_the_clearance(case: tuple[Mesh, Mesh, TighteningOutcome, list[np.ndarray]]) -> None:
    fine, coarse, outcome, _ = case
    cage = coarse.moved(outcome.cage)
    assert outcome.converged, outcome.reason
    assert_nested(cage, fine)
    clearance = CLEARANCE * fine.diagonal
    measured = distance_of(cage, fine)
    assert clearance * (1.0 - 1e-9) <= measured <= clearance * 1.01
    assert cage.area < coarse.area


def test_every_instant_of_every_step_is_free_of_crossings(
    case: tuple[Mesh, Mesh, TighteningOutcome, list[np.ndarray]],
) -> None:
    fine, coarse, outcome, steps = case
    np.testing.assert_array_equal(steps[-1], outcome.cage)
    assert_free_of_crossings(coarse, fine, steps, [fine.vertices] * len(steps))


def test_energy_falls_with_every_step(case: tuple[Mesh, Mesh, TighteningOutcome, list[np.ndarray]]) -> None:
    _, coarse, _, steps = case
    areas = [coarse.moved(step).area for step in steps]
    assert all(after < before for before, after in itertools.pairwise(areas[1:]))


def test_edges_are_flush_or_touch_at_their_middle(
    case: tuple[Mesh, Mesh, TighteningOutcome, list[np.ndarray]],
) -> None:
    """The sign of a local optimum: the contacts of a free edge lie on both sides of its midpoint, or at it."""
    fine, coarse, outcome, _ = case
    bodies = Bodies.of(coarse, fine)
    x = np.concatenate([outcome.cage, fine.vertices])
    clearance = CLEARANCE * fine.diagonal
    pairs = find_pairs(bodies, x, 1.2 * clearance)
    contacts = measure(pairs, x)
    held = set(pairs.point[pairs.cage_fine][contacts.on_line[pairs.cage_fine]].tolist())
    held |= set(pairs.start[~contacts.on_line].tolist()) | set(pairs.end[~contacts.on_line].tolist())
    balanced = free = 0
    for edge in range(bodies.m):
        if {edge, int(bodies.cage.successor[edge])} & held:
            continue
        touching = (pairs.start == edge) & (pairs.point >= bodies.m) & contacts.on_line
        t = contacts.parameter[touching]
        free += 1
        balanced += len(t) > 0 and t.min() < 0.52 and t.max() > 0.48
    assert free > 0
    assert balanced >= 0.9 * free


def test_annulus_reaches_the_known_optimum() -> None:
    """16 vertices around each of two rings of 256: edges touch at their middle, on the circles' own polygons."""
    fine, coarse = annulus(256), wide_annulus()
    outcome, _ = tighten(fine, coarse)
    clearance = CLEARANCE * fine.diagonal
    touch = np.pi / 256  # where an edge touches: at a vertex of the outer ring, between vertices of the hole
    outer = 16 * np.tan(np.pi / 16) * (1.0 + clearance) ** 2
    hole = 16 * np.tan(np.pi / 16) * (0.5 * np.cos(touch) * np.cos(np.pi / 16) - clearance) ** 2
    area = coarse.moved(outcome.cage).area
    assert area <= (outer - hole) * (1.0 + 2e-4)
    assert outcome.iterations < 30


def test_wider_clearance_is_kept_too() -> None:
    fine, coarse = CASES["star"]
    outcome, _ = tighten(fine, coarse, 0.05)
    assert outcome.converged
    assert 0.05 * (1.0 - 1e-9) <= distance_of(coarse.moved(outcome.cage), fine) <= 0.05 * 1.001


def test_a_cage_that_is_too_close_is_widened_first() -> None:
    fine = letter_a()
    close = polygon(fine).buffer(1e-6 * fine.diagonal, join_style="mitre")
    coarse = Mesh.from_geometry(close)
    outcome, steps = tighten(fine, coarse, 1e-3)
    assert len(steps) > 1
    assert distance_of(coarse.moved(outcome.cage), fine) >= 1e-3 * (1.0 - 1e-9)


def slit(width: float) -> tuple[Mesh, Mesh]:
    """A block with a slit, and a cage that reaches into it."""
    half = 0.5 * width
    block = [[-1, -1], [1, -1], [1, 1], [half, 1], [half, 0], [-half, 0], [-half, 1], [-1, 1]]
    inner = 0.25 * width
    outline = [[-1.2, -1.2], [1.2, -1.2], [1.2, 1.2], [inner, 1.2], [inner, 0.5], [-inner, 0.5], [-inner, 1.2]]
    return Mesh.from_loops([np.array(block)]), Mesh.from_loops([np.array([*outline, [-1.2, 1.2]])])


def test_walls_of_a_slit_may_come_closer_to_each_other_than_the_clearance() -> None:
    fine, coarse = slit(2.5e-3)
    outcome, _ = tighten(fine, coarse, 1e-3)
    cage = coarse.moved(outcome.cage)
    assert outcome.converged, outcome.reason
    assert_nested(cage, fine)
    assert distance_of(cage, fine) >= 1e-3 * (1.0 - 1e-9)


def test_no_room_for_the_clearance_is_said() -> None:
    fine, coarse = slit(1e-3)
    outcome, steps = tighten(fine, coarse, 1e-3)
    assert not outcome.converged
    assert "no room" in outcome.reason and "vertex" in outcome.reason
    assert_nested(coarse.moved(outcome.cage), fine)
    np.testing.assert_array_equal(steps[-1], outcome.cage)


def test_caps_and_their_reasons() -> None:
    fine, coarse = CASES["star"]
    outcome, steps = tighten(fine, coarse, settings=Tightening(iterations=2))
    assert not outcome.converged and outcome.iterations == 2 and "2 iterations" in outcome.reason
    assert len(steps) <= 3


def test_restoration_brings_back_what_a_turn_took() -> None:
    fine, coarse = Mesh.from_loops([ring(60)]), Mesh.from_loops([ring(8, 1.1)])
    bodies = Bodies.of(coarse, fine)
    x = np.concatenate([coarse.vertices, fine.vertices])
    pairs = find_pairs(bodies, x, 1.0)
    before = measure(pairs, x)
    required = np.full(len(pairs), 1e-2)
    turned = x.copy()
    turned[:8] *= 0.985  # every edge through the shape's edge
    assert measure(pairs, turned, before.side).distance.min() < 1e-2
    restored, contacts = restore(bodies, pairs, turned, required, before.side)
    assert contacts.distance.min() >= 1e-2
    assert np.abs(restored - turned).max() < 0.05
    np.testing.assert_array_equal(restored[8:], x[8:])


@pytest.mark.parametrize(("count", "gap"), [(31, 1e-4), (31, 2e-4), (40, 1e-4)])
def test_parts_of_the_cage_slide_along_each_other(count: int, gap: float) -> None:
    """Between two discs fine vertices hold both parts, which took nearly all steps that are allowed."""
    centre = 1.7 * np.cos(0.3) + gap, 1.7 * np.sin(0.3) + gap
    fine = Mesh.from_loops([ring(count, angle=0.1), ring(count, 0.7, 0.2, centre)])
    report = nested_cages(fine, [8]).levels[0].report
    assert report.excess < 0.28
    assert report.iterations["tightening"] <= 40


def test_widening_shares_what_room_there_is() -> None:
    fine, coarse = slit(2.5e-3)
    bodies = Bodies.of(coarse, fine)
    walls = np.abs(coarse.vertices[:, :1]) < 0.1
    cage = coarse.vertices * np.where(walls, [[1.999, 1.0]], 1.0)  # they almost touch those of the slit
    x = np.concatenate([cage, fine.vertices])
    clearance = 1e-3
    widened = drain(widen(bodies, x, clearance, CandidateList(bodies), InteriorPoint()))
    assert widened.closest == -1
    cage, home = widened.x[: bodies.m], fine.vertices
    boundaries = BoxTree(home, home[bodies.fine.successor]), BoxTree(cage, cage[bodies.cage.successor])
    assert smallest_gap(*boundaries) >= clearance


def test_other_energies_are_minimised_too() -> None:
    """A rest shape that the fine mesh sticks out of: the cage comes as near to it as the clearance allows."""
    fine, rest, coarse = Mesh.from_loops([ring(90)]), Mesh.from_loops([ring(9, 0.9)]), Mesh.from_loops([ring(9, 1.4)])
    stage = Tightening().run(
        Bodies.of(coarse, fine),
        coarse.vertices,
        fine.vertices,
        clearance=1e-3,
        energy=InitialDisplacement().at(rest),
    )
    outcome = drain(stage)
    cage = coarse.moved(outcome.cage)
    assert outcome.converged
    assert_nested(cage, fine)
    assert distance_of(cage, fine) == pytest.approx(1e-3, rel=1e-2)
    radii = np.linalg.norm(outcome.cage, axis=1)
    np.testing.assert_allclose(radii, (1.0 + 1e-3) / np.cos(np.pi / 9), rtol=1e-2)  # edges touch at their middle
