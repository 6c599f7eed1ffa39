"""Collisions, distances, barriers and contacts against IPC Toolkit and finite differences; needs ipctk."""

from typing import Any

import numpy as np
import pytest
import shapely

from nestedcages_core import Area, Mesh
from nestedcages_core.contact.barrier import barrier, barrier_hessian_factors
from nestedcages_core.contact.ccd import SAFETY, impacts, largest_safe_step
from nestedcages_core.contact.incremental_potential import IncrementalPotential, PotentialWeights
from nestedcages_core.contact.linearisation import constraint_rows, distance_change, measure, resolve_corners
from nestedcages_core.contact.pairs import Bodies, CandidateList, Pairs, find_pairs
from nestedcages_core.contact.pruning import not_implied
from nestedcages_core.geometry.distance import PointEdge, distance_gradient, point_edge
from nestedcages_core.tightening.quadratic_model import EdgeLoads, contact_curvature
from support.marks import slow_after
from support.shapes import annulus, derivative, letter_a, letter_a_coarse, ring

ipctk = pytest.importorskip("ipctk")

# Distances


@pytest.fixture
def corners() -> np.ndarray:
    """(300, 6) random (p, a, b); closest points both inside edges and at their ends."""
    return np.random.default_rng(3).normal(size=(300, 6))


def measured(corners: np.ndarray) -> PointEdge:
    return point_edge(corners[:, :2], corners[:, 2:4], corners[:, 4:])


def distance_hessians(corners: np.ndarray) -> np.ndarray:
    """(K, 6, 6) by IPC Toolkit, which squares the distance: ∂²(d²) = 2 (∂d ∂dᵀ + d ∂²d)."""
    pair, hessians = measured(corners), []
    for k, slope in enumerate(distance_gradient(pair)):
        squared = ipctk.point_edge_distance_hessian(*corners[k].reshape(3, 2))
        hessians.append((0.5 * squared - np.outer(slope, slope)) / pair.distance[k])
    return np.array(hessians)


def test_distances_are_those_of_shapely(corners: np.ndarray) -> None:
    edges = shapely.linestrings(corners[:, 2:].reshape(-1, 2, 2))
    pair = measured(corners)
    assert pair.distance == pytest.approx(shapely.distance(shapely.points(corners[:, :2]), edges), abs=1e-14)
    nearest = corners[:, :2] - pair.distance[:, None] * pair.normal
    assert nearest == pytest.approx(
        shapely.get_coordinates(shapely.line_interpolate_point(edges, pair.parameter, normalized=True)), abs=1e-13
    )
    for place in (pair.parameter == 0.0, pair.parameter == 1.0, (pair.parameter > 0.0) & (pair.parameter < 1.0)):
        assert place.sum() > 50


def test_derivatives_of_distances_are_those_of_ipc_toolkit(corners: np.ndarray) -> None:
    """IPC Toolkit squares the distance: ∂(d²) = 2 d ∂d."""
    pair = measured(corners)
    for k, slope in enumerate(distance_gradient(pair)):
        three = corners[k].reshape(3, 2)
        assert pair.distance[k] ** 2 == pytest.approx(ipctk.point_edge_distance(*three))
        theirs = ipctk.point_edge_distance_gradient(*three)
        np.testing.assert_allclose(2.0 * pair.distance[k] * slope, theirs, rtol=1e-9, atol=1e-12)


def test_a_point_on_its_edge_has_no_normal_and_arrays_broadcast() -> None:
    pair = point_edge(np.array([[0.5, 0.0]]), np.array([[0.0, 0.0]]), np.array([[1.0, 0.0]]))
    assert pair.distance[0] == 0.0
    assert (pair.normal == 0.0).all()
    points, starts = np.zeros((4, 1, 2)), np.ones((1, 3, 2))
    pair = point_edge(points, starts, starts + np.array([1.0, 0.0]))
    assert pair.normal.shape == (4, 3, 2)
    assert pair.distance == pytest.approx(np.full((4, 3), np.sqrt(2.0)))


# Continuous collision detection


