"""The outer hull encloses strictly, with the wanted vertices, and no count or gap defeats it; shapely is the judge."""

from __future__ import annotations

import re

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core import ArcLength, LineCycles, Mesh, NestingError, OnCurve, OuterHull, verify
from nestedcages_core.decimation.hull.hull_moves import MoveQueue, Weights
from nestedcages_core.decimation.hull.linked_loops import MAX_AT_ONCE, EdgeBoxes, LinkedLoops
from nestedcages_core.decimation.hull.narrow_gaps import without_gaps
from nestedcages_core.decimation.hull.offset import cleared, strict_offset
from nestedcages_core.decimation.hull.outer_search import thinned
from nestedcages_core.decimation.hull.progressive_hull import ProgressiveHull
from nestedcages_core.decimation.request import apportioned, canonical_order, padded
from nestedcages_core.geometry.loops import Loops
from support.marks import slow_after
from support.shapes import annulus, assert_nested, disc, islands, letter_a, polygon, ring, star

QUICK = OuterHull()
SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
SHAPES = pytest.mark.parametrize("shape", [letter_a, star, islands, lambda: annulus(40)])


def rough(random: np.random.Generator, count: int, size: float = 1.0) -> np.ndarray:
    """A star-shaped loop with teeth of all sizes, (count, 2)."""
    angle = 2.0 * np.pi * np.arange(count) / count
    waves = np.arange(2, 12)
    height = (random.normal(size=(10, 1)) / waves[:, None] * np.cos(waves[:, None] * angle)).sum(axis=0)
    radius = np.exp(0.5 * height + random.uniform(-0.1, 0.1, count))
    return size * (radius / radius.max())[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def slit_square(width: float, steps: int = 20) -> Mesh:
    """A unit square with a wavy slit of a width from above, deep into it."""
    y = np.linspace(0.2, 1.0, steps)
    x = 0.5 + 0.05 * np.sin(9.0 * y)
    right, left = np.stack([x + 0.5 * width, y], axis=1)[::-1], np.stack([x - 0.5 * width, y], axis=1)
    return Mesh.from_loops([np.concatenate([[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], right, left, [(0.0, 1.0)]])])


def outline_of(mesh: Mesh) -> Loops:
    return canonical_order(mesh)[0]


def solid(outline: Loops) -> shapely.Geometry:
    return polygon(Mesh.from_loops(outline.split()))


# The hull


@SHAPES
@pytest.mark.parametrize("part", slow_after(0, [0.1, 0.4, 0.0, 1.0], thorough_after=2))
def test_it_encloses_strictly_with_exactly_the_wanted_vertices(shape: object, part: float) -> None:
    fine: Mesh = shape()  # type: ignore[operator]
    least = 3 * len(fine.loops) + 3 * (len(fine.loops) > 2)  # an island keeps the hole around it from being a triangle
    count = least + round(part * (len(fine.vertices) - least))
    clearance = 1e-5 * fine.diagonal
    coarse = QUICK.decimate(fine, count, clearance=clearance)
    assert len(coarse.vertices) == count
    assert_nested(coarse, fine)
    assert polygon(coarse).boundary.distance(polygon(fine).boundary) >= clearance
    assert verify(coarse, fine, clearance)


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(-6.0, 6.0), st.floats(0.0, 1.0))
def test_random_shapes_with_holes_at_all_scales(seed: int, exponent: float, part: float) -> None:
    random = np.random.default_rng(seed)
    loops = [3.0 * rough(random, int(random.integers(8, 150)))]
    free = 0.4 * np.hypot(*loops[0].T).min()
    if random.random() < 0.6:
        loops.append(rough(random, int(random.integers(3, 40)), free))
        if random.random() < 0.5:
            room = 0.9 * np.hypot(*loops[1].T).min() * np.cos(np.pi / 3)
            loops.append(rough(random, int(random.integers(3, 20)), room))
    place = random.normal(size=2) * 10.0 ** random.uniform(0.0, 3.0)
    fine = Mesh.from_loops([(loop + place) * 10.0**exponent for loop in loops])
    least = 3 * len(fine.loops)
    count = least + int(part * (len(fine.vertices) - least))
    try:
        coarse = QUICK.decimate(fine, count, clearance=1e-5 * fine.diagonal)
    except NestingError as error:
        assert len(loops) == 3  # only loops on both sides of a gap can be in each other's way
        coarse = QUICK.decimate(fine, smallest_named(error), clearance=1e-5 * fine.diagonal)
        count = smallest_named(error)
    assert len(coarse.vertices) == count
    assert_nested(coarse, fine)


