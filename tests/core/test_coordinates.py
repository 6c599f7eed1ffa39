"""Cage coordinates against closed forms, ray integrals and random walks; grids against what is linear."""

from contextlib import suppress

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import Harmonic, MeanValue, Mesh, PiecewiseLinear, cage_coordinates, deform, grids, nested_cages
from support.engines import areas
from support.judging import rejected
from support.shapes import annulus, islands, letter_a, polygon, ring, star

KINDS = [MeanValue(), Harmonic(), PiecewiseLinear()]
QUICK = Harmonic(spacing=1 / 48, at_corners=1 / 8)


@pytest.fixture(scope="module")
def nested() -> dict[str, tuple[Mesh, Mesh]]:
    pairs = {"letter": (letter_a(3), 40), "star": (star(7, 120), 24), "islands": (islands(), 40)}
    return {name: (fine, nested_cages(fine, [count]).cages[0]) for name, (fine, count) in pairs.items()}


def dense(weights: object) -> np.ndarray:
    return weights if isinstance(weights, np.ndarray) else weights.toarray()  # type: ignore[attr-defined]


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS, ids=repr)
@pytest.mark.parametrize("name", ["letter", "star", "islands"])
def test_rows_sum_to_one_without_negative_weights_and_the_cage_at_rest_gives_the_drawing(
    nested: dict[str, tuple[Mesh, Mesh]], name: str, kind: object
) -> None:
    fine, cage = nested[name]
    weights = cage_coordinates(fine, cage, kind)  # type: ignore[arg-type]
    assert weights.shape == (len(fine.vertices), len(cage.vertices))
    assert np.abs(dense(weights).sum(axis=1) - 1.0).max() < 1e-12
    assert np.abs(deform(weights, cage) - fine.vertices).max() < 1e-12
    if not isinstance(kind, MeanValue):  # those promise it
        assert dense(weights).min() >= 0.0 and dense(weights).max() <= 1.0 + 1e-12


@pytest.mark.slow
def test_each_component_follows_its_own_loops(nested: dict[str, tuple[Mesh, Mesh]]) -> None:
    fine, cage = nested["islands"]
    weights = cage_coordinates(fine, cage, QUICK)
    solids = [shapely.MultiPolygon([part]) for part in polygon(cage).geoms]
    for point, row in zip(fine.vertices, dense(weights), strict=True):
        (own,) = [solid for solid in solids if solid.covers(shapely.Point(point))]
        away = np.array([not own.intersects(shapely.Point(vertex)) for vertex in cage.vertices])
        assert row[away].max(initial=0.0) < 1e-15


def test_harmonic_coordinates_of_a_square_are_bilinear() -> None:
    square = Mesh.from_loops([[[0, 0], [1, 0], [1, 1], [0, 1]]])
    x, y = points = np.random.default_rng(0).random((2, 300))
    expected = np.stack([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y], axis=1)
    assert np.abs(cage_coordinates(points.T, square) - expected).max() < 2e-4


@pytest.mark.parametrize("kind", KINDS, ids=repr)
def test_all_coordinates_of_a_triangle_are_barycentric(kind: object) -> None:
    triangle = Mesh.from_loops([[[0, 0], [2, 0], [0, 4]]])
    share = np.random.default_rng(0).dirichlet((1.0, 1.0, 1.0), 50)
    weights = cage_coordinates(share @ triangle.vertices, triangle, kind)  # type: ignore[arg-type]
    assert np.abs(dense(weights) - share).max() < 1e-12