def pairs_of(count: int) -> Pairs:
    """count pairs over 3 count positions: p, a, b of the first, p, a, b of the second, …"""
    first = 3 * np.arange(count)
    return Pairs(first, first + 1, first + 2, slice(0, count), slice(count, count), slice(count, count))


def first_impacts(x: np.ndarray, v: np.ndarray, clearance: float = np.inf) -> np.ndarray:
    """(K,) times of the pairs at x (3 K, 2) that move by v; infinite without an impact."""
    pairs = pairs_of(len(x) // 3)
    hit, time = impacts(pairs, x, v, pairs.measure(x).distance, clearance)
    found = np.full(len(x) // 3, np.inf)
    found[hit] = time
    return found


def safe_step(x: Any, v: Any) -> tuple[float, float]:
    """Of one pair, and its distance after that."""
    x, v, pairs = np.array(x, float), np.array(v, float), pairs_of(1)
    step = largest_safe_step(pairs, x, v, pairs.measure(x).distance)
    return step, float(pairs.measure(x + step * v).distance[0])


WALL = [[0.5, 1.0], [0.0, 0.0], [1.0, 0.0]]


@pytest.mark.parametrize(
    ("x", "v", "time", "left"),
    [
        (WALL, [[0, -2], [0, 0], [0, 0]], 0.5, 0.1),
        (WALL, [[0, 0], [0, 2], [0, 2]], 0.5, 0.1),
        ([[0.5, 0.5], [0, 0], [1, 0]], [[0, 0], [0, 0], [-1, 2]], 1 / 3, None),  # a spinning edge
        ([[3, 0], [0, 0], [1, 0]], [[-4, 0], [0, 0], [0, 0]], 0.5, 0.2),  # on its own line, to an end of the edge
        ([[0, 3], [0, 0], [0, 1]], [[0, -4], [0, 0], [0, 0]], 0.5, 0.2),
    ],
)
def test_a_step_stops_short_of_an_impact(x: Any, v: Any, time: float, left: float | None) -> None:
    assert first_impacts(np.array(x, float), np.array(v, float))[0] == pytest.approx(time)
    step, distance = safe_step(x, v)
    assert step == pytest.approx(SAFETY * time)
    assert distance > 0.0 if left is None else distance == pytest.approx(left)


@pytest.mark.parametrize(
    ("x", "v"),
    [
        ([[0.5, 1e-9], [0.0, 0.0], [1.0, 0.0]], [[5.0, 5.0]] * 3),  # together
        ([[1.0 + 1e-7, 0.0], [0.0, 0.0], [1.0, 0.0]], [[0.1, 0.0], [0.0, 0.0], [0.0, 0.0]]),  # away, beyond an end
        # p = 2 b at all times, so the quadratic vanishes, and the edge never becomes a point
        ([[2.0, 0.0], [0.0, 0.0], [1.0, 0.0]], [[-3.0, 2.0], [0.0, 0.0], [-1.5, 1.0]]),
        ([[-1.0, 1e-6], [0.0, 0.0], [1.0, 0.0]], [[4.0, 0.0], [0.0, 0.0], [0.0, 0.0]]),  # along a wall
    ],
)
def test_motions_without_an_impact_are_free(x: Any, v: Any) -> None:
    assert safe_step(x, v)[0] == 1.0


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
    x, v, meets = collinear_motions(2000)
    expected, found = np.isfinite(meets), first_impacts(x, v)
    assert expected.sum() > 400
    assert (found[expected] <= meets[expected] + 1e-12).all()
    assert (np.isfinite(found) & ~expected).sum() <= 0.02 * expected.sum()  # ends that stop within the hit distance


@pytest.mark.parametrize("count", slow_after(1, [400, 20_000], thorough_after=1))
def test_times_of_impact_are_those_of_ipc_toolkit(count: int) -> None:
    x, v = np.random.default_rng(3).normal(size=(2, 3 * count, 2))
    ours = first_impacts(x, v, 1e-12)
    corners = [(x[3 * k : 3 * k + 3], (x + v)[3 * k : 3 * k + 3]) for k in range(count)]
    theirs = [ipctk.inexact_point_edge_ccd_2D(*before, *after, 1.0) for before, after in corners]
    met = np.array([hit for hit, _ in theirs])
    assert met.sum() > count // 10
    assert np.array_equal(met, np.isfinite(ours))
    assert np.abs(ours[met] - np.array([time for _, time in theirs])[met]).max() <= 1e-12


@pytest.mark.parametrize("motion", slow_after(1, ["random", "collinear"]))
def test_no_step_goes_beyond_an_impact(motion: str) -> None:
    count = 600 if motion == "random" else 30  # the interval search of IPC Toolkit takes long on a line
    x, v = np.random.default_rng(2).normal(size=(2, 3 * count, 2))
    if motion == "collinear":
        x, v, _ = collinear_motions(count)
    found = first_impacts(x, v)
    ccd = ipctk.TightInclusionCCD(tolerance=1e-9)
    theirs = [ccd.point_edge_ccd(*x[3 * k : 3 * k + 3], *(x + v)[3 * k : 3 * k + 3]) for k in range(count)]
    met, when = np.array([hit for hit, _ in theirs]), np.array([time for _, time in theirs])
    assert met.sum() > 10
    assert (SAFETY * found[met] <= when[met]).all()  # the steps that are taken end before their impacts
    assert np.count_nonzero(np.isfinite(found) & ~met) <= 0.35 * met.sum()  # near misses of an end count, by design


# The barrier

D_HAT = 0.3


def test_the_barrier_and_its_derivatives_are_those_of_ipc_toolkit() -> None:
    random = np.random.default_rng(0)
    d_hat = random.uniform(1e-3, 1.0, 300)
    distance = d_hat * random.uniform(1e-6, 1.2, 300)
    terms = barrier(distance, d_hat)
    theirs = ipctk.ClampedLogBarrier()
    for name, method in (("value", theirs), ("first", theirs.first_derivative), ("second", theirs.second_derivative)):
        expected = [method(float(d), float(limit)) for d, limit in zip(distance, d_hat, strict=True)]
        np.testing.assert_allclose(getattr(terms, name), expected, rtol=1e-10, atol=1e-15)


def test_the_barrier_vanishes_smoothly_at_its_range_and_is_infinite_at_contact() -> None:
    terms = barrier(np.array([D_HAT, 1.0, 0.0]), D_HAT)
    assert terms.value.tolist() == [0.0, 0.0, np.inf]
    assert terms.first[:2].tolist() == terms.second[:2].tolist() == [0.0, 0.0]


def test_the_projected_hessian_is_semi_definite_no_less_than_the_hessian_and_exact_at_ends() -> None:
    random = np.random.default_rng(5)
    corners = random.normal(size=(2000, 6))
    corners = corners[measured(corners).distance < D_HAT]
    pair, weight = measured(corners), random.uniform(0.5, 2.0, len(corners))
    terms = barrier(pair.distance, D_HAT)
    gradient = distance_gradient(pair)
    outer = gradient[:, :, None] * gradient[:, None, :]
    bend = distance_hessians(corners)
    exact = weight[:, None, None] * (terms.second[:, None, None] * outer + terms.first[:, None, None] * bend)
    factors = barrier_hessian_factors(terms, weight, pair, corners[:, 2:4], corners[:, 4:])
    projected = factors.transpose(0, 2, 1) @ factors
    size = np.abs(exact).max(axis=(1, 2))
    assert (np.linalg.eigvalsh(projected)[:, 0] > -1e-9 * size).all()
    assert (np.linalg.eigvalsh(projected - exact)[:, 0] > -1e-9 * size).all()
    values, vectors = np.linalg.eigh(exact)
    positive = (vectors * np.maximum(values, 0)[:, None, :]) @ vectors.transpose(0, 2, 1)
    end = (pair.parameter <= 0) | (pair.parameter >= 1)
    assert np.abs(projected - positive)[end].max() <= 1e-9 * np.abs(exact[end]).max()
    assert (np.trace(projected - positive, axis1=1, axis2=2) <= 3.0 * np.trace(positive, axis1=1, axis2=2)).all()


def test_the_potential_has_its_derivative_and_descends_along_newton_directions() -> None:
    """A shrunk annulus in a coarse one, with barriers of all three families at work."""
    fine, coarse = (mesh.moved(mesh.vertices / np.sqrt(8.0)) for mesh in (annulus(40), annulus(8)))
    bodies = Bodies.of(coarse, fine)
    start = fine.vertices * np.where(np.arange(80) < 40, 0.85, 1.15)[:, None]
    x = np.concatenate([coarse.vertices, start])
    x += 0.004 * np.random.default_rng(3).normal(size=x.shape)
    weights = PotentialWeights(500.0, 1.0, 1.0)
    potential = IncrementalPotential(bodies, Area(), fine.vertices, weights, 0.3, CandidateList(bodies))
    pairs = find_pairs(bodies, x, 0.3)
    for family in (pairs.fine_cage, pairs.cage_fine, pairs.cage_cage):
        assert (pairs.measure(x).distance < 0.3)[family].any()
    for _ in range(3):
        model = potential.newton(x)
        assert model.value == pytest.approx(potential.value(x), rel=1e-12)
        numeric = derivative(potential.value, x, 1e-7)
        assert model.gradient == pytest.approx(numeric, abs=1e-5 * np.abs(numeric).max())
        assert float((model.gradient * model.direction).sum()) < 0.0
        x = x + 0.5 * potential.largest_step(x, model.direction) * model.direction
        assert np.isfinite(potential.value(x))


# Contacts as constraints


@pytest.fixture
def around() -> tuple[Bodies, np.ndarray, Pairs]:
    """A letter inside a wider copy of its coarse outline: contacts of all kinds."""
    fine, coarse = letter_a(3), letter_a_coarse()
    bodies = Bodies.of(coarse, fine)
    cage = coarse.vertices + 0.05 * np.random.default_rng(4).normal(size=coarse.vertices.shape)
    x = np.concatenate([cage, fine.vertices])
    return bodies, x, find_pairs(bodies, x, 0.5)


def rows_as_matrix(bodies: Bodies, pairs: Pairs, contacts: Any) -> np.ndarray:
    """(K, 2m) from the groups of rows."""
    lines = []
    for group in constraint_rows(pairs, contacts):
        matrix = np.zeros((group.count, bodies.m, 2))
        for vertex, weight in zip(group.vertex, group.weight, strict=True):
            np.add.at(matrix, (np.arange(group.count), vertex), (weight * group.direction).T)
        lines.append(matrix.reshape(group.count, -1))
    return np.concatenate(lines)


@pytest.mark.parametrize("moving", ["cage", "all"])
def test_contacts_have_the_derivatives_of_their_distances(around: Any, moving: str) -> None:
    bodies, x, pairs = around
    motion = np.random.default_rng(0).normal(size=x.shape)
    if moving == "cage":
        motion[bodies.m :] = 0.0
    h = 1e-6
    difference = (measure(pairs, x + h * motion).distance - measure(pairs, x - h * motion).distance) / (2 * h)
    contacts = measure(pairs, x)
    from_middle = np.abs(contacts.parameter - 0.5)
    smooth = ((from_middle < 0.5 - 1e-3) | (from_middle == 0.5)) & (contacts.distance > 1e-2)
    assert smooth.sum() > 100
    slope = distance_change(pairs, contacts, motion)
    np.testing.assert_allclose(slope[smooth], difference[smooth], atol=1e-5)
    if moving == "cage":
        rows = rows_as_matrix(bodies, pairs, contacts)
        np.testing.assert_allclose(rows @ motion[: bodies.m].ravel(), slope, atol=1e-12)


def test_curvature_is_the_second_derivative_of_the_loaded_distances(around: Any) -> None:
    bodies, x, pairs = around
    random, contacts = np.random.default_rng(2), measure(pairs, x)
    inner = np.zeros(len(pairs), bool)
    inner[pairs.fine_cage] = True
    inner &= contacts.on_line & (contacts.side > 0) & (np.abs(contacts.parameter - 0.5) < 0.45)
    pairs, contacts = pairs.take(inner), contacts.take(inner)
    z = random.uniform(0.1, 1.0, len(pairs))
    H = contact_curvature(bodies, x[: bodies.m], EdgeLoads.of(pairs, contacts, z, bodies.m), 0.0).dense(bodies.m)
    step, h = np.zeros_like(x), 1e-4
    step[: bodies.m] = random.normal(size=(bodies.m, 2))
    values = [float(z @ measure(pairs, x + s * step).distance) for s in (-h, 0.0, h)]
    second = (values[0] - 2.0 * values[1] + values[2]) / h**2
    direction = step[: bodies.m].ravel()
    assert direction @ H @ direction == pytest.approx(-second, rel=1e-4, abs=1e-4)


def test_a_point_that_changes_sides_has_a_negative_distance() -> None:
    coarse, fine = Mesh.from_loops([ring(4, 2.0)]), Mesh.from_loops([ring(3, 0.5)])
    bodies = Bodies.of(coarse, fine)
    x = np.concatenate([coarse.vertices, fine.vertices])
    pairs = find_pairs(bodies, x, 10.0)
    before = measure(pairs, x)
    outside = x.copy()
    outside[4:] += [1.5, 1.5]  # the whole triangle through the edge from vertex 0 to 1
    after = measure(pairs, outside, before.side)
    through = (pairs.start == 0) & (pairs.point >= 4)
    assert np.all(before.distance > 0.0)
    assert np.all(after.distance[through & after.on_line & before.on_line] < 0.0)


def test_a_vertex_may_slide_along_a_pocket_past_the_ends_of_its_edges() -> None:
    """Of a fine mesh with a round pocket, and a cage whose one vertex dips into it."""
    arc = np.linspace(-0.15 * np.pi, -0.85 * np.pi, 15)
    hollow = np.stack([0.8 * np.cos(arc), 0.6 + 0.8 * np.sin(arc)], axis=1)
    fine = Mesh.from_loops([np.concatenate([[[1.0, -1.0], [1.0, 0.6]], hollow, [[-1.0, 0.6], [-1.0, -1.0]]])])
    coarse = Mesh.from_loops([np.array([[1.5, -1.5], [1.5, 1.0], [0.02, -0.13], [-1.5, 1.0], [-1.5, -1.5]])])
    bodies, x = Bodies.of(coarse, fine), np.concatenate([coarse.vertices, fine.vertices])
    deep = int(np.argmin(np.abs(x[: bodies.m, 1] + 0.13)))
    pairs = find_pairs(bodies, x, 0.6)
    pairs, contacts = resolve_corners(bodies, pairs, measure(pairs, x), x, 0.0)
    touching = pairs.point == deep
    assert touching.sum() > 3
    assert contacts.on_line[touching].all()
    # the linear constraints are those of the lines of the fine edges: exact for every motion inside the pocket
    a, b = x[pairs.start[touching]], x[pairs.end[touching]]
    normal = np.stack([(b - a)[:, 1], -(b - a)[:, 0]], axis=1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    for motion in ([0.3, 0.1], [-0.4, 0.2], [0.0, 0.5]):
        exact = ((x[deep] + motion - a) * normal).sum(axis=1)
        linear = contacts.distance[touching] + contacts.normal[touching] @ np.array(motion)
        np.testing.assert_allclose(linear, exact, atol=1e-12)


def test_pruning_keeps_what_implies_the_rest(around: Any) -> None:
    bodies, x, pairs = around
    pairs, contacts = resolve_corners(bodies, pairs, measure(pairs, x), x, 0.0)
    room = contacts.distance.copy()
    keep = not_implied(pairs, contacts, room)
    assert 0 < keep.sum() < len(pairs)
    J, random, checked = rows_as_matrix(bodies, pairs, contacts), np.random.default_rng(3), 0
    for _ in range(2000):
        motion = 0.03 * random.normal() * random.normal(size=2 * bodies.m)
        after = room + J @ motion
        if after[keep].min() >= 0.0:
            assert after.min() >= -1e-12
            checked += 1
    assert checked > 20
