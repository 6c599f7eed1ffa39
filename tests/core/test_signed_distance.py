"""Signed distance: value and sign against shapely, gradient against differences, rays through vertices, the tree."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core import Mesh
from nestedcages_core.geometry import broad_phase
from nestedcages_core.geometry.signed_distance import SignedDistance
from support.shapes import annulus, islands, letter_a, polygon, ring, square_with_hole, star

MESHES = {
    "annulus": annulus(24),
    "square": square_with_hole(),
    "letter": letter_a(),
    "star": star(),
    "islands": islands(),
}
BY_NAME = pytest.mark.parametrize("name", MESHES)


def probes(mesh: Mesh, count: int = 300) -> np.ndarray:
    """Points all over, and points level with the vertices, whose rays to the right meet these."""
    rng = np.random.default_rng(1)
    low, high = mesh.vertices.min(axis=0) - 0.2, mesh.vertices.max(axis=0) + 0.2
    anywhere = rng.uniform(low, high, (count, 2))
    level = np.stack([rng.uniform(low[0], high[0], len(mesh.vertices)), mesh.vertices[:, 1]], axis=1)
    return np.concatenate([anywhere, level])


def by_shapely(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    solid, at = polygon(mesh), shapely.points(points)
    return shapely.distance(solid.boundary, at) * np.where(shapely.contains(solid, at), -1.0, 1.0)


@BY_NAME
def test_distance_and_sign_are_those_of_shapely(name: str) -> None:
    mesh = MESHES[name]
    points = probes(mesh)
    found = SignedDistance.of(mesh).at(points)
    assert np.allclose(found.distance, by_shapely(mesh, points), rtol=0.0, atol=1e-14)


@BY_NAME
def test_tree_and_all_pairs_agree(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = MESHES[name]
    points = probes(mesh)
    answers = []
    for limit in (10**9, 0):
        monkeypatch.setattr(broad_phase, "TREE_COST", 0)
        monkeypatch.setattr(broad_phase, "TREE_START", limit)
        answers.append(SignedDistance.of(mesh).at(points))
    assert np.allclose(answers[0].distance, answers[1].distance, rtol=0.0, atol=1e-14)
    # where two edges are equally near, either may be named
    same = answers[0].edge == answers[1].edge
    assert same.mean() > 0.5
    assert np.allclose(answers[0].parameter[same], answers[1].parameter[same])


def test_tree_with_edges_of_very_different_lengths(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(broad_phase, "TREE_COST", 0)
    monkeypatch.setattr(broad_phase, "TREE_START", 0)
    fine_arc = ring(400)[:100]
    mesh = Mesh.from_loops([np.concatenate([fine_arc, [(-5.0, -5.0), (6.0, -5.0)]])])
    points = probes(mesh, 1000)
    assert np.allclose(SignedDistance.of(mesh).at(points).distance, by_shapely(mesh, points), rtol=0.0, atol=1e-13)


def test_tree_beyond_the_tips_of_spikes(monkeypatch: pytest.MonkeyPatch) -> None:
    """There all of an edge but its end may be farther away than many places of other edges."""
    monkeypatch.setattr(broad_phase, "TREE_COST", 0)
    monkeypatch.setattr(broad_phase, "TREE_START", 0)
    random = np.random.default_rng(1)
    angles, radii = np.sort(random.uniform(0.0, 2.0 * np.pi, 200)), random.uniform(0.2, 1.0, 200)
    spikes = radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    points = (spikes[:, None] + random.normal(0.0, 0.03, (200, 20, 2))).reshape(-1, 2)
    mesh = Mesh.from_loops([spikes])
    found = SignedDistance.of(mesh).search.closest(points).distance
    assert np.allclose(found, np.abs(by_shapely(mesh, points)), rtol=0.0, atol=1e-13)


@BY_NAME
def test_gradient_is_the_derivative_of_the_distance(name: str) -> None:
    mesh = MESHES[name]
    field, points, step = SignedDistance.of(mesh), probes(mesh), 1e-6
    gradient = field.at(points).gradient
    assert np.allclose(np.hypot(*gradient.T), 1.0)
    differences = np.stack(
        [
            (field.at(points + step * axis).distance - field.at(points - step * axis).distance) / (2.0 * step)
            for axis in np.eye(2)
        ],
        axis=1,
    )
    smooth = np.abs(np.hypot(*differences.T) - 1.0) < 1e-6  # not across a ridge of the distance
    assert smooth.mean() > 0.9
    assert np.allclose(gradient[smooth], differences[smooth], atol=1e-5)


def test_on_the_boundary_the_gradient_is_the_outward_normal() -> None:
    mesh = square_with_hole()
    ends = mesh.vertices[mesh.successor]
    middle = 0.5 * (mesh.vertices + ends)
    found = SignedDistance.of(mesh).at(middle)
    assert (found.distance == 0.0).all()
    solid = polygon(mesh)
    assert not shapely.contains_xy(solid, middle + 1e-6 * found.gradient).any()
    assert shapely.contains_xy(solid, middle - 1e-6 * found.gradient).all()


def test_a_point_at_a_vertex_is_on_the_boundary() -> None:
    mesh = letter_a()
    assert (SignedDistance.of(mesh).at(mesh.vertices).distance == 0.0).all()


def test_a_hole_alone_has_its_solid_outside() -> None:
    hole = ring(12)[::-1]
    field = SignedDistance(hole, np.roll(hole, -1, axis=0), outside=-1)
    found = field.at(np.array([[0.0, 0.0], [2.0, 0.1]]))
    assert found.distance[0] > 0.0 > found.distance[1]
    assert np.allclose(found.gradient[1], -np.array([2.0, 0.1]) / np.hypot(2.0, 0.1), atol=0.3)


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(
    heights=st.lists(st.integers(-4, 4), min_size=5, max_size=12),
    points=st.lists(st.tuples(st.integers(-9, 9), st.integers(-9, 9)), min_size=1, max_size=20),
)
def test_rays_through_vertices_and_along_edges(heights: list[int], points: list[tuple[int, int]]) -> None:
    """Corners and points share a small grid, so that rays meet corners, run along edges and touch tips."""
    top = [(2.0 * k - len(heights), float(height)) for k, height in enumerate(heights)]
    mesh = Mesh.from_loops([[*top[::-1], (-len(heights) - 1.0, -9.0), (len(heights) + 1.0, -9.0)]])
    at = np.array(points, dtype=float)
    solid = polygon(mesh)
    apart = shapely.distance(solid.boundary, shapely.points(at)) > 1e-12
    found = SignedDistance.of(mesh).at(at)
    assert ((found.distance < 0.0) == shapely.contains_xy(solid, at))[apart].all()
    assert (np.abs(found.distance[~apart]) < 1e-12).all()
