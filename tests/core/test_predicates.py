"""Predicates against exact fractions, exhaustive small grids, brute force and shapely."""

from __future__ import annotations

import importlib
import itertools
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from nestedcages_core.geometry.predicates import (
    ON_BOUNDARY,
    BoxTree,
    as_integers,
    box_tree,
    crossing_pairs,
    orientation,
    orientation_sign,
    rays,
    segments_intersect,
    winding,
    winding_number,
)
from nestedcages_core.geometry.predicates.oriented_boxes import OrientedBoxes
from support.marks import slowly

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
    """Third points on, or a few doubles beside, the lines through the first two."""
    a, b = random.normal(size=(2, count, 2)) * 10.0 ** random.integers(-4, 5, size=(2, count, 1))
    c = a + random.uniform(-2, 2, size=(count, 1)) * (b - a)
    for _ in range(3):
        c = np.where(random.random(c.shape) < 0.3, np.nextafter(c, random.choice([-np.inf, np.inf], c.shape)), c)
    return a, b, c


# Orientation


def test_orientation_of_plain_triples() -> None:
    a, b = np.array([0.0, 0.0]), np.array([1.0, 0.0])
    assert orientation(a, b, np.array([[0.0, 1.0], [0.0, -1.0], [7.0, 0.0]])).tolist() == [1, -1, 0]
    assert orientation(a, b, np.array([0.3, 2.0])) == 1
    assert orientation(np.zeros((4, 1, 2)), np.ones((1, 3, 2)), np.zeros(2)).shape == (4, 3)
    assert orientation(np.zeros((0, 2)), a, b).shape == (0,)
    assert orientation(np.array([[7.0, 0.0], [0.0, 1.0]]), a, b).tolist() == [0, 1]


