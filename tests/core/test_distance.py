"""Point-edge distances against shapely, derivatives against central differences."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from benchmarks.li_2020.barrier import distance_hessian
from nestedcages_core.geometry.distance import PointEdge, distance_gradient, point_edge

STEP = 1e-6  # of central differences; coordinates are of order 1


@pytest.fixture
def corners() -> np.ndarray:
    """(300, 6) random (p, a, b); closest points both inside edges and at their ends."""
    return np.random.default_rng(3).normal(size=(300, 6))


def measured(corners: np.ndarray) -> PointEdge:
    return point_edge(corners[:, :2], corners[:, 2:4], corners[:, 4:])


def test_distances_agree_with_shapely(corners: np.ndarray) -> None:
    points = shapely.points(corners[:, :2])
    edges = shapely.linestrings(corners[:, 2:].reshape(-1, 2, 2))
    assert measured(corners).distance == pytest.approx(shapely.distance(points, edges), abs=1e-14)


def test_both_kinds_of_closest_point_occur(corners: np.ndarray) -> None:
    parameter = measured(corners).parameter
    assert ((parameter > 0) & (parameter < 1)).sum() > 50
    assert (parameter == 0).sum() > 50
    assert (parameter == 1).sum() > 50


def test_gradient_agrees_with_differences(corners: np.ndarray) -> None:
    gradient = distance_gradient(measured(corners))
    for k in range(6):
        step = np.eye(6)[k] * STEP
        slope = (measured(corners + step).distance - measured(corners - step).distance) / (2 * STEP)
        assert gradient[:, k] == pytest.approx(slope, abs=1e-7)


def test_hessian_agrees_with_differences_of_the_gradient(corners: np.ndarray) -> None:
    pairs = measured(corners)
    # a closest point near the end of its edge has a kink in its second derivative there
    smooth = (np.abs(pairs.parameter * (1 - pairs.parameter)) > 1e-4) | (pairs.parameter * (1 - pairs.parameter) == 0)
    hessian = distance_hessian(pairs, corners[:, 2:4], corners[:, 4:])
    scale = 1 + np.abs(hessian).max(axis=(1, 2))
    for k in range(6):
        step = np.eye(6)[k] * STEP
        forward, backward = distance_gradient(measured(corners + step)), distance_gradient(measured(corners - step))
        error = np.abs(hessian[:, k] - (forward - backward) / (2 * STEP)).max(axis=1) / scale
        assert error[smooth].max() < 1e-6


def test_a_point_on_its_edge_has_no_normal() -> None:
    pair = point_edge(np.array([[0.5, 0.0]]), np.array([[0.0, 0.0]]), np.array([[1.0, 0.0]]))
    assert pair.distance[0] == 0.0
    assert (pair.normal == 0.0).all()


def test_arrays_broadcast() -> None:
    points, starts = np.zeros((4, 1, 2)), np.ones((1, 3, 2))
    pair = point_edge(points, starts, starts + np.array([1.0, 0.0]))
    assert pair.distance.shape == (4, 3)
    assert pair.normal.shape == (4, 3, 2)
    assert pair.distance == pytest.approx(np.sqrt(2.0))
