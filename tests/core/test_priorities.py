"""Where it matters: weights, pins, joints, shortest edges and sharpest angles; always certified."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from nestedcages_core import (
    Level,
    Mesh,
    Mirror,
    NestedCagesError,
    Settings,
    inner_cages,
    nested_cages,
    verify,
    verify_motion,
)
from nestedcages_core.constraints.angles import angles_of
from nestedcages_core.decimation.importance import Importance
from nestedcages_core.energies import CageEnergy
from nestedcages_core.energies.weighted_area import Springs, WeightedArea
from support.marks import slow_after
from support.shapes import annulus, derivative, letter_a, ring, star

TOP = 2.5
"""Height of the head of the letter."""


def check(level: Level) -> None:
    assert verify(level.cage, level.fine, level.report.wanted_clearance)
    assert verify_motion(level.cage, level.fine, level.reinflation.cage_steps, level.reinflation.fine_steps)


def polygon(mesh: Mesh) -> shapely.Geometry:
    return shapely.geometry.shape(mesh.__geo_interface__)


def excess_above(level: Level, y: float) -> float:
    """Area of the cage's excess above a height."""
    excess = polygon(level.cage).difference(polygon(level.fine))
    return float(excess.intersection(shapely.box(-9, y, 9, 9)).area)


@pytest.mark.parametrize("symmetry", [None, Mirror()])
@pytest.mark.parametrize("count", slow_after(1, [20, 32]))
def test_more_vertices_and_less_excess_where_weights_are_high(count: int, symmetry: Mirror | None) -> None:
    fine = letter_a()
    weights = np.where(fine.vertices[:, 1] > TOP, 10.0, 1.0)
    alike = nested_cages(fine, [count], Settings(symmetry=symmetry)).levels[0]
    weighted = nested_cages(fine, [count], Settings(weights=weights, symmetry=symmetry)).levels[0]
    check(weighted)
    assert excess_above(weighted, TOP) < 0.8 * excess_above(alike, TOP)
    assert (weighted.cage.vertices[:, 1] > TOP).sum() > (alike.cage.vertices[:, 1] > TOP).sum()


@pytest.mark.slow
def test_weights_have_no_unit_and_reach_the_next_level() -> None:
    fine = letter_a()
    weights = np.where(fine.vertices[:, 1] > TOP, 8.0, 1.0)
    one = nested_cages(fine, [32, 20], Settings(weights=weights))
    other = nested_cages(fine, [32, 20], Settings(weights=8.0 * weights))  # exact, so to the last bit
    for mine, yours in zip(one.levels, other.levels, strict=True):
        check(mine)
        assert abs(mine.report.excess - yours.report.excess) < 1e-6
    alike = nested_cages(fine, [32, 20])
    assert (one.cages[1].vertices[:, 1] > TOP).sum() > (alike.cages[1].vertices[:, 1] > TOP).sum()


def test_equal_weights_are_none() -> None:
    fine = star(5, 100)
    plain = nested_cages(fine, [20]).levels[0].report.excess
    same = nested_cages(fine, [20], Settings(weights=np.full(100, 3.0))).levels[0].report.excess
    assert abs(plain - same) < 0.02 * plain


def test_pinned_corners_keep_a_vertex() -> None:
    turn = np.pi / 4 + np.pi / 2 * np.arange(4)
    corners = 1.5 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    sides = [a + t * (b - a) + [0.0, 0.05 * np.sin(9 * t)] for a, b in zip(corners, np.roll(corners, -1, axis=0),
             strict=True) for t in np.linspace(0, 1, 20, endpoint=False)]  # fmt: skip
    fine = Mesh.from_loops([sides])
    hierarchy = nested_cages(fine, [16, 12], Settings(pins=[0, 20, tuple(corners[2]), 60]))
    for level in hierarchy.levels:
        check(level)
        for corner in corners:
            assert np.hypot(*(level.cage.vertices - corner).T).min() < 2e-3 * fine.diagonal
        assert level.report.notes == ()


def test_a_pin_on_an_edge_and_a_joint_get_vertices() -> None:
    bar = Mesh.from_loops([[(0, 0), (6, 0), (6, 1), (0, 1)]])
    dense = Mesh.from_loops([np.concatenate([np.linspace(a, b, 10, endpoint=False) for a, b in
                             zip(bar.vertices, bar.edge_ends, strict=True)])])  # fmt: skip
    level = nested_cages(dense, [6], Settings(joints=[(2.5, 0.4)])).levels[0]
    check(level)
    for place in [(2.5, 0.0), (2.5, 1.0)]:
        assert np.hypot(*(level.cage.vertices - place).T).min() < 1e-3
    level = nested_cages(dense, [5], Settings(pins=[(3.3, -0.2)])).levels[0]
    check(level)
    assert np.hypot(*(level.cage.vertices - (3.3, 0.0)).T).min() < 1e-3


def test_more_pins_than_vertices_are_reported() -> None:
    fine = letter_a(6)
    pins = [int(k) for k in np.linspace(0, 400, 9)]
    level = nested_cages(fine, [8], Settings(pins=pins, loops="keep")).levels[0]
    check(level)
    assert any("pins have no vertex of the cage nearby" in note for note in level.report.notes)


