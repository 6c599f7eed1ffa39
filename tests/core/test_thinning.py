"""Thinning only adds area, swallows nothing, and leaves what the progressive hull makes as good a hull of."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from nestedcages_core import Mesh, OuterHull, Settings, nested_cages
from nestedcages_core.decimation.hull import thinning
from nestedcages_core.decimation.hull.hull_search import ROUGH_WEIGHTS
from nestedcages_core.decimation.hull.progressive_hull import ProgressiveHull
from nestedcages_core.decimation.outline import Outline
from nestedcages_core.decimation.request import canonical_order
from shapes import assert_nested, polygon, ring

SIZE = 4000


def outline_of(mesh: Mesh) -> Outline:
    return canonical_order(mesh)[0]


def coast(seed: int, count: int, size: float = 1.0) -> np.ndarray:
    """A star-shaped loop with teeth of all sizes, (count, 2), of radius between 0.6 and 1 times a size."""
    random = np.random.default_rng(seed)
    angle = 2.0 * np.pi * np.arange(count) / count
    waves = np.unique(np.geomspace(2, count / 8, 30).astype(int))
    phase = random.uniform(0.0, 2.0 * np.pi, (len(waves), 1))
    height = (random.normal(size=(len(waves), 1)) / waves[:, None] * np.cos(waves[:, None] * angle + phase)).sum(axis=0)
    radius = 0.6 + 0.4 * (height - height.min()) / np.ptp(height)
    return size * radius[:, None] * np.stack((np.cos(angle), np.sin(angle)), axis=1)


def with_holes_and_islands() -> Mesh:
    """A rough outline with a rough hole, an island in that, another component, and a small loop next to them."""
    far = np.array([3.0, 0.0])
    loops = [coast(0, SIZE), coast(1, SIZE // 2, 0.5), coast(2, SIZE // 4, 0.2), coast(3, SIZE, 0.8) + far]
    return Mesh.from_loops([*loops, 0.01 * ring(9) + 0.5 * far])


def bays(teeth: int, depth: float, islands: bool) -> Mesh:
    """A square with many bays in its upper side, if wanted with a small island in each."""
    left = np.arange(teeth) / teeth
    x = np.stack((left, left + 0.5 / teeth, left + 0.5 / teeth, left + 1.0 / teeth), axis=1).ravel()
    y = np.tile((1.0, 1.0, 1.0 - depth, 1.0 - depth), teeth)
    loops = [np.concatenate(([(0.0, 0.0), (1.0, 0.0)], np.stack((x, y), axis=1)[::-1]))]
    if islands:
        loops += [0.1 / teeth * ring(4) + (place + 0.75 / teeth, 1.0 - 0.3 * depth) for place in left]
    return Mesh.from_loops(loops)


@pytest.mark.parametrize(
    ("shape", "left"),
    [
        (with_holes_and_islands, 800),
        (lambda: bays(1000, 0.01, islands=False), 800),
        (lambda: bays(400, 0.01, islands=True), 3202),  # each triangle has an island in it
    ],
)
def test_it_only_adds_area_and_swallows_nothing(shape, left: int) -> None:
    before = outline_of(shape())
    after = thinning.thinned(before, 100, [3] * len(before.sizes), ROUGH_WEIGHTS)
    assert len(after.vertices) == left
    assert min(after.sizes) >= 3
    mesh = Mesh.from_loops(after.loops)  # simple, by exact tests
    assert polygon(mesh).buffer(1e-12).covers(polygon(shape()))
    assert [len(loop) for loop in mesh.loops] == list(after.sizes)
    assert (mesh.loop_signs == [np.sign(shapely.Polygon(loop).exterior.is_ccw - 0.5) for loop in before.loops]).all()


def test_its_stretches_are_disjoint_and_in_order() -> None:
    before = outline_of(with_holes_and_islands())
    after = thinning.thinned(before, 100, [3] * len(before.sizes), ROUGH_WEIGHTS)
    for spans, size in zip(np.split(after.spans, after.begins[1:]), before.sizes, strict=True):
        first, last = spans[:, 0], spans[:, 1]
        assert (((last - first) % size).sum() + len(spans)) <= size
        assert (np.diff(first) > 0).all()
        assert (first[1:] > last[:-1]).all()


def test_small_outlines_and_small_loops_stay_as_they_are() -> None:
    small = outline_of(Mesh.from_loops([coast(0, thinning.LARGE - 1)]))
    assert thinning.thinned(small, 10, [3], ROUGH_WEIGHTS) is small
    crowd = Mesh.from_loops([0.3 * ring(8) + (k, j) for k in range(20) for j in range(20)])
    before = outline_of(crowd)
    after = thinning.thinned(before, 1200, [3] * 400, ROUGH_WEIGHTS)
    assert (after.vertices == before.vertices).all()


def test_each_loop_keeps_what_it_must() -> None:
    before = outline_of(with_holes_and_islands())
    minimum = [min(size, 900) for size in before.sizes]
    after = thinning.thinned(before, 10, minimum, ROUGH_WEIGHTS)
    assert all(size >= least for size, least in zip(after.sizes, minimum, strict=True))


@pytest.mark.parametrize("loop", [coast(1, SIZE), ring(SIZE)])
def test_the_hull_of_what_is_left_is_as_good(loop: np.ndarray) -> None:
    before = outline_of(Mesh.from_loops([loop]))
    straight = ProgressiveHull(before, ROUGH_WEIGHTS, [3]).run(64)
    after = thinning.thinned(before, 64, [3], ROUGH_WEIGHTS)
    assert len(after.vertices) == thinning.SIZE_FACTOR_LEFT * 64
    assert after.area / before.area - 1.0 < 0.2 * (straight.area / before.area - 1.0)
    hull = ProgressiveHull(after, ROUGH_WEIGHTS, [3]).run(64)
    assert hull.area / before.area - 1.0 < 1.2 * (straight.area / before.area - 1.0)


def test_a_turn_and_another_scale_change_round_off_only() -> None:
    mesh = Mesh.from_loops([coast(2, SIZE)])
    turn, shift = 1e3 * np.array([[0.6, 0.8], [-0.8, 0.6]]), np.array([5e3, -2e3])
    moved = Mesh(mesh.vertices @ turn + shift, mesh.edges)
    here, there = (thinning.thinned(outline_of(each), 40, [3], ROUGH_WEIGHTS) for each in (mesh, moved))
    assert there.vertices == pytest.approx(here.vertices @ turn + shift, abs=1e-8 * 1e3)


@pytest.mark.parametrize("decimation", [OuterHull(), None])
def test_cages_of_large_shapes_are_certified(decimation) -> None:
    fine = with_holes_and_islands()
    settings = Settings() if decimation is None else Settings(decimation=decimation)
    level = nested_cages(fine, [80], settings).levels[0]
    assert len(level.cage.vertices) == 80
    assert_nested(level.cage, fine)
