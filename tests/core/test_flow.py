"""The flow: its last step lies strictly inside the coarse mesh, by shapely and by angle sums; and its refusals."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import FlowError, Mesh, PaperFlow, Settings, TwoSidedFlow, nested_cages
from support import shapes
from support.judging import codes, rejected
from support.marks import slow_after
from support.shapes import annulus, comb, disc, islands, letter_a, letter_a_coarse, lines, resampled, ring, star

ONLY_THE_FLOW = Settings(fallback=None, tightening=core.Tightening(iterations=0))
METHODS = {"two-sided": TwoSidedFlow(), "paper": PaperFlow(exact_parity=True, limit=300)}
BY_METHOD = pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)


def turns(loop: np.ndarray, point: np.ndarray) -> int:
    """Winding number of a loop (k, 2) around a point, as the sum of angles."""
    away = loop - point
    angles = np.arctan2(away[:, 1], away[:, 0])
    steps = (np.diff(np.append(angles, angles[0])) + np.pi) % (2.0 * np.pi) - np.pi
    return round(float(steps.sum()) / (2.0 * np.pi))


def assert_flows(fine: Mesh, coarse: Mesh, method: Any = METHODS["two-sided"]) -> core.Level:
    """The last step lies strictly inside; what moved keeps its windings, so it will return inside."""
    (level,) = nested_cages(fine, [coarse], replace(ONLY_THE_FLOW, flow=method))
    steps = level.flow.steps
    assert level.flow.obstacle is None
    assert np.array_equal(steps[0], fine.vertices)
    assert steps.shape[1:] == fine.vertices.shape
    assert np.isfinite(steps).all()
    assert np.array_equal(level.reinflation.cage_steps[0], coarse.vertices)
    assert lines(steps[-1], fine).distance(lines(coarse.vertices, coarse)) > 0.0
    assert shapely.contains_xy(shapes.polygon(coarse), steps[-1]).all()
    parts = int(fine.component_of_loop.max()) + 1
    for loop in coarse.loops:
        around = np.zeros(parts, int)
        for k, moved in enumerate(fine.loops):
            around[fine.component_of_loop[k]] += turns(steps[-1][moved], coarse.vertices[loop[0]])
        assert (around == 0).all()
    assert core.verify(level.cage, fine, same_loops=False)
    return level


@BY_METHOD
@pytest.mark.parametrize(
    ("corners", "turn"),
    slow_after(4, [(8, 0.0), (5, 0.4), (8, 0.77), (5, 0.15), (3, 0.0), (5, 0.0), (3, 0.77), (3, 0.15)]),
)
def test_disc_in_a_ring_of_few_corners(method: Any, corners: int, turn: float) -> None:
    """Figure 5, in several rotations."""
    assert_flows(annulus(64), annulus(corners, angle=turn * 2.0 * np.pi / corners), method)


@pytest.mark.parametrize(
    ("corners", "turn"), slow_after(3, [(8, 0.1), (5, 0.5), (5, 0.9), (3, 0.1), (3, 0.5), (8, 0.9)])
)
def test_rings_turned_against_each_other(corners: int, turn: float) -> None:
    """The outer and the inner ring come close at one place: a hole must not be caught on the corner."""
    assert_flows(
        annulus(64), Mesh.from_loops([ring(corners, 1.0, turn * 2.0 * np.pi / corners), ring(corners, 0.5, 0.1)])
    )


@BY_METHOD
def test_an_octagon_with_a_hole(method: Any) -> None:
    assert_flows(shapes.octagon_with_hole(), shapes.square_with_hole(), method)


@pytest.mark.slow
def test_a_letter() -> None:
    assert_flows(letter_a(), letter_a_coarse())


@pytest.mark.parametrize("count", [16, 32, 64])
@pytest.mark.parametrize("shape", [letter_a(), star(), islands()], ids=["letter", "star", "islands"])
def test_even_resampling(shape: Mesh, count: int) -> None:
    assert_flows(shape, resampled(shape, count, 0.3))


@pytest.mark.parametrize("shape", [letter_a_coarse(), star(), islands(), shapes.square_with_hole()])
def test_the_mesh_itself_as_its_coarse_mesh(shape: Mesh) -> None:
    assert len(assert_flows(shape, shape).flow.steps) > 1


@BY_METHOD
def test_nothing_moves_that_is_inside_already(method: Any) -> None:
    level = assert_flows(star(), Mesh.from_loops([ring(6, 2.0)]), method)
    assert len(level.flow.steps) == 1
    assert level.flow.iterations == 0
    assert level.report.start != "flow"


@pytest.mark.parametrize("examples", slow_after(1, [4, 40, 1000], thorough_after=2))
def test_random_shapes(examples: int) -> None:
    """Spikes that a coarse mesh of few vertices cuts off."""
    random, tried = np.random.default_rng(11), 0
    while tried < examples:
        count, corners = random.integers(12, 81), int(random.integers(3, 13))
        turn = np.sort(random.uniform(0.0, 2.0 * np.pi, count))
        radius = random.uniform(0.3, 1.0, count)
        try:
            fine = Mesh.from_loops([radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)])
            coarse = resampled(fine, corners, random.uniform())
        except core.InvalidMeshError:
            continue
        tried += 1
        assert_flows(fine, coarse)


def two_discs(apart: float = 1.2) -> list[np.ndarray]:
    return [ring(40, 0.5), disc(40, 0.5, apart, 0.0)]


WRAP = np.array([(-0.5, -0.5), (0.6, -0.45), (1.7, -0.5), (1.7, 0.5), (0.6, 0.45), (-0.5, 0.5)])
THIRD = disc(40, 0.5, 5.0, 1.0)


def test_components_go_into_the_parts_over_them() -> None:
    fine, coarse = Mesh.from_loops([*two_discs(), THIRD]), Mesh.from_loops([disc(6, 0.5, 5.02, 1.0), WRAP])
    level = assert_flows(fine, coarse)
    solids = [shapely.Polygon(coarse.vertices[loop]) for loop in coarse.loops]
    for loop, part in zip(fine.loops, (1, 1, 0), strict=True):
        assert solids[part].contains(shapely.Polygon(level.flow.steps[-1][loop]))


def test_a_coarse_hole_may_lie_between_components() -> None:
    t = np.linspace(0.1, np.pi - 0.1, 30)
    half = np.stack([np.cos(t), np.sin(t)], axis=1)
    arch = np.concatenate([half, 0.5 * half[::-1]])
    assert_flows(Mesh.from_loops([arch, -arch]), annulus(9))


@pytest.mark.parametrize("spread", slow_after(1, [1.0, 0.85]))
def test_each_of_many_discs_goes_into_its_own(spread: float) -> None:
    """Those that are next to others too; given in any order."""
    random = np.random.default_rng(4)
    at = random.permutation([(x, y) for x in range(9) for y in range(9)]) * spread
    order = random.permutation(81)
    fine = Mesh.from_loops([ring(16, 0.4, centre=place) for place in at])
    coarse = Mesh.from_loops([ring(5, 0.4, 0.3, at[k] + 0.02) for k in order])
    level = assert_flows(fine, coarse)
    for k, number in enumerate(order):
        solid = shapely.Polygon(coarse.vertices[coarse.loops[k]])
        assert solid.contains(shapely.Polygon(level.flow.steps[-1][fine.loops[number]]))


def test_order_of_loops_does_not_matter() -> None:
    fine, coarse = islands(), resampled(islands(), 60, 0.3)
    shuffled = Mesh.from_loops([coarse.vertices[coarse.loops[k]] for k in (3, 1, 4, 0, 2)])
    steps = [assert_flows(fine, one).flow.steps for one in (coarse, shuffled)]
    assert np.allclose(*steps, atol=1e-12)


def test_a_coarse_mesh_around_everything_needs_no_flow_whichever_holes_are_matched() -> None:
    """Two rings in one cage, which has a hole between them; by their boxes both holes suit either of the rings."""
    rings = [radius * np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]) for radius in (1.25, 1.0)]
    fine = Mesh.from_loops([rings[0], rings[1][::-1], 0.75 * rings[0], 0.875 * rings[1][::-1]])
    between = np.array([(31.0, 31.0), (31.0, 31.5), (31.5, 31.0)]) / 64.0
    level = assert_flows(fine, Mesh.from_loops([1.5 * rings[1], 0.8125 * rings[1][::-1], between]))
    assert len(level.flow.steps) == 1


FAR = (disc(3, 0.1, 9.0, 0.0), disc(3, 0.1, -9.0, 0.0))


@pytest.mark.parametrize(
    ("fine", "coarse", "place"),
    [
        ([ring(60)], [ring(9, 1.02), disc(8, 0.3, 3.0, 0.0)], (3.0, 0.0)),  # a part too many
        ([ring(60)], [ring(9, 1.02), ring(8, 0.3)], (0.0, 0.0)),  # a hole too many
        (two_discs(), [WRAP, disc(8, 0.2, 0.0, 0.0)], (0.0, 0.0)),  # a hole in one of two
        ([ring(60)], [disc(9, 1.0, 5.0, 5.0)], (0.0, 0.0)),  # elsewhere
        ([*two_discs(), THIRD], [WRAP, disc(6, 0.3, 3.0, 3.0)], (5.0, 1.0)),  # of one component, elsewhere
        ([*two_discs(), disc(40, 0.5, 0.0, 3.0)], [WRAP, WRAP + np.array([0.0, 2.7]), *FAR], None),
    ],
)
def test_loops_that_do_not_fit(fine: list[Any], coarse: list[Any], place: tuple[float, float] | None) -> None:
    with rejected("flow.loops_differ", FlowError) as refusal:
        nested_cages(fine, [Mesh.from_loops(coarse)], ONLY_THE_FLOW)
    assert list(refusal.value.partial) == []
    if place is not None:
        assert refusal.value.data["place"] == pytest.approx(place, abs=1e-9)
    (level,) = nested_cages(fine, [Mesh.from_loops(coarse)])  # but there is a cage
    assert level.report.start != "flow"


def spiral() -> Mesh:
    t = np.linspace(0.0, 4.0 * np.pi, 120)
    middle = (0.3 + 0.1 * t)[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1)
    return Mesh.from_loops([shapely.get_coordinates(shapely.LineString(middle).buffer(0.12, quad_segs=4).exterior)])


CORRIDOR = Mesh.from_loops([[(0, 0), (3, 0), (3, 3), (1, 3), (1, 2), (2, 2), (2, 1), (0, 1)]])
STUCK = {
    "limbs that the coarse mesh cuts off": (spiral(), resampled(spiral(), 16), TwoSidedFlow()),
    "a triangle in a winding corridor": (
        Mesh.from_loops([[(0.0, 0.2), (2.9, 0.2), (1.2, 2.9)]]), CORRIDOR, TwoSidedFlow(limit=1, vertex_limit=1),
    ),
    "too few steps": (annulus(64), annulus(3), PaperFlow(exact_parity=True, limit=2)),
    "holes apart": (
        Mesh.from_loops([ring(9, 0.8), disc(9, 0.05, 0.5, 0.0)]), annulus(16, 0.05),
        PaperFlow(exact_parity=True, limit=1),
    ),
    **{f"slits of {w}": (comb(2, w), resampled(comb(2, w), 24, 0.37), TwoSidedFlow()) for w in (1e-2, 1e-5, 1e-8)},
}  # fmt: skip


@pytest.mark.parametrize("case", STUCK)
def test_a_flow_that_is_stuck_says_where_and_another_start_makes_a_cage(case: str) -> None:
    fine, coarse, flow = STUCK[case]
    places = []
    for scale, shift in ((1.0, 0.0), (100.0, 7.0)):
        here, there = (Mesh(scale * mesh.vertices + shift, mesh.edges) for mesh in (fine, coarse))
        with rejected("flow.stuck", FlowError) as stopped:
            nested_cages(here, [there], replace(ONLY_THE_FLOW, flow=flow))
        places.append((np.array(stopped.value.data["place"]) - shift) / scale)
    assert places[0] == pytest.approx(places[1], abs=0.02)
    assert shapely.Point(places[0]).distance(shapes.polygon(fine).boundary) < 0.3 * fine.diagonal
    (level,) = nested_cages(fine, [coarse], Settings(flow=flow))
    assert level.report.strict and level.report.start != "flow" and "note.start" in codes(level)