def smallest_named(error: NestingError) -> int:
    return int(re.findall(r"ask for at least (\d+)\.$", str(error))[0])


def test_it_is_tight_and_has_no_spikes() -> None:
    disc = Mesh.from_loops([ring(200)])
    coarse = LineCycles().decimate(disc, 16)
    best = np.tan(np.pi / 16) * 16 / np.pi  # the regular polygon around a circle
    assert coarse.area / disc.area < 1.0 + 1.3 * (best - 1.0)
    for fine in (letter_a(), star()):
        for count in (12, 24):
            centred = OuterHull().decimate(fine, count).vertices - fine.vertices.mean(axis=0)
            assert np.hypot(*centred.T).max() < 1.5 * np.hypot(*(fine.vertices - fine.vertices.mean(axis=0)).T).max()


def test_more_vertices_never_cost_area_in_a_convex_shape() -> None:
    areas = [QUICK.decimate(Mesh.from_loops([ring(60)]), count).area for count in (3, 4, 5, 8, 12, 20, 40, 60)]
    assert (np.diff(areas) < 0.0).all()


def test_straight_runs_are_free() -> None:
    part = np.linspace(0.0, 1.0, 25, endpoint=False)[None, :, None]
    edges = SQUARE[:, None] * (1 - part) + np.roll(SQUARE, -1, axis=0)[:, None] * part
    assert QUICK.decimate(Mesh.from_loops([edges.reshape(-1, 2)]), 4).area < 1.001


# Counts


def test_numbers_per_loop_are_kept_even_if_the_mesh_has_not_so_many() -> None:
    fine = islands()
    wanted = [10, 7, 3, 30, 14]
    coarse = LineCycles().decimate(fine, wanted)
    assert [len(loop) for loop in coarse.loops] == wanted
    assert_nested(coarse, fine)
    coarse = QUICK.decimate(annulus(5), np.array([9, 4]))
    assert [len(loop) for loop in coarse.loops] == [9, 4]
    assert_nested(coarse, annulus(5))


@pytest.mark.parametrize(
    ("count", "says"),
    [
        (5, "A level of 5 vertices is too small: the mesh inside it has 2 loops and each needs at least 3"),
        (81, "A level of 81 vertices has more than the 80 of the mesh inside it; ask for at most 80."),
        ([3, 3, 3], "The level lists vertices for 3 loops, but the mesh inside it has 2"),
        ([12, 2], "The level gives 2 vertices to loop 1, but a loop needs at least 3."),
        (12.5, "A level needs a whole number of vertices"),
        ([12, "3"], "A level needs a whole number of vertices"),
    ],
)
@pytest.mark.parametrize("decimation", [OuterHull(), OnCurve(), ArcLength()])
def test_impossible_counts_are_refused(decimation: OuterHull | OnCurve | ArcLength, count: int, says: str) -> None:
    with pytest.raises(NestingError, match=re.escape(says)) as caught:
        decimation.decimate(annulus(40), count)
    assert caught.value.partial is None


def test_loops_in_each_others_way_are_answered_with_the_smallest_count() -> None:
    corner = np.array([(0, 0), (4, 0), (4, 2), (2, 2), (2, 4), (0, 4)], dtype=float)
    hole = corner * 0.9 + 0.1
    island = np.array([(0.3, 0.3), (3.5, 0.3), (3.5, 1.6), (1.7, 1.6), (1.7, 3.5), (0.3, 3.5)])
    fine = Mesh.from_loops([corner * 1.2 - 0.3, hole, island])
    with pytest.raises(NestingError, match=r"the smallest that was found has \d+; ask") as caught:
        QUICK.decimate(fine, 9)
    smallest = smallest_named(caught.value)
    assert 9 < smallest <= 15
    coarse = QUICK.decimate(fine, smallest)
    assert len(coarse.vertices) == smallest
    assert_nested(coarse, fine)