def test_orientation_of_near_degenerate_triples() -> None:
    a, b, c = near_degenerate(np.random.default_rng(1), 5000)
    expected = exact_orientation(a, b, c)
    naive = np.sign((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert (naive != expected).sum() > 100  # so the triples are hard
    assert np.array_equal(orientation(a, b, c), expected)
    assert np.array_equal(orientation(c, b, a), -expected)
    assert [orientation_sign(*row) for row in np.concatenate((a, b, c), axis=1).tolist()] == expected.tolist()


@pytest.mark.parametrize("exponent", [-1074, -1060, -1022, -700, -540, -400, 0, 400, 500, 540, 700, 1010])
def test_orientation_where_products_leave_the_range_of_doubles(exponent: int) -> None:
    random = np.random.default_rng(abs(exponent))
    a, b, c = (random.integers(-9, 10, size=(600, 2)).astype(float) for _ in range(3))
    a, b, c = (np.ldexp(p, exponent) for p in (a, b, c))
    expected = exact_orientation(a, b, c)
    assert {-1, 0, 1} == set(expected.tolist())
    assert np.array_equal(orientation(a, b, c), expected)
    assert [orientation_sign(*row) for row in np.concatenate((a, b, c), axis=1).tolist()] == expected.tolist()


@given(hnp.arrays(np.float64, (20, 6), elements=finite))
@settings(max_examples=60, deadline=None)
def test_orientation_of_any_doubles(rows: np.ndarray) -> None:
    a, b, c = rows[:, 0:2], rows[:, 2:4], rows[:, 4:6]
    expected = exact_orientation(a, b, c)
    assert np.array_equal(orientation(a, b, c), expected)
    assert np.array_equal(orientation(b, c, a), expected)
    assert [orientation_sign(*row) for row in rows.tolist()] == expected.tolist()


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


@pytest.mark.parametrize(("a", "b", "c"), HARD.values(), ids=HARD.keys())
def test_orientation_at_the_edges_of_the_filters(a: Any, b: Any, c: Any) -> None:
    for triple in itertools.permutations((a, b, c)):
        (expected,) = exact_orientation(*(np.array([p]) for p in triple))
        assert expected != 0
        assert orientation(*map(np.array, triple)) == expected
        assert orientation_sign(*np.ravel(triple).tolist()) == expected


def test_products_are_exact_with_their_remainders() -> None:
    module = importlib.import_module("nestedcages_core.geometry.predicates.orientation")
    a, b = np.random.default_rng(6).uniform(1.0, 2.0, size=(2, 3000))
    for x, y, product, remainder in np.stack((a, b, *module._product(a, b)), axis=1).tolist():
        assert Fraction(x) * Fraction(y) == Fraction(product) + Fraction(remainder)


def test_unbounded_integers_are_the_last_resort(monkeypatch: pytest.MonkeyPatch) -> None:
    module = importlib.import_module("nestedcages_core.geometry.predicates.orientation")
    handed_on: list[int] = []
    exact = module._sign_by_integers

    def counted(corners: np.ndarray) -> np.ndarray:
        handed_on.append(corners.shape[1])
        return np.asarray(exact(corners))

    monkeypatch.setattr(module, "_sign_by_integers", counted)
    random = np.random.default_rng(2)
    orientation(*near_degenerate(random, 5000))
    assert sum(handed_on) < 500
    scale = np.ldexp(1.0, random.integers(-40, 40, size=(3, 500, 1)))
    on_a_line = orientation(*(scale * np.array([1.0, 3.0])))  # differences are rounded, yet the sign is exactly 0
    assert not on_a_line.any()
    assert sum(handed_on) > 50


@given(hnp.arrays(np.float64, (5, 3), elements=finite))
@settings(max_examples=60, deadline=None)
def test_integers_are_the_doubles(numbers: np.ndarray) -> None:
    integers, exponents = as_integers(numbers)
    for row, whole, exponent in zip(numbers.tolist(), integers.tolist(), exponents.tolist(), strict=True):
        assert [Fraction(k) * Fraction(2) ** exponent for k in whole] == [Fraction(x) for x in row]


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


@pytest.mark.slow
def test_segments_that_almost_touch() -> None:
    random = np.random.default_rng(3)
    a, b, c = near_degenerate(random, 3000)
    d = c + random.normal(size=c.shape)
    found = segments_intersect(a, b, c, d)
    assert found.tolist() == [exact_intersection(*q) for q in np.stack((a, b, c, d), axis=1).tolist()]
    assert 300 < found.sum() < 2700
    assert np.array_equal(found, segments_intersect(d, c, a, b))


# Trees of boxes


def segments_of(kind: str, count: int, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Segments (count, 2) -> (count, 2) of a kind that trees find easy or hard."""
    if kind == "soup":
        starts = random.uniform(size=(count, 2))
        return starts, starts + random.normal(scale=0.05, size=(count, 2))
    if kind == "loop":
        angle = np.arange(count) / max(count, 1) * 2 * np.pi
        radius = 1 + 0.3 * np.sin(5 * angle)
        points = np.stack((radius * np.cos(angle), radius * np.sin(angle)), axis=1)
    elif kind == "star":
        angle, radius = np.sort(random.uniform(0, 2 * np.pi, count)), random.uniform(0.5, 1.5, count)
        points = np.stack((radius * np.cos(angle), radius * np.sin(angle)), axis=1)
    elif kind == "comb":
        x = np.arange(count) / max(count, 1)
        points = np.stack((x, np.arange(count) % 2), axis=1) @ np.array([[0.8, 0.6], [-0.6, 0.8]])
    else:
        assert kind == "grid"
        points = random.integers(0, 6, size=(count, 2)).astype(float)
    return points, np.roll(points, -1, axis=0)


KINDS = ("soup", "loop", "star", "comb", "grid")


def overlapping(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Which boxes overlap, all with all."""
    low, high = np.minimum(a, b)[:, None], np.maximum(a, b)[:, None]
    return np.asarray(((low <= np.maximum(c, d)[None]) & (np.minimum(c, d)[None] <= high)).all(axis=2))


def as_set(pairs: tuple[np.ndarray, np.ndarray]) -> set[tuple[int, int]]:
    """Pairs as a set; each must come once."""
    listed = list(zip(pairs[0].tolist(), pairs[1].tolist(), strict=True))
    assert len(set(listed)) == len(listed)
    return set(listed)


@pytest.mark.parametrize("swept", [True, False])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [0, 1, 2, 5, 17, 65, *slowly(3, 4, 15, 16, 63, 64, 300)])
def test_pairs_of_boxes(kind: str, count: int, swept: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if not swept:
        monkeypatch.setattr(box_tree, "SWEEP_LIMIT", -1)
    random = np.random.default_rng(count)
    a, b = segments_of(kind, count, random)
    tree = BoxTree(a, b)
    assert len(tree) == count
    overlap = overlapping(a, b, a, b)
    assert as_set(tree.self_pairs()) == set(map(tuple, np.argwhere(np.triu(overlap, 1)).tolist()))
    for other in KINDS:
        c, d = segments_of(other, 77, random)
        expected = set(map(tuple, np.argwhere(overlapping(a, b, c, d)).tolist()))
        assert as_set(tree.pairs(BoxTree(c, d))) == expected


@pytest.mark.parametrize("kind", KINDS)
def test_pairs_do_not_depend_on_the_order_of_segments(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(box_tree, "SWEEP_LIMIT", -1)
    random = np.random.default_rng(11)
    a, b = segments_of(kind, 400, random)
    shuffle = random.permutation(400)
    i, j = BoxTree(a[shuffle], b[shuffle]).self_pairs()
    assert {tuple(sorted(pair)) for pair in zip(shuffle[i].tolist(), shuffle[j].tolist(), strict=True)} == as_set(
        BoxTree(a, b).self_pairs()
    )


@pytest.mark.parametrize("kind", ["star", "grid", *slowly("soup", "loop", "comb")])
def test_blocks_join_to_the_whole(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    a, b = segments_of(kind, 500, np.random.default_rng(12))
    tree, other = BoxTree(a, b), BoxTree(a[::3] + 0.01, b[::3] + 0.01)
    whole, pairs = as_set(tree.self_pairs()), as_set(tree.pairs(other))
    monkeypatch.setattr(box_tree, "BLOCK_PAIRS", 16)
    blocks = list(tree.blocks())
    assert len(blocks) > 5
    assert max(len(i) for i, _ in blocks) <= 16 * box_tree.FANOUT**2
    assert as_set(tree.self_pairs()) == whole
    assert as_set(tree.pairs(other)) == pairs


@pytest.mark.parametrize(("crowded", "sweep"), [(0, -1), (box_tree.CROWDED, -1), (0, box_tree.SWEEP_LIMIT)])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("exponent", [-1070, 0, *slowly(-1000, -300, 300, 1000, 1020)])
def test_crossing_pairs(kind: str, crowded: int, sweep: int, exponent: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(box_tree, "CROWDED", crowded)
    monkeypatch.setattr(box_tree, "SWEEP_LIMIT", sweep)
    random = np.random.default_rng(13)
    a, b = (np.ldexp(p, exponent) for p in segments_of(kind, 150, random))
    c, d = (np.ldexp(p, exponent) for p in segments_of("star", 90, random))
    meet, meet_others = np.triu(all_meet(a, b, a, b), 1), all_meet(a, b, c, d)
    assert as_set(crossing_pairs(BoxTree(a, b))) == set(map(tuple, np.argwhere(meet).tolist()))
    assert as_set(crossing_pairs(BoxTree(a, b), BoxTree(c, d))) == set(map(tuple, np.argwhere(meet_others).tolist()))


def all_meet(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Which segments share a point, all with all."""
    i, j = (k.ravel() for k in np.indices((len(a), len(c))))
    return segments_intersect(a[i], b[i], c[j], d[j]).reshape(len(a), len(c))


@pytest.mark.parametrize("kind", ["star", "comb"])
def test_turned_boxes_tell_slanted_segments_apart(kind: str) -> None:
    a, b = segments_of(kind, 3000, np.random.default_rng(14))
    tree = BoxTree(a, b)
    upright = sum(len(i) for i, _ in tree.blocks())
    turned = sum(len(i) for i, _ in tree.blocks(slim=True))
    assert upright > 100_000
    assert turned < 45_000


@given(hnp.arrays(np.float64, (33, 2), elements=st.floats(-1e3, 1e3) | st.floats(-1e-320, 1e-320)), st.integers(2, 5))
@settings(max_examples=60, deadline=None)
def test_turned_boxes_hold_their_segments(points: np.ndarray, fanout: int) -> None:
    level = OrientedBoxes.of_segments(points, np.roll(points, -1, axis=0))
    owner = np.arange(len(points))
    while True:
        assert level.may_hold(owner, points).all()
        assert level.may_hold(owner, np.roll(points, -1, axis=0)).all()
        if len(level.longest) == 1:
            return
        level, owner = level.parents(fanout), owner // fanout


# Containment


def exact_winding(point: tuple[int, int], starts: list[tuple[int, int]], ends: list[tuple[int, int]]) -> int:
    """Winding number by the edges that cross the ray upwards or downwards; whole numbers, so nothing is rounded."""
    x, y = point
    total = 0
    for (ax, ay), (bx, by) in zip(starts, ends, strict=True):
        side = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
        if side == 0 and min(ax, bx) <= x <= max(ax, bx) and min(ay, by) <= y <= max(ay, by):
            return ON_BOUNDARY
        if ay <= y < by and side > 0:
            total += 1
        if by <= y < ay and side < 0:
            total -= 1
    return total


@pytest.mark.parametrize(
    ("crowded", "at_height"),
    [
        (-1, -(10**6)),
        pytest.param(box_tree.CROWDED, -(10**6), marks=pytest.mark.slow),
        pytest.param(box_tree.CROWDED, winding.AT_HEIGHT, marks=pytest.mark.slow),
    ],
)
@pytest.mark.parametrize("shuffled", [False, True])
@given(data=st.data())
@settings(max_examples=60, deadline=None)
def test_winding_number_on_grids(crowded: int, at_height: int, shuffled: bool, data: st.DataObject) -> None:
    points = st.tuples(st.integers(0, 6), st.integers(0, 6))
    loops = data.draw(st.lists(st.lists(points, min_size=1, max_size=25), min_size=1, max_size=6))
    starts = [p for loop in loops for p in loop]
    ends = [p for loop in loops for p in (*loop[1:], loop[0])]
    if shuffled:
        order = data.draw(st.permutations(range(len(starts))))
        starts, ends = [starts[k] for k in order], [ends[k] for k in order]
    queries = list(itertools.product(range(-1, 8), range(-1, 8)))
    before = rays.CROWDED, winding.AT_HEIGHT
    rays.CROWDED, winding.AT_HEIGHT = crowded, at_height
    try:
        given_ = np.array(queries, float), np.array(starts, float), np.array(ends, float)
        found, around = winding_number(*given_), winding.winding_around(*given_)
    finally:
        rays.CROWDED, winding.AT_HEIGHT = before
    assert found.tolist() == [exact_winding(q, starts, ends) for q in queries]
    assert (around == found)[found != ON_BOUNDARY].all()


@pytest.mark.parametrize("crowded", [-1, box_tree.CROWDED])
def test_winding_number_of_many_points_against_shapely(crowded: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rays, "CROWDED", crowded)
    monkeypatch.setattr(winding, "AT_HEIGHT", -(10**6))
    monkeypatch.setattr(rays, "PAIR_BLOCK", 1000)
    random = np.random.default_rng(15)
    outer, inner = segments_of("star", 2000, random)[0], 0.4 * segments_of("loop", 500, random)[0][::-1]
    starts = np.concatenate((outer, inner))
    ends = np.concatenate((np.roll(outer, -1, axis=0), np.roll(inner, -1, axis=0)))
    points = random.uniform(-1.6, 1.6, size=(5000, 2))
    found = winding_number(points, starts, ends)
    expected = shapely.contains_xy(shapely.Polygon(outer, [inner]), points)
    assert np.array_equal(found, expected.astype(int))


def test_winding_number_beside_slanted_edges_is_exact() -> None:
    corners = np.array([[0.125, 0.125], [1.625, 0.375], [0.875, 1.875]])
    a, b = corners, np.roll(corners, -1, axis=0)
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


def test_winding_number_of_nothing() -> None:
    none = np.zeros((0, 2))
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert winding_number(none, square, np.roll(square, -1, axis=0)).shape == (0,)
    assert winding_number(square, none, none).tolist() == [0, 0, 0, 0]


def test_chains_are_sorted_along_the_curve_that_interleaves_their_bits() -> None:
    """So that the boxes of a tree are small; any other order only takes longer."""
    points = np.random.default_rng(4).integers(0, 2**20, (300, 2)) / 2.0**20
    points[:2] = [(0.0, 1.0), (1.0, 0.0)]
    bits = (points * (2**box_tree.MORTON_BITS - 1)).astype(int)
    codes = [int("".join(a + b for a, b in zip(f"{y:016b}", f"{x:016b}", strict=True)), 2) for x, y in bits.tolist()]
    assert box_tree._along_curve(4.0 * points - 1.0).tolist() == np.argsort(codes, kind="stable").tolist()
