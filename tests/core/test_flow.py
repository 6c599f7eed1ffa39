"""Flow: the fine mesh ends strictly inside the coarse one, by shapely and by angle sums; its stages, its refusals."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from nestedcages_core import FlowError, InvalidMeshError, Mesh, SignedDistanceFlow, TwoSidedFlow, nested_cages
from nestedcages_core.flow import FlowMethod, FlowResult, Obstacle
from nestedcages_core.flow.loop_matching import match_loops
from nestedcages_core.tasks import drain
from support.shapes import (
    annulus,
    comb,
    disc,
    islands,
    letter_a,
    letter_a_coarse,
    lines,
    octagon_with_hole,
    polygon,
    resampled,
    ring,
    square_with_hole,
    star,
)

METHODS = {"two-sided": TwoSidedFlow(), "signed distance": SignedDistanceFlow()}
BY_METHOD = pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)


def turns(loop: np.ndarray, point: np.ndarray) -> int:
    """Winding number of a loop (k, 2) around a point, as the sum of angles."""
    away = loop - point
    angles = np.arctan2(away[:, 1], away[:, 0])
    steps = (np.diff(np.append(angles, angles[0])) + np.pi) % (2.0 * np.pi) - np.pi
    return round(float(steps.sum()) / (2.0 * np.pi))


def assert_inside(result: FlowResult, fine: Mesh, coarse: Mesh) -> None:
    """The last step lies strictly inside; what moved keeps its windings, so it will come home inside."""
    assert result.obstacle is None
    assert result.reason == ""
    assert (result.steps[0] == fine.vertices).all()
    assert result.steps.shape[1:] == fine.vertices.shape
    last = result.steps[-1]
    assert lines(last, fine).distance(lines(coarse.vertices, coarse)) > 0.0
    solid = polygon(coarse)
    assert shapely.contains_xy(solid, last).all()
    parts = int(fine.component_of_loop.max()) + 1
    for loop in coarse.loops:
        around = np.zeros(parts, int)
        for k, moved in enumerate(fine.loops):
            around[fine.component_of_loop[k]] += turns(last[moved], coarse.vertices[loop[0]])
        assert (around == 0).all()


# What the paper shows


@BY_METHOD
@pytest.mark.parametrize("corners", [8, 5, 3])
@pytest.mark.parametrize("turn", [0.0, 0.15, 0.4, 0.77])
def test_disc_in_a_ring_of_few_corners(method: FlowMethod, corners: int, turn: float) -> None:
    """Figure 5, in several rotations."""
    fine, coarse = annulus(64), annulus(corners, angle=turn * 2.0 * np.pi / corners)
    assert_inside(drain(method.run(fine, coarse)), fine, coarse)


@pytest.mark.parametrize("corners", [8, 5, 3])
@pytest.mark.parametrize("turn", [0.1, 0.5, 0.9])
def test_rings_turned_against_each_other(corners: int, turn: float) -> None:
    """The outer and the inner ring come close at one place: a hole must not be caught on the corner."""
    fine = annulus(64)
    coarse = Mesh.from_loops([ring(corners, 1.0, turn * 2.0 * np.pi / corners), ring(corners, 0.5, 0.1)])
    assert_inside(drain(TwoSidedFlow().run(fine, coarse)), fine, coarse)


@BY_METHOD
def test_letter_and_octagon(method: FlowMethod) -> None:
    for fine, coarse in ((letter_a(), letter_a_coarse()), (octagon_with_hole(), square_with_hole())):
        assert_inside(drain(method.run(fine, coarse)), fine, coarse)


@pytest.mark.parametrize("count", [16, 32, 64])
@pytest.mark.parametrize("shape", [letter_a, star, islands])
def test_even_resampling(shape: object, count: int) -> None:
    fine = shape()  # type: ignore[operator]
    coarse = resampled(fine, count, 0.3)
    assert_inside(drain(TwoSidedFlow().run(fine, coarse)), fine, coarse)


# Stages


@BY_METHOD
def test_nothing_moves_that_is_inside_already(method: FlowMethod) -> None:
    fine = star()
    result = drain(method.run(fine, Mesh.from_loops([ring(6, 2.0)])))
    assert result.steps.shape == (1, *fine.vertices.shape)
    assert result.iterations == 0


@pytest.mark.parametrize("shape", [letter_a_coarse, star, islands, square_with_hole])
def test_the_mesh_itself_as_its_coarse_mesh(shape: object) -> None:
    fine = shape()  # type: ignore[operator]
    result = drain(TwoSidedFlow().run(fine, fine))
    assert_inside(result, fine, fine)


@pytest.mark.slow
@pytest.mark.parametrize(("width", "count"), [(1e-2, 16), (1e-4, 60), (1e-6, 33), (1e-8, 33)])
def test_levels_get_a_cage_where_resampling_cuts_through_slits(width: float, count: int) -> None:
    fine = comb(2, width)
    level = nested_cages(fine, [resampled(fine, count, 0.37)]).levels[0]
    assert level.report.start in ("line cycles", "outer hull")
    assert level.report.strict


def test_limbs_that_the_coarse_mesh_cuts_off() -> None:
    """Sixteen points cannot follow a spiral: its arms reach out of the coarse mesh and back in."""
    t = np.linspace(0.0, 4.0 * np.pi, 120)
    middle = (0.3 + 0.1 * t)[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1)
    arm = shapely.LineString(middle).buffer(0.12, quad_segs=4)
    fine = Mesh.from_loops([shapely.get_coordinates(arm.exterior)])
    coarse = resampled(fine, 16)
    with pytest.raises(FlowError, match="still crosses") as caught:
        drain(TwoSidedFlow().run(fine, coarse))
    assert caught.value.partial.obstacle is not None
    level = nested_cages(fine, [coarse]).levels[0]
    assert level.report.strict and level.report.start == "line cycles"


# Loops


def test_a_fine_hole_may_be_covered() -> None:
    fine, coarse = annulus(60), Mesh.from_loops([ring(7, 1.02)])
    assert match_loops(fine, coarse).partner.tolist() == [0, -1]
    assert_inside(drain(TwoSidedFlow().run(fine, coarse)), fine, coarse)


def two_discs(apart: float = 1.2) -> list[np.ndarray]:
    return [ring(40, 0.5), disc(40, 0.5, apart, 0.0)]


WRAP = np.array([(-0.5, -0.5), (0.6, -0.45), (1.7, -0.5), (1.7, 0.5), (0.6, 0.45), (-0.5, 0.5)])


def test_one_coarse_loop_may_wrap_two_components() -> None:
    """Figure 4; one of the two holes stays open, the other is covered."""
    holes = [ring(20, 0.2), disc(20, 0.2, 1.2, 0.0)]
    fine = Mesh.from_loops([*two_discs(), *holes])
    coarse = Mesh.from_loops([WRAP, disc(5, 0.22, 1.22, 0.03)])
    assert_inside(drain(TwoSidedFlow().run(fine, coarse)), fine, coarse)


def test_components_are_given_to_the_parts_over_them() -> None:
    fine = Mesh.from_loops([*two_discs(), disc(40, 0.5, 5.0, 1.0)])
    coarse = Mesh.from_loops([disc(6, 0.5, 5.02, 1.0), WRAP])
    assert match_loops(fine, coarse).partner.tolist() == [1, 1, 0]
    assert_inside(drain(TwoSidedFlow().run(fine, coarse)), fine, coarse)


def test_a_coarse_hole_may_lie_between_components() -> None:
    t = np.linspace(0.1, np.pi - 0.1, 30)
    half = np.concatenate([ring(1) * 0, np.stack([np.cos(t), np.sin(t)], axis=1)])[1:]
    arch = np.concatenate([half, 0.5 * half[::-1]])
    fine, coarse = Mesh.from_loops([arch, -arch]), annulus(9)
    assert_inside(drain(TwoSidedFlow().run(fine, coarse)), fine, coarse)


def test_order_of_loops_does_not_matter() -> None:
    fine, coarse = islands(), resampled(islands(), 60, 0.3)
    order = [3, 1, 4, 0, 2]
    shuffled = Mesh.from_loops([coarse.vertices[coarse.loops[k]] for k in order])
    partner = match_loops(fine, coarse).partner
    assert partner.tolist() == [0, 1, 2, 3, 4]
    assert [order[k] for k in match_loops(fine, shuffled).partner] == [0, 1, 2, 3, 4]
    assert np.allclose(
        drain(TwoSidedFlow().run(fine, coarse)).steps, drain(TwoSidedFlow().run(fine, shuffled)).steps, atol=1e-12
    )


# Refusals


@pytest.mark.parametrize(
    ("fine", "coarse", "words"),
    [
        ([ring(60)], [ring(9, 1.02), disc(8, 0.3, 3.0, 0.0)], ["2 separate parts for 1", "loop 1", "(3,"]),
        ([ring(60)], [ring(9, 1.02), ring(8, 0.3)], ["Loop 1 of the coarse mesh is a hole", "remove"]),
        ([ring(60)], [disc(9, 1.0, 5.0, 5.0)], ["No part of the coarse mesh overlaps outer loop 0"]),
        (
            [*two_discs(), disc(40, 0.5, 5.0, 1.0)],
            [WRAP, disc(6, 0.3, 3.0, 3.0)],
            ["overlaps outer loop 2", "(5, 1)"],
        ),
        (
            [*two_discs(), disc(40, 0.5, 0.0, 3.0)],
            [WRAP, WRAP + np.array([0.0, 2.7]), disc(3, 0.1, 9.0, 0.0), disc(3, 0.1, -9.0, 0.0)],
            ["4 separate parts for 3"],
        ),
    ],
)
def test_loops_that_do_not_fit(fine: list[np.ndarray], coarse: list[np.ndarray], words: list[str]) -> None:
    with pytest.raises(FlowError) as refusal:
        drain(TwoSidedFlow().run(Mesh.from_loops(fine), Mesh.from_loops(coarse)))
    for word in words:
        assert word in str(refusal.value)
    assert isinstance(refusal.value.partial, FlowResult)
    assert refusal.value.partial.stage == "matching"


def test_a_flow_that_is_stuck_says_where_and_carries_its_steps() -> None:
    fine, coarse = annulus(64), annulus(3)
    with pytest.raises(FlowError) as stop:
        drain(SignedDistanceFlow(limit=2).run(fine, coarse))
    assert "Fine loop" in str(stop.value)
    assert "near (" in str(stop.value)
    partial = stop.value.partial
    assert partial.steps.shape == (3, *fine.vertices.shape)
    assert partial.reason == str(stop.value)
    assert partial.obstacle.place is not None
    assert "(101, -7)" in Obstacle("It is there", (1.0, -2.0)).fault(100.0, (1.0, 193.0))


def test_too_few_fine_vertices() -> None:
    """A triangle cannot be laid into a winding corridor."""
    corridor = [(0, 0), (3, 0), (3, 3), (1, 3), (1, 2), (2, 2), (2, 1), (0, 1)]
    fine = Mesh.from_loops([[(0.0, 0.2), (2.9, 0.2), (1.2, 2.9)]])
    with pytest.raises(FlowError, match=r"near \("):
        drain(TwoSidedFlow(limit=1, vertex_limit=1).run(fine, Mesh.from_loops([corridor])))


# Invariance


@pytest.mark.slow
def test_random_shapes() -> None:
    rng, tried = np.random.default_rng(11), 0
    while tried < 60:
        count, corners = rng.integers(12, 81), int(rng.integers(3, 13))
        turn = np.sort(rng.uniform(0.0, 2.0 * np.pi, count))
        radius = rng.uniform(0.3, 1.0, count)
        try:
            fine = Mesh.from_loops([radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)])
            coarse = resampled(fine, corners, rng.uniform())
        except InvalidMeshError:
            continue
        tried += 1
        assert_inside(drain(TwoSidedFlow().run(fine, coarse)), fine, coarse)