# Gaps and clearance


@pytest.mark.parametrize("width", [0.05, 1e-3, 1e-6, 1e-9, 1e-13])
@pytest.mark.parametrize("count", [7, 24])
def test_a_slit_is_followed_or_filled_but_the_clearance_is_kept(width: float, count: int) -> None:
    fine = slit_square(width)
    clearance = 1e-4
    coarse = QUICK.decimate(fine, count, clearance=clearance)
    assert len(coarse.vertices) == count
    assert_nested(coarse, fine)
    assert polygon(coarse).boundary.distance(polygon(fine).boundary) >= clearance
    assert coarse.area < 1.1


def test_a_bottle_with_a_narrow_neck_is_closed() -> None:
    inside = [(2.0005, 4), (2.0005, 3), (3, 2.5), (3, 1), (1, 1), (1, 2.5), (1.9995, 3), (1.9995, 4)]
    fine = Mesh.from_loops([np.array([(0, 0), (4, 0), (4, 4), *inside, (0, 4)], dtype=float)])
    coarse = QUICK.decimate(fine, 10, clearance=0.01)
    assert_nested(coarse, fine)
    assert verify(coarse, fine, 0.01)
    assert coarse.area == pytest.approx(16.0, rel=0.02)


def test_two_components_with_hardly_a_gap_stay_apart() -> None:
    fine = Mesh.from_loops([SQUARE, SQUARE + np.array([1.0 + 1e-12, 0.0])])
    assert_nested(QUICK.decimate(fine, 8, clearance=1e-5), fine)


@pytest.mark.slow
def test_a_large_clearance_is_kept_around_needles_and_dense_vertices() -> None:
    needle = np.array([(0, 0), (1, 0), (1, 0.2), (0.501, 0.2), (0.5, 2.0), (0.499, 0.2), (0, 0.2)])
    for fine in (Mesh.from_loops([needle]), Mesh.from_loops([ring(900)]), letter_a(20)):
        clearance = 0.02 * fine.diagonal
        coarse = QUICK.decimate(fine, 12 if len(fine.vertices) > 7 else 7, clearance=clearance)
        assert_nested(coarse, fine)
        assert verify(coarse, fine, clearance)


@pytest.mark.parametrize("tiny", [1e-6, 1e-12, 1e-15])
def test_vertices_that_almost_coincide_do_no_harm(tiny: float) -> None:
    fine = Mesh.from_loops([np.array([(0, 0), (1, 0), (1, 1), (0.5 + tiny, 1), (0.5, 1 - tiny), (0, 1), (0, tiny)])])
    for count in (4, 7):
        coarse = QUICK.decimate(fine, count, clearance=1e-5)
        assert_nested(coarse, fine)
        assert verify(coarse, fine, 1e-5)


def test_no_room_at_all_is_said_with_the_place() -> None:
    fine = Mesh.from_loops([SQUARE, SQUARE + np.array([np.nextafter(1.0, 2.0), 0.0])])
    with pytest.raises(NestingError, match=r"There is no room for a cage near \(1"):
        QUICK.decimate(fine, 8)


# Invariance


def test_the_numbering_of_vertices_and_loops_changes_nothing() -> None:
    fine = islands()
    random = np.random.default_rng(7)
    loops = [np.roll(fine.vertices[loop], random.integers(9), axis=0)[:: random.choice([-1, 1])] for loop in fine.loops]
    order = random.permutation(len(loops))
    coarse, other = QUICK.decimate(fine, 40), QUICK.decimate(Mesh.from_loops([loops[k] for k in order]), 40)
    for k, mine in enumerate(order):
        assert (other.vertices[other.loops[k]] == coarse.vertices[coarse.loops[mine]]).all()


@pytest.mark.slow
@SHAPES
def test_motion_and_scale_change_round_off_only(shape: object) -> None:
    fine: Mesh = shape()  # type: ignore[operator]
    coarse = QUICK.decimate(fine, 36)
    cosine, sine = np.cos(0.7), np.sin(0.7)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    for matrix, place in ((turn, (0, 0)), (1e6 * np.eye(2), (0, 0)), (1e-6 * turn, (2e-6, 1e-6)), (np.eye(2), (50, 9))):
        moved = QUICK.decimate(fine.moved(fine.vertices @ matrix + place).validated(), 36)
        assert moved.area / abs(np.linalg.det(matrix)) == pytest.approx(coarse.area, rel=1e-9)