@pytest.mark.slow
def test_harmonic_coordinates_agree_with_random_walks() -> None:
    """A coordinate is the chance that a Brownian path leaves near its vertex (Kakutani); walks on spheres sample it."""
    cage = annulus(6, 0.4)
    walls = shapely.MultiLineString([np.append(cage.vertices[k], cage.vertices[k[:1]], axis=0) for k in cage.loops])
    rng = np.random.default_rng(4)
    start = np.array([0.35, 0.45])
    walkers = np.tile(start, (4000, 1))
    for _ in range(60):
        reach = shapely.distance(shapely.points(walkers), walls)
        turn = rng.uniform(0.0, 2.0 * np.pi, len(walkers))
        walkers += reach[:, None] * np.stack((np.cos(turn), np.sin(turn)), axis=1)
    a, b = cage.vertices, cage.vertices[cage.successor]
    along = b - a
    parameter = ((walkers[:, None] - a) * along).sum(axis=2) / (along * along).sum(axis=1)
    parameter = parameter.clip(0.0, 1.0)
    gap = np.linalg.norm(walkers[:, None] - a - parameter[:, :, None] * along, axis=2)
    edge = gap.argmin(axis=1)
    t = parameter[np.arange(len(walkers)), edge]
    expected = np.zeros(len(a))
    np.add.at(expected, edge, (1 - t) / len(walkers))
    np.add.at(expected, cage.successor[edge], t / len(walkers))
    found = cage_coordinates(start[None], cage)[0]
    assert np.abs(found - expected).max() < 0.03  # four standard deviations of 4000 walks


def test_mean_value_coordinates_are_the_mean_over_all_directions() -> None:
    """∫ f(hit) / r dθ over directions, hits counted by the sense in which the boundary is crossed."""
    cage = Mesh.from_loops([[[0, 0], [4, 0], [4, 3], [2, 1], [0, 3]], [[1.6, 0.3], [2.4, 0.3], [2, 0.7]]])
    point = np.array([0.7, 0.9])
    angles = (np.arange(40_000) + 0.5) * 2.0 * np.pi / 40_000
    direction = np.stack((np.cos(angles), np.sin(angles)), axis=1)
    expected = np.zeros(len(cage.vertices))
    for v, w in enumerate(cage.successor):
        a, along = cage.vertices[v] - point, cage.vertices[w] - cage.vertices[v]
        facing = direction[:, 0] * along[1] - direction[:, 1] * along[0]
        reach = (a[0] * along[1] - a[1] * along[0]) / facing
        t = (a[0] * direction[:, 1] - a[1] * direction[:, 0]) / facing
        hit = (reach > 0) & (t >= 0) & (t < 1)
        weight = np.sign(facing[hit]) / reach[hit]
        expected[v] += (weight * (1 - t[hit])).sum()
        expected[w] += (weight * t[hit]).sum()
    assert cage_coordinates(point[None], cage, MeanValue())[0] == pytest.approx(expected / expected.sum(), abs=1e-4)


def test_mean_value_coordinates_on_the_cage_are_linear_along_its_edges() -> None:
    cage = annulus(5, 0.5)
    middle = 0.25 * cage.vertices + 0.75 * cage.vertices[cage.successor]
    weights = cage_coordinates(np.concatenate((cage.vertices, middle)), cage, MeanValue())
    assert weights[:10] == pytest.approx(np.eye(10), abs=1e-12)
    assert weights[10:] == pytest.approx(0.25 * np.eye(10) + 0.75 * np.eye(10)[cage.successor], abs=1e-9)
    square = Mesh.from_loops([[(0, 0), (2, 0), (2, 2), (0, 2)]])
    assert cage_coordinates([(1.0, 0.0)], square, MeanValue()).tolist() == [[0.5, 0.5, 0.0, 0.0]]


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS, ids=repr)
@pytest.mark.parametrize(("scale", "shift"), [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e3)])
def test_coordinates_do_not_depend_on_place_and_scale(kind: object, scale: float, shift: float) -> None:
    cage, points = Mesh.from_loops([ring(7) + 0.1 * ring(7, angle=1.3) ** 2, 0.3 * ring(5, angle=0.2)]), 0.6 * ring(11)
    expected = dense(cage_coordinates(points, cage, kind))  # type: ignore[arg-type]
    moved = Mesh(scale * cage.vertices + shift, cage.edges)
    found = dense(cage_coordinates(scale * points + shift, moved, kind))  # type: ignore[arg-type]
    # Harmonic's triangles may differ where rounding decides between two equally good ones
    assert np.abs(found - expected).max() < (2e-3 if isinstance(kind, Harmonic) else 1e-9)


