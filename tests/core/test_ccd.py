"""Continuous collision detection on motions whose impacts are known; see also `test_ipctk.py`."""

from __future__ import annotations

import numpy as np
import pytest

from nestedcages_core.contact.ccd import impacts, largest_safe_step
from nestedcages_core.contact.pairs import Pairs


def pairs_of(count: int) -> Pairs:
    """count pairs over 3 count positions: p, a, b of the first, p, a, b of the second, …"""
    first = 3 * np.arange(count)
    return Pairs(first, first + 1, first + 2, slice(0, count), slice(count, count), slice(count, count))


def test_a_step_stops_short_of_the_wall() -> None:
    x = np.array([[0.5, 1.0], [0.0, 0.0], [1.0, 0.0]])
    v = np.array([[0.0, -2.0], [0.0, 0.0], [0.0, 0.0]])
    pairs = pairs_of(1)
    step = largest_safe_step(pairs, x, v, pairs.measure(x).distance)
    assert step == pytest.approx(0.45)
    assert pairs.measure(x + step * v).distance[0] > 0


def test_a_spinning_edge_hits() -> None:
    x = np.array([[0.5, 0.5], [0.0, 0.0], [1.0, 0.0]])
    v = np.array([[0.0, 0.0], [0.0, 0.0], [-1.0, 2.0]])
    pairs = pairs_of(1)
    hit, time = impacts(pairs, x, v, pairs.measure(x).distance)
    assert hit.tolist() == [0]
    assert time[0] == pytest.approx(1.0 / 3.0)


def collinear_motions(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions and displacements (3 count, 2) of pairs that stay on a moving line of any direction, and when they
    meet (count,), infinite if they do not."""
    random = np.random.default_rng(3)
    place, motion = random.normal(size=(count, 3)), random.normal(size=(count, 3))
    place[:, 0] = np.where(random.random(count) < 0.5, place[:, 1:].min(axis=1) - 0.1, place[:, 1:].max(axis=1) + 0.1)
    angle = random.uniform(0.0, 2.0 * np.pi, count)
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=1)[:, None]
    x = random.normal(size=(count, 1, 2)) + place[:, :, None] * direction
    v = random.normal(size=(count, 1, 2)) + motion[:, :, None] * direction
    to_ends = -(place[:, :1] - place[:, 1:]) / (motion[:, :1] - motion[:, 1:])
    meets = np.where((to_ends > 0.0) & (to_ends <= 1.0), to_ends, np.inf).min(axis=1)
    return x.reshape(-1, 2), v.reshape(-1, 2), meets


def test_collinear_motion_is_found_from_any_direction() -> None:
    count = 2000
    pairs = pairs_of(count)
    x, v, meets = collinear_motions(count)
    hit, time = impacts(pairs, x, v, pairs.measure(x).distance)
    expected = np.flatnonzero(np.isfinite(meets))
    assert len(expected) > 400
    found = np.full(count, np.inf)
    found[hit] = time
    assert (found[expected] <= meets[expected] + 1e-12).all()
    assert len(np.setdiff1d(hit, expected)) <= 0.02 * len(expected)  # ends that stop within the hit distance


@pytest.mark.parametrize("axis", [0, 1])
def test_a_point_stops_short_of_the_end_of_an_edge_on_its_own_line(axis: int) -> None:
    x, v = np.zeros((3, 2)), np.zeros((3, 2))
    x[:, axis] = 3.0, 0.0, 1.0
    v[0, axis] = -4.0
    pairs = pairs_of(1)
    hit, time = impacts(pairs, x, v, pairs.measure(x).distance)
    assert hit.tolist() == [0] and time[0] == pytest.approx(0.5)
    step = largest_safe_step(pairs, x, v, pairs.measure(x).distance)
    assert pairs.measure(x + step * v).distance[0] == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("x", "v"),
    [
        ([[0.5, 1e-9], [0.0, 0.0], [1.0, 0.0]], [[5.0, 5.0]] * 3),  # together
        ([[1.0 + 1e-7, 0.0], [0.0, 0.0], [1.0, 0.0]], [[0.1, 0.0], [0.0, 0.0], [0.0, 0.0]]),  # away, beyond an end
        # p = 2 b at all times, so the quadratic vanishes, and the edge never becomes a point
        ([[2.0, 0.0], [0.0, 0.0], [1.0, 0.0]], [[-3.0, 2.0], [0.0, 0.0], [-1.5, 1.0]]),
        ([[-1.0, 1e-6], [0.0, 0.0], [1.0, 0.0]], [[4.0, 0.0], [0.0, 0.0], [0.0, 0.0]]),  # along a wall next to it
    ],
)
def test_motions_without_an_impact_are_free(x: list[list[float]], v: list[list[float]]) -> None:
    pairs = pairs_of(1)
    assert largest_safe_step(pairs, np.array(x), np.array(v), pairs.measure(np.array(x)).distance) == 1.0
