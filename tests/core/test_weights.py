"""Where it matters: weights, pins, joints, shortest edges and sharpest angles; always certified."""

from typing import Any

import numpy as np
import pytest
import shapely

from nestedcages_core import Level, Mesh, Mirror, inner_cages, nested_cages, verify
from support.judging import codes, excess_in, lengths_of, note, sharpest
from support.marks import slow_after
from support.shapes import annulus, letter_a, resampled, ring, star

TOP = 2.5
"""Height of the head of the letter."""
HEAD, REST = shapely.box(-9, TOP, 9, 9), shapely.box(-9, -9, 9, TOP)


def certified(level: Level) -> bool:
    outer, inner = (level.fine, level.cage) if level.inside else (level.cage, level.fine)
    return bool(verify(outer, inner, level.report.wanted_clearance))


def heavy(fine: Mesh, weight: float = 10.0) -> np.ndarray:
    return np.where(fine.vertices[:, 1] > TOP, weight, 1.0)


@pytest.mark.parametrize("made", [nested_cages, inner_cages], ids=["around", "inside"])
@pytest.mark.parametrize(("symmetry", "count"), slow_after(1, [(None, 20), (Mirror(), 20), (None, 32), (Mirror(), 32)]))
def test_each_cage_is_the_better_one_by_its_own_measure(made: Any, symmetry: Mirror | None, count: int) -> None:
    """The weighted one has less of the weighted excess and more vertices at the head, the other less area in all."""
    fine = letter_a()
    alike, weighted = (
        made(fine, count, weights=each, symmetry=symmetry, loops="keep")[0] for each in (None, heavy(fine))
    )
    assert certified(weighted)
    head, rest = ([excess_in(each.cage, fine, region) for each in (alike, weighted)] for region in (HEAD, REST))
    assert head[1] < 0.8 * head[0]
    assert 10.0 * head[1] + rest[1] < 10.0 * head[0] + rest[0] and head[0] + rest[0] < head[1] + rest[1]
    assert (weighted.cage.vertices[:, 1] > TOP).sum() >= (alike.cage.vertices[:, 1] > TOP).sum()


@pytest.mark.slow
def test_weights_have_no_unit_and_reach_the_next_level() -> None:
    fine = letter_a()
    one, other = (
        nested_cages(fine, [32, 20], weights=factor * heavy(fine, 8.0), loops="keep") for factor in (1.0, 8.0)
    )
    for mine, yours in zip(one, other, strict=True):
        assert certified(mine) and mine.excess == pytest.approx(yours.excess, abs=1e-6)  # a power of two is exact
    alike = nested_cages(fine, [32, 20], loops="keep")
    assert excess_in(one.cages[1], fine, HEAD) < 0.8 * excess_in(alike.cages[1], fine, HEAD)


@pytest.mark.parametrize(("made", "count"), [(nested_cages, 20), (inner_cages, 16)], ids=["around", "inside"])
def test_equal_weights_are_none(made: Any, count: int) -> None:
    fine = star(5, 100)
    plain, same = (made(fine, count, weights=each)[0].excess for each in (None, np.full(100, 3.0)))
    assert same == pytest.approx(plain, rel=0.02)


def test_weights_that_differ_by_hundreds_do_not_lead_away() -> None:
    fine = Mesh.from_loops([ring(80)])
    level = nested_cages(fine, 5, weights=np.exp(3.0 * fine.vertices[:, 1]))[0]
    assert certified(level) and level.excess < 1.0


def test_of_two_alike_parts_the_heavy_one_gets_the_vertices() -> None:
    """Two discs far apart: of 16 vertices, shared in halves without weights."""
    fine = Mesh.from_loops([ring(80), ring(80) + np.array([9.0, 0.0])])
    weights = np.repeat([9.0, 1.0], 80)
    plain, weighted = (nested_cages(fine, 16, weights=each)[0].cage for each in (None, weights))
    assert [len(loop) for loop in plain.loops] == [8, 8]
    first, second = (len(loop) for loop in weighted.loops)
    best = min(range(3, 14), key=lambda k: 9.0 * k * np.tan(np.pi / k) + (16 - k) * np.tan(np.pi / (16 - k)))
    assert first + second == 16 and abs(first - best) <= 1