def test_many_poses_at_once() -> None:
    cage, points = annulus(6), 0.75 * ring(9)
    poses = np.random.default_rng(0).normal(size=(4, 2, len(cage.vertices), 3))
    for kind in (QUICK, PiecewiseLinear()):
        weights = cage_coordinates(points, cage, kind)
        moved = deform(weights, poses)
        assert moved.shape == (4, 2, 9, 3)
        assert moved[2, 1] == pytest.approx(dense(weights) @ poses[2, 1])


@pytest.mark.slow
def test_linear_coordinates_keep_the_drawing_inside_while_no_triangle_turns_over(
    nested: dict[str, tuple[Mesh, Mesh]],
) -> None:
    """Then the triangles of the posed cage tile its solid, and each point stays in its own: the guarantee."""
    rng = np.random.default_rng(3)
    for fine, cage in nested.values():
        weights = cage_coordinates(fine, cage, PiecewiseLinear())
        inside = shapely.points(rng.uniform(*np.reshape(cage.bounds, (2, 2)), size=(6000, 2)))
        inside = shapely.get_coordinates(inside[shapely.contains(polygon(cage), inside)])
        rows = dense(cage_coordinates(inside, cage, PiecewiseLinear()))
        found = {tuple(np.flatnonzero(row > 1e-9)) for row in rows}
        triangles = np.array([triangle for triangle in found if len(triangle) == 3])
        triangles = np.where(areas(cage.vertices, triangles)[:, None] > 0.0, triangles, triangles[:, ::-1])
        pose, poses = cage.vertices, 0
        for _ in range(300):
            trial = pose + 0.05 * cage.diagonal * rng.normal(size=pose.shape) * (rng.random((len(pose), 1)) < 0.1)
            upright = areas(trial, triangles) > 0.0
            with suppress(core.InvalidMeshError):  # a cage that crosses itself has no inside
                if upright.all() and cage.moved(trial).validated():
                    pose, poses = trial, poses + 1
        assert poses > 10
        solid = polygon(cage.moved(pose)).buffer(1e-9 * cage.diagonal)
        assert solid.covers(shapely.MultiPoint(deform(weights, pose)))


def test_harmonic_coordinates_keep_the_drawing_inside_a_convex_pose() -> None:
    """A harmonic map onto a convex shape is one to one (Radó, Kneser and Choquet): nothing leaves, nothing crosses."""
    fine = star(7, 120)
    cage = nested_cages(fine, [24]).cages[0]
    posed = cage.moved(ring(24, 1.5))
    moved = fine.moved(deform(cage_coordinates(fine, cage), posed))
    assert polygon(moved).is_valid
    assert polygon(posed).covers(polygon(moved))


@pytest.mark.slow
def test_prolongation_keeps_linear_functions_on_every_level() -> None:
    hierarchy = nested_cages(letter_a(3), [80, 40, 24])
    for spacing in (None, 0.2, [0.1, 0.3, 0.5, 1.0]):
        levels = grids(hierarchy, spacing)
        assert len(levels.grids) == 4
        for finer in range(4):
            for coarser in range(finer, 4):
                up = levels.prolongation(finer, coarser)
                assert up.data.min() >= 0.0
                assert np.abs(up.sum(axis=1) - 1.0).max() < 1e-12
                assert up @ levels.grids[coarser].vertices == pytest.approx(levels.grids[finer].vertices, abs=1e-12)
                assert (levels.restriction(finer, coarser) - up.T).nnz == 0
    assert np.diff(levels.prolongation(0, 1).indptr).max() <= 3


def test_prolongation_refuses_levels_that_are_not_there() -> None:
    hierarchy = nested_cages(star(5, 60), [20])
    levels = grids(hierarchy)
    for finer, coarser in ((0, 2), (1, 0)):
        with pytest.raises(core.NestedCagesError):
            levels.prolongation(finer, coarser)
    for spacing in (0.0, float("inf"), [1.0, 2.0, 3.0]):
        with rejected("setting.invalid"):
            grids(hierarchy, spacing)
