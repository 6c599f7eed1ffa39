"""What must always hold, for whole runs: random shapes, every instant, invariance, five levels, own coarse meshes."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from nestedcages_core import FlowError, FlowResult, LineCycles, Mesh, NestingError, Settings, nested_cages, verify
from support import shapes
from support.judging import codes, rejected
from support.marks import slow_after
from support.shapes import annulus, comb, disc, islands, letter_a, polygon, resampled, ring, star, turned

FAST = Settings(decimation=LineCycles(on_curve=False), fallback=LineCycles(on_curve=False))


def lopsided() -> Mesh:
    """A shape without any symmetry, with a hole that has none: no choice between its vertices is a tie."""
    turn = 2.0 * np.pi * np.arange(150) / 150
    around = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    radius = 1.0 + 0.25 * np.cos(3 * turn + 0.2) + 0.1 * np.sin(7 * turn) + 0.05 * np.cos(11 * turn + 1.0)
    hole = 0.3 * (1.0 + 0.3 * np.cos(2 * turn + 0.3) + 0.1 * np.cos(5 * turn))
    return Mesh.from_loops([radius[:, None] * around, (hole[:, None] * around)[::3] + np.array([0.1, 0.05])])


MOTIONS = {
    "moved": (1.0, lambda points: points + np.array([30.0, -70.0])),
    "tiny": (1e-6, lambda points: 1e-6 * points),
    "huge": (1e6, lambda points: 1e6 * points),
    "squared areas are infinite": (2.0**400, lambda points: 2.0**400 * points),
    "turned": (1.0, lambda points: turned(points, 0.7)),
    "all": (1e3, lambda points: 1e3 * turned(points, 2.0) + np.array([3e3, 1e3])),
}
ROUND_OFF, AFTER_A_WAY = 1e-10, 1e-8
"""Distances in diagonals; coordinates of 70 alone are rounded by 1e-14, and the way home makes more of that."""


@pytest.mark.parametrize(("scale", "motion"), slow_after(0, MOTIONS.values(), thorough_after=3), ids=MOTIONS.keys())
@pytest.mark.parametrize(("level", "bound"), [(24, ROUND_OFF), (resampled(lopsided(), 30), AFTER_A_WAY)])
def test_the_cage_moves_with_the_shape(
    level: int | Mesh, bound: float, scale: float, motion: Callable[[np.ndarray], np.ndarray]
) -> None:
    fine, clearance = lopsided(), 1e-4
    moved = fine.moved(motion(fine.vertices)).validated()
    level_moved = level if isinstance(level, int) else level.moved(motion(level.vertices)).validated()
    cage = nested_cages(fine, [level], Settings(clearance=clearance)).cages[0]
    cage_moved = nested_cages(moved, [level_moved], Settings(clearance=scale * clearance)).cages[0]
    expected = polygon(cage.moved(motion(cage.vertices)))
    assert polygon(cage_moved).hausdorff_distance(expected) < bound * moved.diagonal


@pytest.mark.parametrize("distance", [1e3, 1e6, 1e9])
def test_far_from_the_origin_the_cage_is_as_good_as_coordinates_allow(distance: float) -> None:
    fine = lopsided()
    moved = Mesh(fine.vertices + np.array([distance, -distance]), fine.edges)
    cage, cage_moved = (nested_cages(mesh, [24], FAST).cages[0] for mesh in (fine, moved))
    assert verify(cage_moved, moved)
    assert cage_moved.area / moved.area == pytest.approx(cage.area / fine.area, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("shape", [lopsided, letter_a, islands], ids=lambda shape: shape.__name__)
def test_the_start_of_loops_and_their_order_do_not_matter(shape: Callable[[], Mesh]) -> None:
    fine = shape()
    loops = [fine.vertices[loop] for loop in fine.loops]
    other = Mesh.from_loops([np.roll(loop, 5 + k, axis=0)[:: (-1) ** k] for k, loop in enumerate(loops)][::-1])
    cage, cage_other = (nested_cages(mesh, [24]).cages[0] for mesh in (fine, other))
    assert polygon(cage).hausdorff_distance(polygon(cage_other)) < 1e-5 * fine.diagonal


WRAP = np.array([(-0.5, -0.5), (0.6, -0.45), (1.7, -0.5), (1.7, 0.5), (0.6, 0.45), (-0.5, 0.5)])


TWO_RINGS = [ring(40, 0.5), disc(40, 0.5, 1.2, 0.0), ring(20, 0.2), disc(20, 0.2, 1.2, 0.0)]
TWO_SQUARES = [disc(4, 0.5, -2.0, 0.0), disc(4, 0.5, 2.0, 0.0)]
WRAPPED: dict[str, tuple[list[np.ndarray], list[np.ndarray], Any, Any]] = {
    "one loop around both": (TWO_RINGS, [WRAP], (2, 3), ((0, 1),)),
    "one hole left open": (TWO_RINGS, [WRAP, disc(5, 0.22, 1.22, 0.03)], (2,), ((0, 1),)),
    "both holes covered": (TWO_RINGS, [ring(6, 0.5), disc(6, 0.5, 1.2, 0.0)], (2, 3), ()),
    "around both, with the room between free": (TWO_SQUARES, [ring(4, 6.0), ring(4, 1.0)], (), ((0, 1),)),
}
"""Gurditta & Jacobson 2022, figure 4, and as many loops of other kinds; what is filled, and what joined."""


@pytest.mark.parametrize(("loops", "coarse", "filled", "joined"), WRAPPED.values(), ids=WRAPPED.keys())
def test_one_cage_may_wrap_two_components_and_cover_holes(loops: Any, coarse: Any, filled: Any, joined: Any) -> None:
    fine = Mesh.from_loops(loops)
    level = nested_cages(fine, [Mesh.from_loops(coarse)], Settings(fallback=None)).levels[0]
    assert level.report.start == ("flow" if loops is TWO_RINGS else "coarse mesh")
    assert (len(level.cage.loops), codes(level)[-1]) == (len(coarse), "note.loops")
    assert (level.report.lost.filled, level.report.lost.joined) == (filled, joined)
    assert verify(level.cage, fine, level.report.wanted_clearance, same_loops=False)
    assert polygon(level.cage).contains_properly(polygon(fine))


def test_a_stuck_flow_without_fallback_carries_reason_and_way() -> None:
    fine, coarse = comb(3, 0.05), Mesh.from_loops([[(0.1, -0.3), (0.9, -0.3), (0.9, -0.1), (0.1, -0.1)]])
    with rejected("flow.loops_differ", FlowError) as caught:
        nested_cages(fine, [coarse], Settings(fallback=None))
    x, y = caught.value.data["place"]
    assert -0.1 < x < 1.1 and -0.1 < y < 0.7
    cause = caught.value.__cause__
    assert isinstance(cause, FlowError) and isinstance(cause.partial, FlowResult)
    assert cause.partial.steps[0].shape == fine.vertices.shape
    level = nested_cages(fine, [coarse]).levels[0]
    assert (level.report.notes[0].code, level.report.notes[0].data["on"]) == ("note.start", "fallback")


SQUARE = ring(4, 1.0, np.pi / 4)


NEEDLE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, 1.0), (0.5, 1000.0), (0.499999, 1.0), (0.0, 1.0)])
HARD: dict[str, tuple[Mesh, list[int | Mesh]]] = {
    "islands five deep": (Mesh.from_loops([ring(40, 1.0 - 0.09 * k) for k in range(10)]), [200, 120]),
    "two hundred tiny parts": (
        Mesh.from_loops([disc(8, 0.001, 0.05 * (k % 20), 0.05 * (k // 20)) for k in range(200)]), [800, 600],
    ),
    "collinear runs": (resampled(Mesh.from_loops([SQUARE]), 200), [100, 4, 3]),
    "slit of 1e-6": (comb(2, 1e-6), [12, 6]),
    "slit of 1e-12": (comb(2, 1e-12), [12, 6]),
    "zigzag in a slit of 1e-6": (comb(1, 1e-6), [resampled(comb(1, 1e-6), 40, 0.37)]),
    "zigzag in slits of 1e-3": (comb(3, 1e-3), [resampled(comb(3, 1e-3), 60, 0.5), 30]),
    "sliver": (Mesh.from_loops([np.array([(0, 0), (1, 0), (1, 1e-9), (0.5, 2e-9), (0, 1e-9)])]), [4, 3]),
    "needle": (Mesh.from_loops([NEEDLE]), [5, 4]),
    "sizes nine orders apart": (Mesh.from_loops([ring(50), disc(20, 1e-9, 3.0, 0.0)]), [20, 8]),
    "a hole of 1e-9": (annulus(50, 1e-9), [20]),
    "tiny coordinates": (Mesh.from_loops([1e-149 * ring(50)]), [12]),
    "huge coordinates": (Mesh.from_loops([1e149 * ring(50)]), [12]),
    "minus zero": (Mesh.from_loops([np.array([(-0.0, -0.0), (1, -0.0), (1, 1), (0.0, 1)])]), [4, 3]),
    "whole numbers": (Mesh.from_loops([np.array([(0, 0), (10, 0), (10, 7), (5, 3), (0, 10)])]), [4]),
    "single precision": (Mesh.from_loops([ring(50).astype(np.float32)]), [12]),
    "every second of a Fortran array": (Mesh.from_loops([np.asfortranarray(ring(100))[::2]]), [12]),
    "the fine mesh as its own": (star(), [star()]),
    "own mesh turned round": (star(), [Mesh.from_loops([star().vertices[::-1]])]),
    "own mesh that touches": (
        Mesh.from_loops([SQUARE]), [Mesh.from_loops([SQUARE * np.array([[2.0], [1.0], [1.0], [1.0]])])],
    ),
    "own mesh across": (Mesh.from_loops([ring(80)]), [Mesh.from_loops([ring(4, 1.0, 0.4) * np.array([2.0, 0.3])])]),
    "own mesh inside": (Mesh.from_loops([ring(80)]), [Mesh.from_loops([ring(8, 0.1)])]),
    "own mesh among counts": (letter_a(), [60, shapes.letter_a_coarse(), 8]),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("fine", "levels"), HARD.values(), ids=HARD.keys())
def test_hard_inputs_get_certified_cages(fine: Mesh, levels: list[int | Mesh]) -> None:
    hierarchy = nested_cages(fine, levels, FAST)
    assert len(hierarchy.levels) == len(levels)
    inner = fine
    for level in hierarchy.levels:
        assert verify(level.cage, inner, level.report.wanted_clearance, same_loops=not level.report.lost)
        inner = level.cage


def test_a_hole_too_small_beside_the_whole_is_filled() -> None:
    """Its corners differ in the input's units only; a union of shapes that nearly fit leaves such holes."""
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    hole = np.array([[0.0, 0.0], [4e-20, 1.4e-19], [2.5e-17, -2.7e-18]])
    fine = Mesh.from_loops([square, hole])
    level = nested_cages(fine, [7])[0]
    assert verify(level.cage, fine, same_loops=False) and level.report.lost.filled == (1,)
    for settings in (Settings(loops="keep"), Settings(clearance=1e-3, loops="keep")):
        with rejected("clearance.no_room", NestingError) as caught:
            nested_cages(fine, [7], settings)
        assert caught.value.data["loops"] == (1,)
