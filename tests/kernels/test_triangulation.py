"""Triangulations against shapely and fractions: they tile the solid, keep its edges, are Delaunay inside."""

from fractions import Fraction

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core import InvalidMeshError, Mesh
from nestedcages_core.geometry.triangulation import Sampling, Triangulation, constrained_delaunay, triangulate
from support.judging import rejected
from support.marks import slow_after
from support.shapes import annulus, islands, letter_a, letter_a_coarse, polygon, ring, star

SHAPES = {
    "letter": letter_a_coarse(),
    "fine letter": letter_a(1),
    "star": star(9, 90),
    "islands": islands(),
    "thin annulus": annulus(48, 1.0 - 1e-7),
}
SAMPLINGS = {"none": None, "even": Sampling(0.15), "graded": Sampling(0.5, at_corners=1 / 4)}


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
    return float(-sine / (abs(sine) + abs(cosine)))


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
    after = np.append(order[1:], order[:1])
    ends = [order[begins[int(mesh.successor[edge])]] for edge in grid.edge[order]]
    return np.column_stack((order, np.where(grid.edge[after] == grid.edge[order], after, ends)))


@pytest.mark.parametrize("shape", slow_after(1, SHAPES))
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


@pytest.mark.parametrize("size", slow_after(1, [4, 9, 30]))
def test_points_on_a_grid_are_triangulated(size: int) -> None:
    """Where four of them lie on a circle everywhere, and lines of them on the boundary."""
    at = np.linspace(-1.0, 1.0, size)
    points = np.stack(np.meshgrid(at, at), axis=-1).reshape(-1, 2)
    low, high = np.arange(size), np.arange(size) + size * (size - 1)
    around = np.concatenate([low, low[1:] * size + size - 1, high[-2::-1], low[-2:0:-1] * size])
    segments = np.stack((around, np.roll(around, -1)), axis=1)
    triangles = constrained_delaunay(points, segments)
    assert_constrained_delaunay(points, triangles, segments)
    assert len(triangles) == 2 * (size - 1) ** 2
    assert len(np.unique(triangles)) == len(points)


@pytest.mark.parametrize("exponent", [-300, -20, 0, 20, 100])
def test_points_nearly_on_a_line_are_triangulated(exponent: int) -> None:
    """Flat within round-off, which floating-point triangulations give up on."""
    random = np.random.default_rng(0)
    t = np.sort(random.uniform(size=40))
    line = np.stack([t, 0.5 * t], axis=1)
    up = np.array([0.0, 1e-15])
    low = line + (0.3 * random.integers(0, 2, (40, 1)) - 1.0) * up
    loop = np.ldexp(np.concatenate([[[1.1, 0.55]], line[::-1] + up, [[-0.1, -0.05]], low]), exponent)
    mesh = Mesh.from_loops([loop])
    segments = np.stack((np.arange(len(loop)), mesh.successor), axis=1)
    assert_constrained_delaunay(mesh.vertices, triangulate(mesh).triangles, segments)


@pytest.mark.parametrize("examples", slow_after(0, [30, 3000], thorough_after=1))
def test_random_combs_are_triangulated(examples: int) -> None:
    @settings(max_examples=examples, deadline=None)
    @given(st.integers(0, 2**32 - 1))
    def one(seed: int) -> None:
        random = np.random.default_rng(seed)
        teeth = int(random.integers(2, 9))
        x = np.arange(2 * teeth) + random.uniform(-0.3, 0.3, 2 * teeth)
        y = np.where(np.arange(2 * teeth) % 2 == 0, 3.0, 10.0 ** random.uniform(-7, 0, 2 * teeth))
        mesh = Mesh.from_loops([np.concatenate((np.stack((x, y), axis=1), [[2.0 * teeth, 0.0], [-1.0, 0.0]]))])
        segments = np.stack((np.arange(len(mesh.vertices)), mesh.successor), axis=1)
        assert_constrained_delaunay(mesh.vertices, triangulate(mesh).triangles, segments)

    one()


SQUARE = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
AROUND = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])


@pytest.mark.parametrize(
    ("points", "segments", "code"),
    [
        (np.concatenate((SQUARE, SQUARE[2:3])), AROUND, "mesh.repeated_vertex"),
        (np.concatenate((SQUARE, [[2.0, 0.0]])), AROUND, "mesh.crossing"),
        (SQUARE, np.array([[0, 2], [2, 1], [1, 3], [3, 0]]), "mesh.crossing"),
    ],
    ids=["points at one place", "a point on a segment", "segments that cross"],
)
def test_points_and_segments_in_each_others_way_are_refused(
    points: np.ndarray, segments: np.ndarray, code: str
) -> None:
    with rejected(code, InvalidMeshError):
        constrained_delaunay(points, segments)


@pytest.mark.parametrize("wrong", [(0.0,), (1.0, 0.0), (1.0, 1.0, -0.5)], ids=str)
def test_a_sampling_is_checked(wrong: tuple[float, ...]) -> None:
    with rejected("setting.invalid"):
        Sampling(*wrong)


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