@pytest.mark.slow
@pytest.mark.parametrize("symmetry", slow_after(1, [None, Mirror()]))
def test_no_edge_is_shorter_and_no_angle_sharper(symmetry: Mirror | None) -> None:
    level = nested_cages(letter_a(), [32], Settings(min_edge=0.3, symmetry=symmetry)).levels[0]
    check(level)
    assert level.cage.edge_lengths.min() >= 0.3
    level = nested_cages(letter_a(), [20], Settings(min_angle=40.0, symmetry=symmetry)).levels[0]
    check(level)
    assert angles_of(level.cage).min() >= 40.0
    assert angles_of(nested_cages(letter_a(), [20]).cages[0]).min() < 40.0


@pytest.mark.slow
def test_limits_without_room_mean_fewer_vertices_or_are_reported() -> None:
    level = nested_cages(Mesh.from_loops([ring(64)]), [40], Settings(min_edge=0.3)).levels[0]
    check(level)
    assert level.cage.edge_lengths.min() >= 0.3
    assert "leaves room for 16" in level.report.notes[0]
    level = nested_cages(Mesh.from_loops([ring(64)]), [3], Settings(min_edge=20.0)).levels[0]
    check(level)
    assert level.cage.edge_lengths.min() >= 20.0 and level.report.notes == ()
    level = nested_cages(annulus(60), [6], Settings(min_edge=20.0)).levels[0]
    check(level)
    assert "no room for edges of 20" in level.report.notes[-1]


def test_inner_cages_too() -> None:
    fine = letter_a()
    weights = np.where(fine.vertices[:, 1] > TOP, 10.0, 1.0)
    plain = inner_cages(fine, [24]).levels[0]
    level = inner_cages(fine, [24], Settings(weights=weights, min_edge=0.2)).levels[0]
    assert verify(fine, level.cage)
    assert level.cage.edge_lengths.min() >= 0.2

    def lost(cage: Mesh) -> float:
        return float(polygon(fine).difference(polygon(cage)).intersection(shapely.box(-9, TOP, 9, 9)).area)

    assert lost(level.cage) < lost(plain.cage)


def test_bad_priorities_are_rejected() -> None:
    for wrong in ({"weights": [1.0, -1.0]}, {"weights": "heavy"}, {"weights": [0.0, 0.0]}, {"weights": [np.inf]},
                  {"pins": 3}, {"pins": ["corner"]}, {"pins": [(1.0,)]}, {"joints": [1]}, {"min_edge": 0.0},
                  {"min_edge": "long"}, {"min_angle": 90.0}, {"min_angle": -1}):  # fmt: skip
        with pytest.raises(NestedCagesError):
            Settings(**wrong)
    with pytest.raises(NestedCagesError, match="There are 2 weights, but the mesh has 64 vertices"):
        nested_cages(Mesh.from_loops([ring(64)]), [8], Settings(weights=[1.0, 2.0]))
    with pytest.raises(NestedCagesError, match="no vertex 64 to pin"):
        nested_cages(Mesh.from_loops([ring(64)]), [8], Settings(pins=[64]))


def cage_and_energies() -> list[CageEnergy]:
    fine = star(5, 100)
    cage = Mesh.from_loops([1.5 * ring(11)])
    importance = Importance(fine, np.linspace(0.0, 1.0, 100), np.zeros((0, 2)))
    return [
        WeightedArea.of(cage.vertices, cage.successor, fine, importance.at),
        WeightedArea.of(cage.vertices, cage.successor, fine, importance.at, side=-1),
        Springs(np.array([2, 5]), np.array([[0.1, 0.3], [1.0, -1.0]]), 30.0),
    ]


@pytest.mark.parametrize("energy", cage_and_energies(), ids=lambda energy: type(energy).__name__)
def test_derivatives_are_those_of_finite_differences(energy: CageEnergy) -> None:
    cage = Mesh.from_loops([1.5 * ring(11)])
    rng = np.random.default_rng(2)
    vertices, successor = cage.vertices + 0.05 * rng.normal(size=(11, 2)), cage.successor
    gradient, hessian = energy.gradient(vertices, successor), energy.hessian(vertices, successor).dense(11)
    slope = derivative(lambda x: energy.value(x, successor), vertices)
    assert np.abs(slope - gradient).max() < 1e-5 * (1.0 + np.abs(gradient).max())
    slopes = derivative(lambda x: energy.gradient(x, successor), vertices).reshape(22, 22)
    assert np.allclose(slopes, hessian, atol=1e-4 * (1.0 + np.abs(hessian).max()))


def test_weighted_area_with_equal_weights_is_the_excess() -> None:
    fine = letter_a()
    cage = nested_cages(fine, [18]).cages[0]
    ones = WeightedArea.of(cage.vertices, cage.successor, fine, lambda points: np.ones(len(points)))
    assert abs(ones.value(cage.vertices, cage.successor) - (cage.area - fine.area)) < 1e-9
    inner = inner_cages(fine, [24]).cages[0]
    ones = WeightedArea.of(inner.vertices, inner.successor, fine, lambda points: np.ones(len(points)), side=-1)
    assert abs(ones.value(inner.vertices, inner.successor) - (fine.area - inner.area)) < 1e-9
