"""Orientation, crossing and winding number against fractions, whole numbers and shapely."""

import itertools
from fractions import Fraction
from math import gcd
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from nestedcages_core.geometry.broad_phase import BoxTree
from nestedcages_core.geometry.predicates import (
    ON_BOUNDARY,
    crossing_pairs,
    orientation,
    orientation_sign,
    segments_intersect,
    winding_number,
)
from nestedcages_core.published.ray_parity import edges_meet, inside_by_parity
from support.marks import slow_after, slowly
from support.shapes import as_set, segments_of

finite = st.floats(allow_nan=False, allow_infinity=False)


def exact_orientation(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Signs for rows of points (K, 2), in fractions."""
    signs = []
    for row in np.concatenate((a, b, c), axis=1).tolist():
        ax, ay, bx, by, cx, cy = map(Fraction, row)
        determinant = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        signs.append((determinant > 0) - (determinant < 0))
    return np.array(signs)


def near_degenerate(random: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Third points on the lines through the first two, or a few doubles away from them."""
    a, b = random.normal(size=(2, count, 2)) * 10.0 ** random.integers(-4, 5, size=(2, count, 1))
    c = a + random.uniform(-2, 2, size=(count, 1)) * (b - a)
    for _ in range(3):
        c = np.where(random.random(c.shape) < 0.3, np.nextafter(c, random.choice([-np.inf, np.inf], c.shape)), c)
    return a, b, c


def assert_exact(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """The orientation of rows of points by arrays, in other orders, and one by one."""
    expected = exact_orientation(a, b, c)
    assert np.array_equal(orientation(a, b, c), expected)
    assert np.array_equal(orientation(b, c, a), expected)
    assert np.array_equal(orientation(c, b, a), -expected)
    assert [orientation_sign(*row) for row in np.concatenate((a, b, c), axis=1).tolist()] == expected.tolist()
    return expected


# Orientation


def test_orientation_of_plain_triples() -> None:
    a, b = np.array([0.0, 0.0]), np.array([1.0, 0.0])
    assert orientation(a, b, np.array([[0.0, 1.0], [0.0, -1.0], [7.0, 0.0]])).tolist() == [1, -1, 0]
    assert orientation(a, b, np.array([0.3, 2.0])) == 1
    assert orientation(np.zeros((4, 1, 2)), np.ones((1, 3, 2)), np.zeros(2)).shape == (4, 3)
    assert orientation(np.zeros((0, 2)), a, b).shape == (0,)


def test_orientation_of_near_degenerate_triples() -> None:
    a, b, c = near_degenerate(np.random.default_rng(1), 5000)
    expected = assert_exact(a, b, c)
    naive = np.sign((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert (naive != expected).sum() > 100  # so the triples are hard


def test_orientation_on_lines_through_the_origin() -> None:
    """The differences are rounded, and the sign is exactly 0."""
    scale = np.ldexp(1.0, np.random.default_rng(2).integers(-40, 40, size=(3, 500, 1)))
    assert not orientation(*(scale * np.array([1.0, 3.0]))).any()


@pytest.mark.parametrize("exponent", [-1074, -1060, -1022, -700, -540, -400, 0, 400, 500, 540, 700, 1010])
def test_orientation_where_products_leave_the_range_of_doubles(exponent: int) -> None:
    random = np.random.default_rng(abs(exponent))
    a, b, c = (np.ldexp(random.integers(-9, 10, size=(600, 2)).astype(float), exponent) for _ in range(3))
    assert set(assert_exact(a, b, c).tolist()) == {-1, 0, 1}


@given(hnp.arrays(np.float64, (20, 6), elements=finite))
@settings(max_examples=30, deadline=None)
def test_orientation_of_any_doubles(rows: np.ndarray) -> None:
    assert_exact(rows[:, 0:2], rows[:, 2:4], rows[:, 4:6])


HARD = {
    "a product in range of a factor that cannot be split": (
        (2.0**1020 * (1 + 2.0**-30), 2.0**360 * (1 + 2.0**-29)), (2.0**360, 2.0**-300 * (1 + 2.0**-30)), (0.0, 0.0)
    ),
    "the smallest determinant": tuple(np.ldexp(np.array(p) + 2.0**52, -500) for p in ((2, 1), (1, 1), (0, 0))),
    "differences that round, and products that are subnormal": np.ldexp(
        [
            (1.5 + 5 * 2.0**-52, 1.5 - 3 * 2.0**-52),
            (1.0 + 3 * 2.0**-52, 1.0 - 3 * 2.0**-52),
            (741 * 2.0**-62, -415 * 2.0**-62),
        ],
        -537,
    ),
}  # fmt: skip


@pytest.mark.parametrize("corners", HARD.values(), ids=HARD.keys())
def test_orientation_at_the_edges_of_the_filters(corners: Any) -> None:
    for triple in itertools.permutations(np.array([corner]) for corner in corners):
        assert assert_exact(*triple)[0] != 0


# Segments


def exact_intersection(a: tuple, b: tuple, c: tuple, d: tuple) -> bool:
    """Whether closed segments share a point: the parameters of the common point, in fractions."""
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = (tuple(map(Fraction, p)) for p in (a, b, c, d))
    ux, uy, vx, vy, wx, wy = bx - ax, by - ay, dx - cx, dy - cy, cx - ax, cy - ay
    determinant = ux * vy - uy * vx
    if determinant != 0:
        s, t = (wx * vy - wy * vx) / determinant, (wx * uy - wy * ux) / determinant
        return 0 <= s <= 1 and 0 <= t <= 1
    if ux * wy != uy * wx or vx * wy != vy * wx:
        return False
    along = (ux, uy) if (ux, uy) != (0, 0) else (vx, vy)
    if along == (0, 0):
        return (ax, ay) == (cx, cy)
    first = sorted((ax * along[0] + ay * along[1], bx * along[0] + by * along[1]))
    second = sorted((cx * along[0] + cy * along[1], dx * along[0] + dy * along[1]))
    return first[0] <= second[1] and second[0] <= first[1]


@pytest.mark.parametrize("every", [17, *slowly(1)])
def test_pairs_of_segments_on_a_grid(every: int) -> None:
    grid = list(itertools.product(range(3), range(3)))
    quadruples = np.array(list(itertools.product(grid, repeat=4))[::every], dtype=float)
    found = segments_intersect(*quadruples.transpose(1, 0, 2)).tolist()
    assert found == [exact_intersection(*(tuple(p) for p in q)) for q in quadruples.tolist()]
    assert found[:99] == [bool(segments_intersect(*q[:, None])[0]) for q in quadruples[:99]]


@pytest.mark.parametrize("count", [400, *slowly(3000)])
def test_segments_that_almost_touch(count: int) -> None:
    random = np.random.default_rng(3)
    a, b, c = near_degenerate(random, count)
    d = c + random.normal(size=c.shape)
    found = segments_intersect(a, b, c, d)
    assert found.tolist() == [exact_intersection(*q) for q in np.stack((a, b, c, d), axis=1).tolist()]
    assert 0.1 * count < found.sum() < 0.9 * count
    assert np.array_equal(found, segments_intersect(d, c, a, b))


def whole_segments(kind: str, count: int) -> list[np.ndarray]:
    """Segments (count, 2) -> (count, 2) of whole numbers below 2^12."""
    scale = 1 if kind == "grid" else 1500
    return [np.rint(scale * ends).astype(int) for ends in segments_of(kind, count, np.random.default_rng(count))]


def all_meet(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """(E, F) which segments share a point, all with all, in whole numbers."""

    def side(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> np.ndarray:
        return np.sign((q - p)[..., 0] * (r - p)[..., 1] - (q - p)[..., 1] * (r - p)[..., 0])

    a, b, c, d = a[:, None], b[:, None], c[None], d[None]
    boxes = (np.minimum(a, b) <= np.maximum(c, d)) & (np.minimum(c, d) <= np.maximum(a, b))
    apart = (side(a, b, c) * side(a, b, d) > 0) | (side(c, d, a) * side(c, d, b) > 0)
    return boxes.all(axis=2) & ~apart


@pytest.mark.parametrize("exponent", [0, *slowly(-1074, -1000, -300, 300, 1000)])
@pytest.mark.parametrize("count", slow_after(2, [150, 500, 2500], thorough_after=2))
@pytest.mark.parametrize("kind", ["soup", "star", "comb", "grid"])
def test_crossing_pairs(kind: str, count: int, exponent: int) -> None:
    """The same at every scale: all is a power of two times whole numbers."""
    if kind == "grid" or exponent < -1070:
        count = min(count, 150)  # all pairs meet, or need unbounded integers
    a, b = whole_segments(kind, count)
    c, d = whole_segments("star", 90)
    tree, other = (BoxTree(*(np.ldexp(p.astype(float), exponent) for p in pair)) for pair in ((a, b), (c, d)))
    own, others = np.argwhere(np.triu(all_meet(a, b, a, b), 1)), np.argwhere(all_meet(a, b, c, d))
    assert as_set(crossing_pairs(tree)) == set(map(tuple, own.tolist()))
    assert as_set(crossing_pairs(tree, other)) == set(map(tuple, others.tolist()))


# Winding number


def exact_winding(points: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """(P,) by edges that cross the rays upwards or downwards, in whole numbers, so nothing is rounded."""
    p, a, b = points[:, None], starts[None], ends[None]
    side = np.sign((b - a)[..., 0] * (p - a)[..., 1] - (b - a)[..., 1] * (p - a)[..., 0])
    below, above = (a[..., 1] <= p[..., 1]), (b[..., 1] <= p[..., 1])
    total = (below & ~above & (side > 0)).sum(axis=1) - (~below & above & (side < 0)).sum(axis=1)
    on = (side == 0) & (np.minimum(a, b) <= p).all(axis=2) & (p <= np.maximum(a, b)).all(axis=2)
    return np.where(on.any(axis=1), ON_BOUNDARY, total)


def assert_winding(points: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> None:
    found = winding_number(points.astype(float), starts.astype(float), ends.astype(float))
    assert np.array_equal(found, exact_winding(points, starts, ends))


EVERYWHERE = np.array(list(itertools.product(range(-1, 8), range(-1, 8))))


@pytest.mark.parametrize("shuffled", [False, True])
@given(data=st.data())
@settings(max_examples=30, deadline=None)
def test_winding_number_on_grids(shuffled: bool, data: st.DataObject) -> None:
    points = st.tuples(st.integers(0, 6), st.integers(0, 6))
    loops = data.draw(st.lists(st.lists(points, min_size=1, max_size=25), min_size=1, max_size=6))
    starts = np.array([p for loop in loops for p in loop])
    ends = np.array([p for loop in loops for p in (*loop[1:], loop[0])])
    if shuffled:
        order = data.draw(st.permutations(range(len(starts))))
        starts, ends = starts[order], ends[order]
    assert_winding(EVERYWHERE, starts, ends)


@pytest.mark.parametrize("shuffled", [False, True])
@pytest.mark.parametrize(("loops", "size", "span"), slow_after(2, [(1, 1500, 30), (400, 4, 30), (40, 60, 12)]))
def test_winding_number_in_a_tangle(loops: int, size: int, span: int, shuffled: bool) -> None:
    """So many edges at the height of each point that they are looked at in blocks."""
    random = np.random.default_rng(size)
    corners = random.integers(0, span, (loops, 1, 2)) + random.integers(0, span, (loops, size, 2))
    starts, ends = corners.reshape(-1, 2), np.roll(corners, -1, axis=1).reshape(-1, 2)
    if shuffled:
        order = random.permutation(len(starts))
        starts, ends = starts[order], ends[order]
    assert_winding(random.integers(-1, 2 * span, (400, 2)), starts, ends)


@pytest.mark.parametrize(("corners", "points"), slow_after(1, [(2000, 5000), (3000, 200_000)]))
def test_winding_number_of_many_points_against_shapely(corners: int, points: int) -> None:
    random = np.random.default_rng(15)
    angle, radius = np.sort(random.uniform(0, 2 * np.pi, corners)), random.uniform(0.5, 1.5, corners)
    outer = radius[:, None] * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    turn = -np.linspace(0.0, 2.0 * np.pi, 500, endpoint=False)
    inner = 0.4 * (1.0 + 0.1 * np.sin(5 * turn))[:, None] * np.stack((np.cos(turn), np.sin(turn)), axis=1)
    starts = np.concatenate((outer, inner))
    ends = np.concatenate((np.roll(outer, -1, axis=0), np.roll(inner, -1, axis=0)))
    at = random.uniform(-1.6, 1.6, size=(points, 2))
    solid = shapely.Polygon(outer, [inner])
    shapely.prepare(solid)
    assert np.array_equal(winding_number(at, starts, ends), shapely.contains_xy(solid, at).astype(int))


def test_winding_number_next_to_slanted_edges_is_exact() -> None:
    a = np.array([[0.125, 0.125], [1.625, 0.375], [0.875, 1.875]])
    b = np.roll(a, -1, axis=0)
    random = np.random.default_rng(16)
    which, share = random.integers(0, 3, 3000), random.uniform(size=(3000, 1))
    share[::2] = np.round(share[::2] * 16) / 16  # these points are on an edge to the last bit
    points = a[which] + share * (b - a)[which]
    beside = np.nextafter(points, random.choice([-9.0, 9.0], points.shape))
    points = np.where(random.random(points.shape) < 0.3, beside, points)
    sides = np.stack([exact_orientation(np.tile(a[k], (3000, 1)), np.tile(b[k], (3000, 1)), points) for k in range(3)])
    expected = np.where((sides > 0).all(axis=0), 1, np.where((sides >= 0).all(axis=0), ON_BOUNDARY, 0))
    assert np.array_equal(winding_number(points, a, b), expected)
    assert len(set(expected.tolist())) == 3


def test_triples_that_double_doubles_do_not_tell_from_a_line_are_exact() -> None:
    """a - c and b - c are (m, n) u 2^40 and (m, n) v 2^40, plus a vector so small that both differences round."""
    random = np.random.default_rng(7)
    points, signs = [], []
    for _ in range(300):
        m, n, u, v = (int(number) | 1 for number in random.integers(2**24, 2**26, 4))
        if gcd(m, n) > 1 or u == v:
            continue
        i = pow(m, -1, n)
        j, t, side = (m * i - 1) // n, int(random.integers(2**12)), int(random.choice([-1, 1]))  # m i - n j = 1
        small = m * t + side * j, n * t + side * i
        points.append([(m * u * 2.0**40, n * u * 2.0**40), (m * v * 2.0**40, n * v * 2.0**40), (-small[0], -small[1])])
        signs.append(side if u > v else -side)
    assert orientation(*np.array(points, float).transpose(1, 0, 2)).tolist() == signs


def test_winding_number_of_nothing() -> None:
    none = np.zeros((0, 2))
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert winding_number(none, square, np.roll(square, -1, axis=0)).shape == (0,)
    assert winding_number(square, none, none).tolist() == [0, 0, 0, 0]


# The predicates of the paper's program, which are right but for what touches a vertex


def test_parity_is_that_of_shapely_but_for_a_ray_through_a_vertex() -> None:
    angle = np.arange(7) + 0.3
    corners = np.stack([np.cos(angle), np.sin(angle)], axis=1) * np.array([1.0, 0.4, 1.0, 0.7, 0.9, 0.5, 1.0])[:, None]
    points = np.random.default_rng(1).uniform(-1.0, 1.0, (500, 2))
    expected = shapely.contains_xy(shapely.Polygon(corners), points)
    assert np.array_equal(inside_by_parity(points, corners, np.roll(corners, -1, axis=0)), expected)
    diamond = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    found = inside_by_parity(np.array([[0.1, 0.2], [0.1, 0.0]]), diamond, np.roll(diamond, -1, axis=0))
    assert found.tolist() == [True, False]


def test_edges_of_the_paper_meet_where_they_cross_and_touch() -> None:
    quadruples = np.random.default_rng(2).normal(size=(300, 4, 1, 2))
    expected = segments_intersect(*quadruples[:, :, 0].transpose(1, 0, 2)).tolist()
    assert [bool(edges_meet(*each)) for each in quadruples] == expected
    touching = np.array([[[0.5, 0.0]], [[0.5, 1.0]], [[0.0, 0.0]], [[1.0, 0.0]]])
    assert edges_meet(*touching)
    assert not edges_meet(*(touching + np.array([[0.0, 0.1], [0.0, 0.1], [0.0, 0.0], [0.0, 0.0]])[:, None]))
