"""The broad phase finds exactly the pairs that measuring all of them finds."""

from __future__ import annotations

import numpy as np
import pytest

from nestedcages_core.geometry import broad_phase
from nestedcages_core.geometry.broad_phase import near_pairs
from nestedcages_core.geometry.distance import point_edge


def scene(seed: int, long_share: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points and edges, a share of them a hundred times as long as the others."""
    random = np.random.default_rng(seed)
    points, starts = random.uniform(size=(700, 2)), random.uniform(size=(400, 2))
    length = np.where(random.uniform(size=(400, 1)) < long_share, 0.5, 0.005)
    return points, starts, starts + length * random.normal(size=(400, 2))


def all_pairs(points: np.ndarray, starts: np.ndarray, ends: np.ndarray, radius: float) -> set[tuple[int, int]]:
    distance = point_edge(points[:, None], starts[None], ends[None]).distance
    return set(zip(*(k.tolist() for k in np.nonzero(distance < radius)), strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("radius", [1e-4, 0.003, 0.05, 0.5])
@pytest.mark.parametrize("long_share", [0.0, 0.1, 1.0])
def test_cells_find_each_close_pair_once(radius: float, long_share: float, monkeypatch: pytest.MonkeyPatch) -> None:
    points, starts, ends = scene(1, long_share)
    monkeypatch.setattr(broad_phase, "ALL_BOXES_LIMIT", 0)
    i, j = near_pairs(points, starts, ends, radius)
    found = list(zip(i.tolist(), j.tolist(), strict=True))
    assert len(found) == len(set(found))
    assert set(found) == all_pairs(points, starts, ends, radius)


def test_crowds_of_points_get_cells_of_their_own_size(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where long lines cross along a small circle: few pairs are close, and few are measured."""
    random = np.random.default_rng(3)
    angle = np.sort(random.uniform(0.0, 2.0 * np.pi, 1000))
    points = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    long = random.normal(size=(2, 150, 2)) * 30.0
    starts = np.concatenate((points, long[0]))
    ends = np.concatenate((np.roll(points, -1, axis=0), long[1]))
    measured = []

    measure = broad_phase._of_pairs

    def counted(*asked: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        measured.append(len(asked[-1]))
        return measure(*asked)

    monkeypatch.setattr(broad_phase, "_of_pairs", counted)
    found = set(zip(*(k.tolist() for k in near_pairs(points, starts, ends, 0.01)), strict=True))
    assert sum(measured) < 0.2 * len(points) * len(starts)
    assert found == all_pairs(points, starts, ends, 0.01)


def test_few_pairs_take_the_short_way(monkeypatch: pytest.MonkeyPatch) -> None:
    points, starts, ends = (part[:50] for part in scene(2, 0.1))
    short = near_pairs(points, starts, ends, 0.05)
    monkeypatch.setattr(broad_phase, "ALL_BOXES_LIMIT", 0)
    cells = near_pairs(points, starts, ends, 0.05)
    assert set(zip(*short, strict=True)) == set(zip(*cells, strict=True))


@pytest.mark.parametrize("radius", [1e-4, 0.003, 0.05])
@pytest.mark.parametrize("long_share", [0.0, 0.1])
def test_strips_find_what_boxes_find_in_the_same_order(
    radius: float, long_share: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    points, starts, ends = (part[:300] for part in scene(4, long_share))
    monkeypatch.setattr(broad_phase, "STRIP_COST", 1)
    strips = near_pairs(points, starts, ends, radius)
    monkeypatch.setattr(broad_phase, "STRIPS_FROM", np.inf)
    boxes = near_pairs(points, starts, ends, radius)
    np.testing.assert_array_equal(strips, boxes)
    assert set(zip(*boxes, strict=True)) == all_pairs(points, starts, ends, radius)


def test_small_chunks_lose_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    points, starts, ends = scene(3, 0.1)
    monkeypatch.setattr(broad_phase, "ALL_BOXES_LIMIT", 0)
    whole = near_pairs(points, starts, ends, 0.05)
    monkeypatch.setattr(broad_phase, "CHUNK_PAIRS", 100)
    chunked = near_pairs(points, starts, ends, 0.05)
    assert set(zip(*whole, strict=True)) == set(zip(*chunked, strict=True))


def test_nothing_is_near_nothing() -> None:
    nothing, one = np.zeros((0, 2)), np.zeros((1, 2))
    assert len(near_pairs(nothing, one, one + 1, 1.0)[0]) == 0
    assert len(near_pairs(one, nothing, nothing, 1.0)[0]) == 0
