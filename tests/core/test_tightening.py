"""Tightening: cages at a local optimum, at the clearance, by motions that meet nothing."""

import itertools

import numpy as np
import pytest
import shapely

from nestedcages_core import InitialDisplacement, Level, Mesh, NestingError, Settings, Tightening, nested_cages
from support.judging import assert_right, codes, gap, rejected
from support.shapes import annulus, assert_free_of_crossings, assert_nested, letter_a, lines, polygon, ring, star

CLEARANCE = 1e-5
"""The default, as a fraction of the diagonal."""

WIDE_ANNULUS = Mesh.from_loops([ring(16, 1.15), ring(16, 0.42)])
CASES = {
    "annulus": (annulus(64), WIDE_ANNULUS),
    "letter": (letter_a(), Mesh.from_geometry(polygon(letter_a()).buffer(0.1, join_style="mitre").simplify(0.02))),
    "star": (star(7, 140), Mesh.from_loops([ring(20, 1.6)])),
    "triangle": (Mesh.from_loops([ring(30)]), Mesh.from_loops([ring(3, 3.0)])),
}


def tightened(fine: Mesh, coarse: Mesh, **settings: object) -> Level:
    """From a coarse mesh around the fine one, which rests."""
    return nested_cages(fine, [coarse], Settings(fallback=None, **settings))[0]  # type: ignore[arg-type]


@pytest.fixture(scope="module", params=CASES)
def level(request: pytest.FixtureRequest) -> Level:
    return tightened(*CASES[request.param])


def test_the_cage_is_nested_at_the_clearance_and_the_area_falls_with_every_step(level: Level) -> None:
    fine, coarse = level.fine, level.coarse
    assert_right(level)
    assert_nested(level.cage, fine)
    clearance, way = CLEARANCE * fine.diagonal, level.reinflation
    assert clearance * (1.0 - 1e-9) <= gap(level.cage, fine) <= 2.0 * clearance
    assert level.report.clearance == pytest.approx(gap(level.cage, fine), rel=1e-9)
    assert (len(level.flow.steps), way.tightening_start, level.report.notes) == (1, 0, ())
    assert_free_of_crossings(coarse, fine, way.cage_steps, way.fine_steps)
    areas = [coarse.moved(step).area for step in way.cage_steps]
    assert level.cage.area < coarse.area
    assert all(after < before for before, after in itertools.pairwise(areas[1:]))


def test_edges_are_flush_or_touch_at_their_middle(level: Level) -> None:
    """The sign of a local optimum: the contacts of a free edge lie on both sides of its midpoint, or at it."""
    fine = level.fine
    reach, boundary = 1.2 * level.report.clearance, lines(fine.vertices, fine)
    held = shapely.distance(shapely.points(level.cage.vertices), boundary) < reach
    balanced = free = 0
    for start, end in level.cage.edges.tolist():
        if held[[start, end]].any():
            continue
        a, b = level.cage.vertices[[start, end]]
        touching = shapely.distance(shapely.points(fine.vertices), shapely.LineString([a, b])) < reach
        t = (fine.vertices[touching] - a) @ (b - a) / ((b - a) ** 2).sum()
        free += 1
        balanced += len(t) > 0 and t.min() < 0.52 and t.max() > 0.48
    assert free > 0 or held.mean() > 0.5
    assert balanced >= 0.9 * free


@pytest.mark.parametrize("clearance", [0.05, 0.2])
def test_wider_clearance_is_kept_too(clearance: float) -> None:
    fine, coarse = CASES["star"]
    cage = tightened(fine, coarse, clearance=clearance).cage
    assert clearance * (1.0 - 1e-9) <= gap(cage, fine) <= clearance * 1.001
    around = polygon(fine).buffer(clearance).area
    assert around <= cage.area <= 1.12 * around


