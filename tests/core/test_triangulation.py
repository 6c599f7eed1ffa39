"""Triangulations against shapely and fractions: they tile the solid, keep its edges, are Delaunay inside."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core import InvalidMeshError, Mesh
from nestedcages_core.geometry.triangulation import (
    Sampling,
    Triangulation,
    constrained,
    constrained_delaunay,
    triangulate,
)
from support.shapes import annulus, islands, letter_a, letter_a_coarse, polygon, ring, star

SHAPES = {
    "letter": letter_a_coarse(),
    "fine letter": letter_a(1),
    "star": star(9, 90),
    "islands": islands(),
    "thin annulus": annulus(48, 1.0 - 1e-7),
}
SAMPLINGS = {
    "none": None,
    "even": Sampling(0.15),
    "graded": Sampling(0.5, at_corners=1 / 4),
}


def excess_angle(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> float:
    """Angles at c and d opposite to the edge a-b, less π: positive if d is inside the circle through a, b, c.

    The sine of their sum by exact arithmetic, so that the slimmest triangles are judged rightly.
    """
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = (tuple(map(Fraction, point.tolist())) for point in (a, b, c, d))
    dot_c, dot_d = ((ax - x) * (bx - x) + (ay - y) * (by - y) for x, y in ((cx, cy), (dx, dy)))
    cross_c = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
    cross_d = (bx - dx) * (ay - dy) - (by - dy) * (ax - dx)
    assert cross_c > 0
    assert cross_d > 0
    sine, cosine = cross_c * dot_d + dot_c * cross_d, dot_c * dot_d - cross_c * cross_d
    return float(-sine) / float(abs(sine) + abs(cosine))


def assert_constrained_delaunay(points: np.ndarray, triangles: np.ndarray, segments: np.ndarray) -> None:
    apex = {}
    for u, v, w in triangles.tolist():
        for edge, corner in (((u, v), w), ((v, w), u), ((w, u), v)):
            assert edge not in apex
            apex[edge] = corner
    fixed = {tuple(segment) for segment in segments.tolist()}
    assert {edge for edge in apex if edge[::-1] not in apex} == fixed
    for (u, v), w in apex.items():
        if (v, u) in apex:
            assert excess_angle(*points[[u, v, w, apex[v, u]]]) < 1e-12


def boundary_segments(grid: Triangulation, mesh: Mesh) -> np.ndarray:
    order = np.lexsort((grid.parameter, grid.edge))
    begins = {int(grid.edge[k]): i for i, k in enumerate(order) if grid.parameter[k] == 0.0}
    return np.array(
        [
            (
                k,
                order[i + 1]
                if i + 1 < len(order) and grid.edge[order[i + 1]] == grid.edge[k]
                else order[begins[int(mesh.successor[grid.edge[k]])]],
            )
            for i, k in enumerate(order)
        ]
    )


@pytest.mark.slow
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("sampling", SAMPLINGS)
def test_the_triangles_tile_the_solid_and_are_delaunay(shape: str, sampling: str) -> None:
    mesh = SHAPES[shape]
    grid = triangulate(mesh, SAMPLINGS[sampling])
    assert (grid.vertices[: len(mesh.vertices)] == mesh.vertices).all()
    assert (grid.areas > 0.0).all()
    assert grid.areas.sum() == pytest.approx(mesh.area, rel=1e-8)
    assert_constrained_delaunay(grid.vertices, grid.triangles, boundary_segments(grid, mesh))
    solid = polygon(mesh)
    assert shapely.covers(solid.buffer(1e-9), shapely.points(grid.vertices[grid.triangles].mean(axis=1))).all()


def test_the_spacing_is_kept() -> None:
    mesh = letter_a_coarse()
    grid = triangulate(mesh, Sampling(0.1))
    corners = grid.vertices[grid.triangles]
    lengths = np.hypot(*np.moveaxis(corners - np.roll(corners, 1, axis=1), 2, 0))
    assert lengths.max() < 0.25
    assert np.median(lengths) > 0.07


@pytest.mark.slow
def test_coarse_parts_of_a_fine_mesh_are_graded() -> None:
    mesh = Mesh.from_loops([ring(2000)])
    assert len(triangulate(mesh, Sampling(0.1)).vertices) < 12_000


@pytest.mark.parametrize("gap", [1e-9, 1e-12, 1e-15])
def test_gaps_of_rounding_size_are_triangulated(gap: float) -> None:
    mesh = annulus(24, 1.0 - gap)
    grid = triangulate(mesh)
    segments = np.stack((np.arange(48), mesh.successor), axis=1)
    assert_constrained_delaunay(grid.vertices, grid.triangles, segments)
    assert len(grid.triangles) == 48


def test_a_sweep_replaces_qhull_where_that_gives_up(monkeypatch: pytest.MonkeyPatch) -> None:
    inside = np.random.default_rng(0).uniform(-0.6, 0.6, (120, 2))
    grid = np.stack(np.meshgrid(np.linspace(-0.5, 0.5, 9), np.linspace(-0.5, 0.5, 9)), axis=-1).reshape(-1, 2)
    segments = np.stack((np.arange(32), (np.arange(32) + 1) % 32), axis=1)
    monkeypatch.setattr(constrained, "_is_valid", lambda *_: False)
    for points in (inside, grid):
        together = np.concatenate((ring(32), points))
        triangles = constrained_delaunay(together, segments)
        assert_constrained_delaunay(together, triangles, segments)
        assert len(np.unique(triangles)) == len(together)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_random_combs_are_triangulated(seed: int) -> None:
    rng = np.random.default_rng(seed)
    teeth = int(rng.integers(2, 9))
    x = np.arange(2 * teeth) + rng.uniform(-0.3, 0.3, 2 * teeth)
    y = np.where(np.arange(2 * teeth) % 2 == 0, 3.0, 10.0 ** rng.uniform(-7, 0, 2 * teeth))
    mesh = Mesh.from_loops([np.concatenate((np.stack((x, y), axis=1), [[2.0 * teeth, 0.0], [-1.0, 0.0]]))])
    grid = triangulate(mesh)
    segments = np.stack((np.arange(len(mesh.vertices)), mesh.successor), axis=1)
    assert_constrained_delaunay(grid.vertices, grid.triangles, segments)


def test_points_and_segments_in_each_others_way_are_refused() -> None:
    square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    loop = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    with pytest.raises(InvalidMeshError, match=r"Two points lie at \(4, 4\)"):
        constrained_delaunay(np.concatenate((square, square[2:3])), loop)
    with pytest.raises(InvalidMeshError, match=r"from \(0, 0\) to \(4, 0\) meets .* \(2, 0\)"):
        constrained_delaunay(np.concatenate((square, [[2.0, 0.0]])), loop)
    with pytest.raises(InvalidMeshError, match="meets another one"):
        constrained_delaunay(square, np.array([[0, 2], [2, 1], [1, 3], [3, 0]]))


def test_interpolation_is_linear_and_finds_every_point() -> None:
    mesh = letter_a(2)
    for sampling in (None, Sampling(0.3, 1 / 2)):
        grid = triangulate(mesh, sampling)
        rng = np.random.default_rng(1)
        chosen = rng.integers(len(grid.triangles), size=500)
        share = rng.dirichlet((1.0, 1.0, 1.0), 500)
        points = (share[:, :, None] * grid.vertices[grid.triangles[chosen]]).sum(axis=1)
        matrix = grid.interpolation(points)
        assert matrix.data.min() >= 0.0
        assert np.diff(matrix.indptr).max() <= 3
        assert matrix @ grid.vertices == pytest.approx(points, abs=1e-13)
        at_vertices = grid.interpolation(grid.vertices)
        assert at_vertices.diagonal() == pytest.approx(np.ones(len(grid.vertices)), abs=1e-9)


def test_stiffness_and_mass_integrate_quadratics() -> None:
    """For linear u, v: uᵀ K v = ∫ ∇u·∇v and uᵀ M v = ∫ u v, here by moments of the polygon."""
    mesh = letter_a_coarse()
    grid = triangulate(mesh, Sampling(0.3))
    x, y = grid.vertices.T
    area = mesh.area
    assert x @ (grid.stiffness() @ x) == pytest.approx(area)
    assert x @ (grid.stiffness() @ y) == pytest.approx(0.0, abs=1e-12)
    assert np.abs(grid.stiffness() @ np.ones(len(x))).max() < 1e-12
    assert np.ones(len(x)) @ (grid.mass() @ np.ones(len(x))) == pytest.approx(area)
    a, b = mesh.vertices, mesh.vertices[mesh.successor]
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    second_moment = (cross * (a[:, 0] ** 2 + a[:, 0] * b[:, 0] + b[:, 0] ** 2)).sum() / 12.0
    assert x @ (grid.mass() @ x) == pytest.approx(second_moment)