# What it is made of


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_every_move_only_adds_area(seed: int) -> None:
    random = np.random.default_rng(seed)
    fine = Mesh.from_loops([rough(random, 60), rough(random, 12, 0.1)])
    hull = ProgressiveHull(outline_of(fine), Weights(*random.uniform(0.3, 2.0, 5)), [3, 3])
    before = solid(hull.run(60))
    for count in range(50, 5, -11):
        after = solid(hull.run(count))
        assert after.is_valid
        assert before.difference(after).area < 1e-12
        before = after


@pytest.mark.parametrize("count", slow_after(1, [60, MAX_AT_ONCE + 60]))
@given(st.integers(0, 2**32 - 1), st.floats(1e-4, 1.0))
def test_boxes_know_all_edges_near_a_box(count: int, seed: int, size: float) -> None:
    random = np.random.default_rng(seed)
    starts = random.uniform(-1.0, 1.0, (count, 2))
    ends = starts + random.normal(size=(count, 2)) * 10.0 ** random.uniform(-5.0, 0.5, (count, 1))
    boxes = EdgeBoxes(starts, ends)
    for k in range(0, count, 3):
        boxes.remove(k)
    for k in range(0, count, 6):
        starts[k] += random.normal(size=2)
        boxes.insert(k, *starts[k].tolist(), *ends[k].tolist())
    low = random.uniform(-1.0, 1.0, 2)
    found = boxes.near(*low.tolist(), *(low + size).tolist())
    meets = (np.minimum(starts, ends) <= low + size).all(axis=1) & (np.maximum(starts, ends) >= low).all(axis=1)
    removed = np.arange(count) % 6 == 3
    assert sorted(found) == np.flatnonzero(meets & ~removed).tolist()


def test_boxes_of_many_loops_are_compared_by_place() -> None:
    """Whatever the order of the loops, those around one of them are in few blocks."""
    places = np.random.default_rng(0).permutation(np.stack(np.mgrid[:20, :20], axis=-1).reshape(-1, 2))
    loops = Loops.of(np.concatenate([0.4 * ring(12) + place for place in places]), [12] * len(places))
    blocks = EdgeBoxes(loops.vertices, loops.ends)._blocks
    assert blocks is not None
    assert max(len(blocks.near(*place, *place)) for place in places.tolist()) <= 6


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=60))
def test_the_queue_gives_moves_in_order(costs: list[float]) -> None:
    queue = MoveQueue(len(costs), negligible=0.0)
    for slot, cost in enumerate(costs):
        queue.push([(0.5 * cost, slot, (7.0,))])  # obsolete
        queue.stamps[slot] += 1
        queue.push([(cost, slot, ())])
    order = []
    while (move := queue.pop(0.75)) is not None:
        assert move[1] == ()
        order.append(move[0])
    left = [cost for slot, cost in enumerate(costs) if slot not in order]
    taken = [costs[slot] for slot in order]
    assert taken == pytest.approx(sorted(taken), rel=1e-7, abs=1e-300)
    assert min(left, default=1.0) >= 0.75 * (1.0 - 1e-7)
    assert max(taken, default=0.0) <= 0.75 * (1.0 + 1e-7)


@given(st.integers(0, 2**32 - 1))
def test_triangles_know_what_lies_in_them(seed: int) -> None:
    random = np.random.default_rng(seed)
    fine = Mesh.from_loops([rough(random, 40)])
    loops = LinkedLoops(outline_of(fine), reach=1.5)
    corners = random.uniform(-1.0, 1.0, (3, 2))
    a, b, c = corners if shapely.LinearRing(corners).is_ccw else corners[::-1]
    triangle = shapely.Polygon([a, b, c])
    points = np.stack([loops.x, loops.y], axis=1)
    edges = shapely.linestrings(np.stack([points, points[loops.next]], axis=1))
    flat = [float(value) for value in (*a, *b, *c)]
    assert loops.vertex_in_triangle(*flat, own=()) == shapely.intersects_xy(triangle, points).any()
    assert loops.edge_in_triangle(*flat, own=()) == shapely.intersects(triangle, edges).any()


