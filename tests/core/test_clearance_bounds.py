"""Clearances up to the largest that a hole or a gap has room for, which shapely knows, and the sentence beyond."""

from __future__ import annotations

import re

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core import Mesh, NestingError, Settings, nested_cages, verify
from nestedcages_core.decimation.hull.small_holes import largest_circle
from support.marks import slow_after
from support.shapes import annulus, comb, ring

NEARLY_ALL = 0.99


def star_with_hole(seed: int) -> Mesh:
    random = np.random.default_rng(seed)
    radius = random.uniform(0.15, 0.6, (14, 1))
    turn = np.sort(random.uniform(0.0, 2.0 * np.pi, 14))
    return Mesh.from_loops([ring(64), radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)])


def l_shaped_hole() -> Mesh:
    """The widest place of the hole is in its bend."""
    hole = [(-0.5, -0.5), (0.5, -0.5), (0.5, -0.3), (-0.3, -0.3), (-0.3, 0.5), (-0.5, 0.5)]
    return Mesh.from_loops([ring(4, 2.0), np.array(hole)])


def inradius(mesh: Mesh) -> float:
    return float(shapely.maximum_inscribed_circle(shapely.Polygon(mesh.vertices[mesh.loops[1]]), 1e-7).length)


@pytest.mark.slow
@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10_000))
def test_the_largest_circle_is_that_of_shapely(seed: int) -> None:
    mesh = star_with_hole(seed)
    circle = largest_circle(mesh, 1)
    assert circle.radius == pytest.approx(inradius(mesh), rel=1e-3)
    hole = shapely.Polygon(mesh.vertices[mesh.loops[1]])
    assert hole.contains(shapely.Point(circle.centre))
    assert hole.exterior.distance(shapely.Point(circle.centre)) == pytest.approx(circle.radius, rel=1e-9)


@pytest.mark.parametrize("fine", [annulus(32, 0.22), l_shaped_hole(), star_with_hole(0), star_with_hole(1)])
@pytest.mark.parametrize("share", slow_after(0, [NEARLY_ALL, 0.7, 0.94], thorough_after=1))
def test_a_clearance_may_fill_a_hole_nearly(fine: Mesh, share: float) -> None:
    clearance = share * inradius(fine)
    level = nested_cages(fine, [10], Settings(clearance=clearance, loops="keep")).levels[0]
    assert verify(level.cage, fine, clearance)


@pytest.mark.slow
@pytest.mark.parametrize("fine", [annulus(32, 0.22), l_shaped_hole(), star_with_hole(0)])
def test_a_clearance_that_a_hole_has_no_room_for_is_refused_with_the_hole_and_the_largest_possible(fine: Mesh) -> None:
    with pytest.raises(NestingError, match=r"in loop 1 of the mesh inside it, a hole: the largest circle") as caught:
        nested_cages(fine, [10], Settings(clearance=1.05 * inradius(fine), loops="keep"))
    named = re.search(r"around \((.*), (.*)\), has the radius .*; ask for less than (.*), or", str(caught.value))
    assert named
    x, y, largest = map(float, named.groups())
    assert largest == pytest.approx(inradius(fine), rel=1e-3)
    assert shapely.Polygon(fine.vertices[fine.loops[1]]).exterior.distance(shapely.Point(x, y)) == pytest.approx(
        largest, rel=1e-4
    )


@pytest.mark.slow
@pytest.mark.parametrize("gap", [0.1, 0.01])
@pytest.mark.parametrize("part", [ring(4, 1.0, np.pi / 4), ring(40)], ids=["square", "disc"])
def test_two_components_share_the_gap_between_them(gap: float, part: np.ndarray) -> None:
    fine = Mesh.from_loops([part, part + np.array([np.ptp(part[:, 0]) + gap, 0.0])])
    clearance = NEARLY_ALL * 0.5 * gap
    assert verify(nested_cages(fine, [8], Settings(clearance=clearance, loops="keep")).cages[0], fine, clearance)
    for wanted in (0.5 * gap, 0.6 * gap):
        with pytest.raises(NestingError, match=r"between loops 0 and 1 of the mesh inside it: they are") as caught:
            nested_cages(fine, [8], Settings(clearance=wanted, loops="keep"))
        assert f"ask for less than {0.5 * gap:.6g}," in str(caught.value)


@pytest.mark.slow
def test_an_island_shares_its_hole() -> None:
    fine = Mesh.from_loops([ring(40), ring(40, 0.6), ring(40, 0.3)])
    with pytest.raises(NestingError, match=r"between loops 1 and 2 of the mesh inside it: they are 0\.299"):
        nested_cages(fine, [24], Settings(clearance=0.2, loops="keep"))


@pytest.mark.parametrize("width", [0.05, 0.01, 1e-4, 1e-6])
def test_a_slit_within_one_loop_is_filled(width: float) -> None:
    fine = comb(1, width)
    assert verify(nested_cages(fine, [16], Settings(clearance=0.02, loops="keep")).cages[0], fine, 0.02)


@pytest.mark.slow
def test_too_few_vertices_are_told_from_too_little_room() -> None:
    """Between the island and its hole there is room for the clearance, but not for loops of eight vertices."""
    fine = Mesh.from_loops([ring(40), ring(40, 0.6), ring(40, 0.3)])
    with pytest.raises(NestingError, match=r"^No cage with this few vertices was found that keeps the clearance"):
        nested_cages(fine, [24], Settings(clearance=0.14, loops="keep"))
    assert verify(nested_cages(fine, [60], Settings(clearance=0.14, loops="keep")).cages[0], fine, 0.14)


@pytest.mark.slow
@pytest.mark.parametrize(("gap", "clearance"), slow_after(1, [(0.05, 0.005), (0.1, 0.01)]))
def test_a_level_leaves_room_for_the_next(gap: float, clearance: float) -> None:
    """Two letters with serifs; alone, the first cage would have its two loops next to each other."""
    side = [(0.6, 0), (0.6, 0.08), (0.35, 0.12), (0.35, 1.3), (0.6, 1.4), (0.6, 1.5)]
    beam = np.array(side + [(0.6 - x, y) for x, y in reversed(side)])
    fine = Mesh.from_loops([beam, beam + np.array([0.6 + gap, 0.0])])
    hierarchy = nested_cages(fine, [16, 10], clearance=clearance, loops="keep")
    for level in hierarchy:
        assert verify(level.cage, level.fine, clearance)
    one, other = (shapely.LinearRing(hierarchy[0].cage.vertices[loop]) for loop in hierarchy[0].cage.loops)
    assert one.distance(other) >= 2.0 * clearance