# Pins and joints


def wavy_square() -> tuple[Mesh, np.ndarray]:
    corners = 1.5 * ring(4, 1.0, np.pi / 4)
    sides = [
        a + t * (b - a) + [0.0, 0.05 * np.sin(9 * t)]
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)
        for t in np.linspace(0, 1, 20, endpoint=False)
    ]
    return Mesh.from_loops([sides]), corners


def nearest(cage: Mesh, place: Any) -> float:
    return float(np.hypot(*(cage.vertices - place).T).min())


def test_pinned_corners_keep_a_vertex_on_each_level() -> None:
    fine, corners = wavy_square()
    for level in nested_cages(fine, [16, 12], pins=[0, 20, tuple(corners[2]), 60]):
        assert certified(level) and codes(level) == []
        assert max(nearest(level.cage, corner) for corner in corners) < 2e-3 * fine.diagonal


def test_a_pin_on_an_edge_and_a_joint_get_vertices() -> None:
    bar = resampled(Mesh.from_loops([[(0, 0), (6, 0), (6, 1), (0, 1)]]), 84)
    level = nested_cages(bar, 6, joints=[(2.5, 0.4)])[0]
    assert certified(level) and max(nearest(level.cage, (2.5, y)) for y in (0.0, 1.0)) < 1e-3
    assert min(nearest(nested_cages(bar, 6)[0].cage, (2.5, y)) for y in (0.0, 1.0)) > 0.1
    level = nested_cages(bar, 5, pins=[(3.3, -0.2)])[0]
    assert certified(level) and nearest(level.cage, (3.3, 0.0)) < 1e-3
    assert level.cage.area == pytest.approx(6.0, rel=1e-3)


@pytest.mark.slow
def test_more_pins_than_vertices_are_noted_with_the_farthest() -> None:
    fine = letter_a(6)
    pins = [int(k) for k in np.linspace(0, 400, 9)]
    level = nested_cages(fine, 8, pins=pins, loops="keep")[0]
    away = [nearest(level.cage, fine.vertices[pin]) for pin in pins]
    data = note(level, "note.pin").data
    assert certified(level) and data["pins"] == 9 and 0 < data["count"] <= 9
    assert data["distance"] == pytest.approx(max(away), rel=0.05)


# Limits


def test_no_edge_is_shorter_and_no_angle_sharper() -> None:
    level = nested_cages(letter_a(), 32, min_edge=0.3, symmetry=Mirror())[0]
    assert certified(level) and lengths_of(level.cage).min() >= 0.3
    level = nested_cages(letter_a(), 20, min_angle=40.0, symmetry=Mirror(), loops="keep")[0]
    assert certified(level) and sharpest(level.cage) >= 40.0


@pytest.mark.slow
def test_limits_without_room_mean_fewer_vertices_or_are_noted() -> None:
    level = nested_cages(Mesh.from_loops([ring(64)]), 40, min_edge=0.3)[0]
    assert certified(level) and lengths_of(level.cage).min() >= 0.3
    data = note(level, "note.count").data
    assert data["asked"] == 40 > data["given"] and "symmetry" not in data
    assert len(level.cage.vertices) <= 2.0 * np.pi / 0.3
    assert level.excess < 0.02
    large = nested_cages(Mesh.from_loops([ring(64)]), 3, min_edge=20.0)[0]
    assert certified(large) and lengths_of(large.cage).min() >= 20.0 and codes(large) == []
    filled, level = (nested_cages(annulus(60), 6, min_edge=20.0, loops=loops)[0] for loops in ("auto", "keep"))
    assert len(filled.cage.loops) == 1 and lengths_of(filled.cage).min() >= 20.0
    assert certified(level) and note(level, "note.edge").data["wanted"] == 20.0
    assert note(level, "note.edge").data["given"] == pytest.approx(lengths_of(level.cage).min())


def test_cages_inside_have_weights_and_limits_too() -> None:
    fine = letter_a()
    level = inner_cages(fine, 24, weights=heavy(fine), min_edge=0.2)[0]
    assert certified(level) and lengths_of(level.cage).min() >= 0.2
    assert excess_in(level.cage, fine, HEAD) < excess_in(inner_cages(fine, 24)[0].cage, fine, HEAD)