@SHAPES
def test_an_offset_keeps_its_distance(shape: object) -> None:
    fine: Mesh = shape()  # type: ignore[operator]
    distance = 1e-4
    moved, stuck = strict_offset(outline_of(fine), distance, fine.edge_tree)
    assert len(stuck) == 0
    assert solid(moved).boundary.distance(polygon(fine).boundary) == pytest.approx(distance, rel=1e-6)
    assert solid(moved).contains(polygon(fine))


def test_slits_are_closed_without_the_stairs_at_their_mouths() -> None:
    """Teeth of different lengths with gaps far below the clearance: only the gaps may be filled."""
    lengths = [1.0, 2.0, 1.2, 2.4, 1.7, 0.8]
    gap = 1e-7
    points = [(6.0, -1.0), (0.0, -1.0)]
    for k, length in enumerate(lengths):
        left, right = k + gap * (k > 0), k + 1.0 - gap * (k < len(lengths) - 1)
        points += [(left, 0.0)] * (k > 0) + [(left, length), (right, length)] + [(right, 0.0)] * (k < len(lengths) - 1)
    fine = Mesh.from_loops([points])
    hull = OuterHull().decimate(fine, 14, clearance=1e-4)
    assert hull.area < 1.001 * fine.area
    assert_nested(hull, fine)


def test_clearing_fills_what_is_too_narrow() -> None:
    fine = slit_square(1e-3)
    start, _ = strict_offset(outline_of(fine), 1e-5, fine.edge_tree)
    filled, kept = cleared(start, fine, 1e-2), cleared(start, fine, 2e-4)
    assert solid(filled).boundary.distance(polygon(fine).boundary) >= 1e-2
    assert solid(kept).boundary.distance(polygon(fine).boundary) >= 2e-4
    inside = np.linspace(0.2, 1.0, 20)[10]
    assert not solid(kept).covers(shapely.Point(0.5 + 0.05 * np.sin(9.0 * inside), inside))
    assert len(without_gaps(outline_of(slit_square(1e-12)), 1e-9).vertices) < 10


@given(st.lists(st.floats(0.1, 9.0), min_size=1, max_size=8), st.integers(0, 60), st.integers(1, 4))
def test_shares_are_in_proportion(lengths: list[float], extra: int, least: int) -> None:
    total = least * len(lengths) + extra
    numbers = apportioned(total, np.array(lengths), least)
    assert numbers.sum() == total
    assert (numbers >= least).all()
    spacing = np.array(lengths) / numbers
    removable = numbers > least
    if removable.any():  # nobody could give one up without having a longer spacing than the longest
        assert (np.array(lengths)[removable] / (numbers[removable] - 1) >= spacing.max() * (1 - 1e-12)).all()


def test_padding_divides_the_longest_edges_evenly() -> None:
    outline = outline_of(Mesh.from_loops([np.array([(0, 0), (6, 0), (6, 1), (0, 1)], dtype=float)]))
    (loop,) = padded(outline, 14, None)
    assert len(loop) == 14
    assert np.hypot(*(np.roll(loop, -1, axis=0) - loop).T) == pytest.approx(np.ones(14))


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_outlines_of_many_vertices_are_thinned(tolerance: float) -> None:
    """To chords within a tolerance; the hull of what is left encloses all that was there."""
    fine = Mesh.from_loops([ring(3000), disc(1000, 0.5, 0.1, 0.0), disc(6, 0.1, 3.0, 0.0)])
    outline = Loops.of(fine.vertices, [len(loop) for loop in fine.loops])
    thin = thinned(outline, tolerance)
    assert min(thin.sizes) == 6 and len(thin.vertices) < 0.5 * len(outline.vertices)
    for before, after in zip(outline.split(), thin.split(), strict=True):
        assert shapely.hausdorff_distance(shapely.LinearRing(before), shapely.LinearRing(after)) <= tolerance
    hull = QUICK.decimate(fine, 30)
    assert_nested(hull, fine)
    assert hull.area < 1.1 * fine.area
