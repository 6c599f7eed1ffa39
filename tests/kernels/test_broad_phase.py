"""What is near what, how near, and on which side: against shapely's tree and distances, and fractions."""

import itertools
from fractions import Fraction

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core import Mesh, check, verify
from nestedcages_core.contact.linearisation import measure
from nestedcages_core.contact.pairs import Bodies, CandidateList, find_pairs
from nestedcages_core.geometry.broad_phase import BoxTree, near_pairs
from nestedcages_core.geometry.signed_distance import SignedDistance
from nestedcages_core.geometry.smallest_gap import smallest_gap
from support.marks import slow_after, slowly
from support.shapes import annulus, as_set, islands, jagged, letter_a, letter_a_coarse, polygon, ring, segments_of, star

# Points near edges


def by_dwithin(points: np.ndarray, starts: np.ndarray, ends: np.ndarray, radius: float) -> set[tuple[int, int]]:
    tree = shapely.STRtree(shapely.linestrings(np.stack([starts, ends], axis=1)))
    return set(map(tuple, tree.query(shapely.points(points), "dwithin", radius).T.tolist()))


def scene(seed: int, points: int, edges: int, long_share: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points and edges, a share of them a hundred times as long as the others."""
    random = np.random.default_rng(seed)
    starts = random.uniform(size=(edges, 2))
    length = np.where(random.uniform(size=(edges, 1)) < long_share, 0.5, 0.005)
    return random.uniform(size=(points, 2)), starts, starts + length * random.normal(size=(edges, 2))


@pytest.mark.parametrize(
    ("points", "edges"), [(1, 1), (50, 50), (300, 300), (700, 400), *slowly((3000, 1000), (6000, 1000))]
)
@pytest.mark.parametrize("long_share", [0.0, 0.1, 1.0])
@pytest.mark.parametrize("radius", [1e-4, 0.003, 0.05])
def test_near_pairs_are_those_that_shapely_finds(radius: float, long_share: float, points: int, edges: int) -> None:
    """All are measured, sorted or put into cells, depending on the numbers."""
    if points > 5000 and radius > 0.01:
        points //= 10
    given_ = scene(points, points, edges, long_share)
    assert as_set(near_pairs(*given_, radius)) == by_dwithin(*given_, radius)


@pytest.mark.parametrize(("count", "edges"), slow_after(1, [(200, 300), (2500, 1200)], thorough_after=1))
def test_nearly_all_pairs_are_near(count: int, edges: int) -> None:
    points, starts, ends = scene(1, count, edges, 0.3)
    found = near_pairs(points, starts, ends, 1.0)
    lines = shapely.linestrings(np.stack([starts, ends], axis=1))
    near = shapely.distance(shapely.points(points)[:, None], lines[None]) < 1.0
    assert near.mean() > 0.8
    assert as_set(found) == set(map(tuple, np.argwhere(near).tolist()))


@pytest.mark.parametrize("radius", slow_after(1, [0.01, 0.2]))
def test_crowds_of_points_among_long_edges(radius: float) -> None:
    """As where long lines cross along a small circle."""
    random = np.random.default_rng(3)
    angle = np.sort(random.uniform(0.0, 2.0 * np.pi, 1000))
    points = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    long = random.normal(size=(2, 150, 2)) * 30.0
    given_ = points, np.concatenate((points, long[0])), np.concatenate((np.roll(points, -1, axis=0), long[1]))
    assert as_set(near_pairs(*given_, radius)) == by_dwithin(*given_, radius)


def test_nothing_is_near_nothing() -> None:
    nothing, one = np.zeros((0, 2)), np.zeros((1, 2))
    assert len(near_pairs(nothing, one, one + 1, 1.0)[0]) == 0
    assert len(near_pairs(one, nothing, nothing, 1.0)[0]) == 0


# Boxes


KINDS = ("soup", "loop", "star", "comb", "grid")


def overlapping(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """(K, 2) pairs of the bounding boxes of segments a-b and c-d that overlap or touch, by shapely."""
    if len(a) == 0:
        return np.zeros((0, 2), int)
    boxes, others = (shapely.box(*np.minimum(p, q).T, *np.maximum(p, q).T) for p, q in ((a, b), (c, d)))
    return shapely.STRtree(others).query(boxes).T


def within(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray, radius: float) -> set[tuple[int, int]]:
    """Pairs of segments a-b and c-d that are at most a radius apart, by shapely."""
    if len(a) == 0:
        return set()
    lines, others = (shapely.linestrings(np.stack(ends, axis=1)) for ends in ((a, b), (c, d)))
    return set(map(tuple, shapely.STRtree(others).query(lines, "dwithin", radius).T.tolist()))


@pytest.mark.parametrize("count", [0, 1, 2, 5, 17, 65, 250, *slowly(3, 4, 15, 16, 63, 64, 400, 1500, 12_000)])
@pytest.mark.parametrize("kind", KINDS)
def test_pairs_hold_all_that_are_near_by_shapely(kind: str, count: int) -> None:
    """Few boxes are sorted; many, and those that overlap with hundreds, are opened from the top, in blocks."""
    if count > 1000 and kind not in ("soup", "loop"):
        count //= 20
    random = np.random.default_rng(count)
    a, b = segments_of(kind, count, random)
    tree = BoxTree(a, b)
    assert len(tree) == count
    own = overlapping(a, b, a, b)
    found = as_set(tree.pairs())
    assert {pair for pair in within(a, b, a, b, 0.0) if pair[0] < pair[1]} <= found
    assert found <= set(map(tuple, own[own[:, 0] < own[:, 1]].tolist()))
    for other, radius in itertools.product(KINDS, (0.0, 0.02)):
        c, d = segments_of(other, 77, random)
        found = as_set(tree.pairs(BoxTree(c, d), radius))
        assert within(a, b, c, d, radius) <= found
        assert radius > 0.0 or found <= set(map(tuple, overlapping(a, b, c, d).tolist()))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("count", "size"), [(400, 300), (400, 4098), *slowly((5_000, 300))])
def test_the_closest_segment_does_not_depend_on_the_order_of_segments(kind: str, count: int, size: int) -> None:
    random = np.random.default_rng(11)
    a, b = segments_of(kind, count, random)
    points, shuffle = random.uniform(-1.0, 2.0, (size, 2)), random.permutation(count)
    lines = shapely.linestrings(np.stack([a, b], axis=1))
    _, distance = shapely.STRtree(lines).query_nearest(shapely.points(points), return_distance=True, all_matches=False)
    for tree in (BoxTree(a, b), BoxTree(a[shuffle], b[shuffle])):
        found = tree.closest(points)
        assert np.allclose(found.distance, distance, rtol=0.0, atol=1e-13)
        assert np.allclose(np.hypot(*(points - tree.nearest(points)).T), distance, rtol=0.0, atol=1e-13)


# Pairs of cage and fine mesh, kept while these move


@pytest.mark.parametrize("steps", slow_after(1, [6, 40]))
def test_a_kept_list_has_all_pairs_that_may_meet(steps: int) -> None:
    fine, coarse, random = letter_a(3), letter_a_coarse(), np.random.default_rng(7)
    bodies = Bodies.of(coarse, fine)
    x = np.concatenate([coarse.vertices, fine.vertices])
    everything = find_pairs(bodies, x, np.inf)
    candidates = CandidateList(bodies, thinnest_skin=0.1)
    distance, longest, kept = 0.02, 0.05, 0
    for _ in range(steps):
        step = 0.01 * random.normal(size=(bodies.m, 2))
        x = np.concatenate([x[: bodies.m] + step, x[bodies.m :]])
        motion = np.concatenate([random.uniform(0.0, longest, bodies.m), np.zeros(bodies.n)])
        found = candidates.meeting(x, distance, motion, distance + 2.0 * longest, longest)
        names = {tuple(corners) for corners in found.corners.tolist()}
        for angle in random.uniform(0.0, 2.0 * np.pi, (20, len(x))):
            moved = x + motion[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
            met = measure(everything, moved).distance < distance
            assert names >= {tuple(corners) for corners in everything.corners[met].tolist()}
        kept += len(names)
    assert kept < 0.2 * steps * len(everything)


def test_pairs_of_meshes_are_all_but_those_with_an_end_in_common() -> None:
    """Fine vertices with cage edges, cage vertices with fine edges, and the cage with itself up to twice as far."""
    fine, coarse = annulus(40), annulus(8)
    bodies = Bodies.of(coarse, fine)
    x = np.concatenate([coarse.vertices, 0.9 * fine.vertices])
    m, follows = bodies.m, bodies.successor.tolist()
    expected = {
        (p, e, follows[e])
        for p, e in itertools.product(range(len(x)), repeat=2)
        if min(p, e) < m and p not in (e, follows[e])
        if shapely.Point(x[p]).distance(shapely.LineString(x[[e, follows[e]]])) < (0.6 if max(p, e) < m else 0.3)
    }
    assert {tuple(corners) for corners in find_pairs(bodies, x, 0.3).corners.tolist()} == expected


# Smallest gap between two boundaries


def gap_by_shapely(inner: np.ndarray, outer: np.ndarray) -> float:
    return float(shapely.LinearRing(inner).distance(shapely.LinearRing(outer)))


def tree_of(loop: np.ndarray, order: np.ndarray | slice = slice(None)) -> BoxTree:
    return BoxTree(loop[order], np.roll(loop, -1, axis=0)[order])


@pytest.mark.parametrize(
    ("first", "second"), [*itertools.product([3, 4, 16, 17, 700], [3, 5, 300]), *slowly((5, 64), (2500, 5000))]
)
def test_the_smallest_gap_is_that_of_shapely(first: int, second: int) -> None:
    random = np.random.default_rng(first * second)
    for shift in (0.0, 0.5, 2.5):
        inner, outer = jagged(random, first), 2.6 * jagged(random, second) + np.array([10.0 * shift, shift])
        expected = gap_by_shapely(inner, outer)
        if expected > 0:
            assert smallest_gap(tree_of(inner), tree_of(outer)) == pytest.approx(expected, rel=1e-12)
            orders = [random.permutation(len(loop)) for loop in (inner, outer)]
            assert smallest_gap(tree_of(inner, orders[0]), tree_of(outer, orders[1])) == pytest.approx(
                expected, rel=1e-12
            )


@pytest.mark.parametrize("gap", [1e-2, 1e-5, 1e-9])
def test_the_smallest_gap_where_all_places_are_nearly_as_near(gap: float) -> None:
    """Parallel rings, and parallel spikes: hundreds of pairs have to be measured."""
    random, outer = np.random.default_rng(4), ring(900)
    spikes = jagged(random, 500)
    for loop, other in ((outer, (1.0 - gap) * outer[::-1]), (spikes, (1.0 + gap) * spikes)):
        expected = gap_by_shapely(loop, other)
        assert smallest_gap(tree_of(loop), tree_of(other)) == pytest.approx(expected, rel=max(1e-12, 1e-15 / gap))


def exact_gap(inner: np.ndarray, outer: np.ndarray) -> float:
    """Between the vertices of each of two rings and the edges of the other, by fractions."""
    squared = []
    for loop, other in ((inner, outer), (outer, inner)):
        points = [tuple(map(Fraction, point)) for point in loop.tolist()]
        ends = [tuple(map(Fraction, point)) for point in other.tolist()]
        for (px, py), ((ax, ay), (bx, by)) in itertools.product(points, zip(ends, ends[1:] + ends[:1], strict=True)):
            ux, uy, wx, wy = bx - ax, by - ay, px - ax, py - ay
            t = min(max((wx * ux + wy * uy) / (ux * ux + uy * uy), Fraction(0)), Fraction(1))
            squared.append((wx - t * ux) ** 2 + (wy - t * uy) ** 2)
    return float(min(squared) * 10**60) ** 0.5 / 1e30


@pytest.mark.parametrize("gap", [1e-9, 1e-6, 1e-3])
def test_certificate_and_checker_agree_to_the_last_digits(gap: float) -> None:
    """Far from the origin, by clearances just within the tolerance of both and just beyond it."""
    random = np.random.default_rng(7)
    for _ in range(6):
        turn = ring(4, 1.0, float(random.random()))
        around, inside = turn + 1e6, (1.0 - gap) * turn + gap * random.random(2) * 0.1 + 1e6
        true = exact_gap(inside, around)
        assert true == pytest.approx(gap, rel=0.9)
        assert verify(around, inside).clearance == pytest.approx(true, rel=1e-14)
        for beyond in (0.0, 0.99e-9, 1.01e-9, 1e-6):
            clearance = true * (1.0 + beyond)
            assert bool(verify(around, inside, clearance)) is bool(check(inside, around, clearance)) is (beyond < 1e-9)


# Signed distance

MESHES = {
    "annulus": annulus(24),
    "square": annulus(4, angle=np.pi / 4),
    "letter": letter_a(),
    "star": star(),
    "islands": islands(),
    "very different edges": Mesh.from_loops([np.concatenate([ring(400)[:100], [(-5.0, -5.0), (6.0, -5.0)]])]),
}
BY_NAME = pytest.mark.parametrize("name", MESHES)


def probes(mesh: Mesh, count: int = 300) -> np.ndarray:
    """Points all over, and points level with the vertices, whose rays to the right meet these."""
    random = np.random.default_rng(1)
    low, high = mesh.vertices.min(axis=0) - 0.2, mesh.vertices.max(axis=0) + 0.2
    anywhere = random.uniform(low, high, (count, 2))
    level = np.stack([random.uniform(low[0], high[0], len(mesh.vertices)), mesh.vertices[:, 1]], axis=1)
    return np.concatenate([anywhere, level])


def by_shapely(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    solid, at = polygon(mesh), shapely.points(points)
    return shapely.distance(solid.boundary, at) * np.where(shapely.contains(solid, at), -1.0, 1.0)


@pytest.mark.parametrize("count", [300, 3000])  # measured one by one, and by a tree
@BY_NAME
def test_distance_and_sign_are_those_of_shapely(name: str, count: int) -> None:
    mesh = MESHES[name]
    points = probes(mesh, count)
    found = SignedDistance.of(mesh).at(points)
    assert np.allclose(found.distance, by_shapely(mesh, points), rtol=0.0, atol=1e-13)
    starts, ends = mesh.vertices[found.edge], mesh.vertices[mesh.successor[found.edge]]
    nearest = starts + found.parameter[:, None] * (ends - starts)
    assert np.allclose(np.hypot(*(points - nearest).T), np.abs(found.distance), atol=1e-13)


def test_distance_beyond_the_tips_of_spikes() -> None:
    """There all of an edge but its end may be farther away than many places of other edges."""
    random = np.random.default_rng(1)
    angles, radii = np.sort(random.uniform(0.0, 2.0 * np.pi, 200)), random.uniform(0.2, 1.0, 200)
    spikes = radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    points = (spikes[:, None] + random.normal(0.0, 0.03, (200, 20, 2))).reshape(-1, 2)
    mesh = Mesh.from_loops([spikes])
    assert np.allclose(SignedDistance.of(mesh).at(points).distance, by_shapely(mesh, points), rtol=0.0, atol=1e-13)


@BY_NAME
def test_gradient_is_the_derivative_of_the_distance(name: str) -> None:
    mesh = MESHES[name]
    field, points, step = SignedDistance.of(mesh), probes(mesh), 1e-6
    gradient = field.at(points).gradient
    assert np.allclose(np.hypot(*gradient.T), 1.0)
    ahead, behind = ([field.at(points + way * axis).distance for axis in np.eye(2)] for way in (step, -step))
    differences = np.stack([(a - b) / (2.0 * step) for a, b in zip(ahead, behind, strict=True)], axis=1)
    smooth = np.abs(np.hypot(*differences.T) - 1.0) < 1e-6  # not across a ridge of the distance
    assert smooth.mean() > 0.9
    assert np.allclose(gradient[smooth], differences[smooth], atol=1e-5)


def test_on_the_boundary_the_distance_is_zero_and_the_gradient_the_outward_normal() -> None:
    mesh = annulus(4, angle=np.pi / 4)
    middle = 0.5 * (mesh.vertices + mesh.vertices[mesh.successor])
    found = SignedDistance.of(mesh).at(middle)
    assert (found.distance == 0.0).all()
    solid = polygon(mesh)
    assert not shapely.contains_xy(solid, middle + 1e-6 * found.gradient).any()
    assert shapely.contains_xy(solid, middle - 1e-6 * found.gradient).all()
    letter = letter_a()
    assert (SignedDistance.of(letter).at(letter.vertices).distance == 0.0).all()


def test_a_hole_alone_has_its_solid_outside() -> None:
    hole = ring(12)[::-1]
    found = SignedDistance(hole, np.roll(hole, -1, axis=0), outside=-1).at(np.array([[0.0, 0.0], [2.0, 0.1]]))
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