def test_a_cage_that_is_too_close_is_widened_first() -> None:
    fine = letter_a()
    coarse = Mesh.from_geometry(polygon(fine).buffer(1e-6 * fine.diagonal, join_style="mitre"))
    level = tightened(fine, coarse, clearance=1e-3)
    assert len(level.reinflation.cage_steps) > 1
    assert gap(level.cage, fine) >= 1e-3 * (1.0 - 1e-9)


def slit(width: float, part: float = 0.25) -> tuple[Mesh, Mesh]:
    """A block with a slit, and a cage that reaches into it by its middle, a part of its width thick to either side."""
    half, inner = 0.5 * width, part * width
    block = [[-1, -1], [1, -1], [1, 1], [half, 1], [half, 0], [-half, 0], [-half, 1], [-1, 1]]
    outline = [[-1.2, -1.2], [1.2, -1.2], [1.2, 1.2], [inner, 1.2], [inner, 0.5], [-inner, 0.5], [-inner, 1.2]]
    return Mesh.from_loops([np.array(block)]), Mesh.from_loops([np.array([*outline, [-1.2, 1.2]])])


@pytest.mark.parametrize("part", [0.25, 0.49975])  # far from the walls of the slit, and next to them
def test_walls_of_a_slit_may_come_closer_to_each_other_than_the_clearance(part: float) -> None:
    fine, coarse = slit(2.5e-3, part)
    cage = tightened(fine, coarse, clearance=1e-3).cage
    assert_nested(cage, fine)
    assert gap(cage, fine) >= 1e-3 * (1.0 - 1e-9)
    assert shapely.Point(0.0, 0.9).disjoint(polygon(cage))  # the cage stays in the slit


def test_no_room_for_the_clearance_is_an_error_and_another_start_has_room() -> None:
    fine, coarse = slit(1e-3)
    with rejected("clearance.no_room", NestingError) as caught:
        tightened(fine, coarse, clearance=1e-3)
    assert caught.value.data["wanted"] == 1e-3
    assert 0.25e-3 * (1.0 - 1e-9) <= caught.value.data["largest"] < 0.5e-3  # what there was, and half of the slit
    (level,) = nested_cages(fine, [coarse], clearance=1e-3)
    assert gap(level.cage, fine) >= 1e-3 * (1.0 - 1e-9)
    assert "note.start" in codes(level)


@pytest.mark.parametrize("most", [0, 2, 5])
def test_no_more_steps_than_allowed_are_taken(most: int) -> None:
    fine, coarse = CASES["star"]
    level = tightened(fine, coarse, tightening=Tightening(iterations=most))
    assert level.report.iterations["tightening"] == most
    assert len(level.reinflation.cage_steps) <= most + 1
    assert_nested(level.cage, fine)
    assert (level.cage == coarse) is (most == 0)


@pytest.mark.parametrize(("count", "apart"), [(31, 1e-4), (31, 2e-4), (40, 1e-4)])
def test_parts_of_the_cage_slide_along_each_other(count: int, apart: float) -> None:
    """Between two discs fine vertices hold both parts."""
    centre = 1.7 * np.cos(0.3) + apart, 1.7 * np.sin(0.3) + apart
    fine = Mesh.from_loops([ring(count, angle=0.1), ring(count, 0.7, 0.2, centre)])
    assert nested_cages(fine, [8])[0].report.excess < 0.28


def test_another_energy_brings_the_cage_as_near_to_its_coarse_mesh_as_the_clearance_allows() -> None:
    """A ring that the fine mesh sticks out of: in the end its edges touch the fine mesh at their middle."""
    fine, coarse = Mesh.from_loops([ring(90)]), Mesh.from_loops([ring(9, 0.9)])
    cage = tightened(fine, coarse, clearance=1e-3, energy=InitialDisplacement()).cage
    assert_nested(cage, fine)
    assert gap(cage, fine) == pytest.approx(1e-3, rel=1e-2)
    np.testing.assert_allclose(np.hypot(*cage.vertices.T), (1.0 + 1e-3) / np.cos(np.pi / 9), rtol=1e-5)
