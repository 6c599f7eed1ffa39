"""Coarse meshes with so many vertices: what each decimation promises, and cages next to the best there are."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import ArcLength, LineCycles, Mesh, NestingError, OnCurve, OwnDecimation, nested_cages, verify
from support.families import drawing, smallest_around
from support.judging import codes, gap, never_rises, rejected
from support.marks import slow_after
from support.shapes import annulus, assert_nested, comb, islands, letter_a, polygon, resampled, ring, star, turned

ALL = pytest.mark.parametrize("method", [LineCycles(), ArcLength(), OnCurve()], ids=lambda each: type(each).__name__)
ON_CURVE = pytest.mark.parametrize("method", [ArcLength(), OnCurve()], ids=lambda each: type(each).__name__)
SHAPES = {"letter": letter_a(), "star": star(), "ring": annulus(60), "islands": islands()}
SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


def dense_square(per_side: int = 25) -> Mesh:
    return resampled(Mesh.from_loops([SQUARE]), 4 * per_side)


# What every decimation promises


@ALL
@pytest.mark.parametrize(
    ("count", "code", "data"),
    [
        (5, "count.too_small", {"total": 5, "least": 6}),
        ([3, 3, 3], "count.per_loop", {}),
        ([12, 2], "count.too_small", {}),
        (12.5, "level.invalid", {}),
        ([12, "3"], "level.invalid", {}),
    ],
)
def test_impossible_counts_are_refused(method: Any, count: Any, code: str, data: dict[str, int]) -> None:
    with rejected(code, NestingError, **data) as caught:
        method.decimate(annulus(40), count)
    assert caught.value.partial is None


@ALL
def test_each_loop_gets_at_most_the_vertices_that_are_listed_for_it(method: Any) -> None:
    """Also where the drawing has fewer."""
    for fine, counts in ((islands(), [10, 7, 3, 30, 14]), (annulus(5), np.array([9, 4]))):
        coarse = method.decimate(fine, counts)
        assert (coarse.loop_signs == fine.loop_signs).all()
        assert all(3 <= len(loop) <= count for loop, count in zip(coarse.loops, counts, strict=True))


@ALL
def test_more_vertices_than_the_drawing_has_are_as_many(method: Any) -> None:
    assert len(method.decimate(annulus(40), 200).vertices) <= 80


@ALL
@pytest.mark.parametrize("name", ["letter", "islands"])
def test_the_numbering_of_vertices_and_loops_changes_nothing(method: Any, name: str) -> None:
    fine = SHAPES[name]
    rolled = [np.roll(loop, 5, axis=0)[:: 1 - 2 * (k % 2)] for k, loop in enumerate(fine.rings)]
    coarse, other = method.decimate(fine, 36), method.decimate(Mesh.from_loops(rolled[::-1]), 36)
    for mine, yours in zip(coarse.rings, other.rings[::-1], strict=True):
        assert sorted(map(tuple, mine.tolist())) == sorted(map(tuple, yours.tolist()))


@pytest.mark.parametrize("method", [LineCycles(), ArcLength()], ids=lambda each: type(each).__name__)
@pytest.mark.parametrize(
    ("angle", "scale", "place"),
    slow_after(2, [(0.7, 1e-6, (2e-6, 1e-6)), (2.5, 7e3, (1e4, 1e4)), (0.7, 1.0, (0, 0)), (0, 1e6, (0, 0))]),
)
def test_place_size_and_angle_change_nothing(method: Any, angle: float, scale: float, place: Any) -> None:
    for name in ("letter", "islands"):
        fine = SHAPES[name]
        moved = fine.moved(scale * turned(fine.vertices, angle) + place).validated()
        areas = [method.decimate(each, 30).area for each in (fine, moved)]
        exact = 1e-9 if isinstance(method, ArcLength) else 5e-3  # of alike lines, rounding may take another
        assert areas[1] / scale**2 == pytest.approx(areas[0], rel=exact)


TINY_EDGES = {
    "square underflows": [(0, 0), (1, 0), (0, 1), (0, 1e-200)],
    "subnormal": [(0, 0), (1, 0), (1, 1), (0.5, 1.5), (0, 1), (0, 1e-310)],
    "no area in float64": [(0, 1), (1.2e-38, 0), (-1, 0), (0, 1.2e-38)],
    "subnormal corners": [(0, 0), (1e-320, 0), (1, 0), (1, 1), (0, 1), (0, 1e-320)],
}


@pytest.mark.parametrize("name", slow_after(1, TINY_EDGES))
def test_edges_whose_squares_underflow_are_caged(name: str) -> None:
    fine = Mesh.from_loops([TINY_EDGES[name]])
    for count in (3, 4):
        level = nested_cages(fine, count)[0]
        assert level.report.strict and level.report.simple and len(level.cage.vertices) <= count
        for method in (OnCurve(), ArcLength()):
            try:
                assert len(method.decimate(fine, count, clearance=1e-5).vertices) == count
            except NestingError as error:
                assert error.code in {"count.too_small", "clearance.no_room", "unknown"}


# Line cycles

AREAS = {  # of the start, in areas of the shape
    "letter": {17: 1.1917, 21: 1.1268, 40: 1.0337},
    "star": {17: 1.2034, 21: 1.1321, 40: 1.0312},
    "ring": {17: 1.0917, 21: 1.0567, 40: 1.0155},
    "islands": {17: 2.2388, 21: 1.4698, 40: 1.1072},
}


@pytest.mark.parametrize("name", slow_after(1, SHAPES))
def test_lines_enclose_the_shape_closely_with_the_vertices_asked_for(name: str) -> None:
    fine, areas = SHAPES[name], []
    for count in (17, 18, 21, 27, 40):
        mesh = LineCycles().decimate(fine, count)
        assert len(mesh.vertices) == count and verify(mesh, fine)
        areas.append(mesh.area)
        assert mesh.area <= 1.005 * AREAS[name].get(count, np.inf) * fine.area
    assert never_rises(areas, 0.0)


@pytest.mark.parametrize(
    ("width", "clearance", "excess"),
    slow_after(1, [(0.02, 1e-6, 0.04), (1e-5, 1e-5, 1e-3), (1e-13, 1e-4, 2e-3), (1e-3, 1e-4, 2e-3), (0.02, 0.0, 0.04)]),
)
def test_slits_are_followed_or_filled_but_the_clearance_holds(width: float, clearance: float, excess: float) -> None:
    fine = comb(3, width)
    for count in (17, 24):
        mesh = LineCycles().decimate(fine, count, clearance=clearance)
        assert len(mesh.vertices) <= count and verify(mesh, fine, clearance)
        assert gap(mesh, fine) >= clearance * (1.0 - 1e-9)
        assert mesh.area <= (1.0 + excess) * polygon(fine).area + 3 * width * 0.5


def test_a_spiral_is_bridged_far_along_its_outline() -> None:
    turn = np.linspace(0.0, 6.0 * np.pi, 120)
    ray = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    middle = (0.2 + 0.8 * turn / turn[-1])[:, None] * ray
    spiral = Mesh.from_loops([np.concatenate([middle + 0.05 * ray, (middle - 0.05 * ray)[::-1]])])
    mesh = LineCycles().decimate(spiral, 17)
    assert verify(mesh, spiral) and mesh.area < 1.03 * polygon(spiral).convex_hull.area


def test_a_small_hole_in_a_large_solid_is_followed() -> None:
    hole = 0.004 * np.array([[0.0, 0.0], [0.3, 1.0], [0.55, 0.2], [0.5, -0.1]])
    fine = Mesh.from_loops([ring(40), hole])
    mesh = LineCycles().decimate(fine, 16)
    assert_nested(mesh, fine)
    assert mesh.area < 1.1 * fine.area


@pytest.mark.slow
def test_large_counts_have_no_steps() -> None:
    turn = 2.0 * np.pi * np.arange(700) / 700
    radius = 1.0 + sum(0.2 / k**1.1 * np.cos(k * turn + k * k) for k in range(2, 40, 3))
    fine = Mesh.from_loops([radius[:, None] * ring(700)])
    areas = [LineCycles().decimate(fine, count).area / fine.area for count in (126, 128, 130, 190)]
    assert areas == sorted(areas, reverse=True) and areas[0] < 1.0025 and areas[-1] < 1.001


def test_large_noisy_drawings_without_steps_are_caged_closely() -> None:
    turn, noise = 2.0 * np.pi * np.arange(6000) / 6000, np.random.default_rng(0).normal(size=6000)
    radius = (
        1.0 + 0.2 * np.cos(5 * turn + 0.3) + 0.1 * np.cos(11 * turn + 1) + 0.05 * np.cos(37 * turn + 2) + 1e-4 * noise
    )
    excesses = [nested_cages(radius[:, None] * ring(6000), count, steps=False)[0].excess for count in (60, 160)]
    assert excesses[1] < 0.25 * excesses[0] < 0.01


@pytest.mark.slow
def test_many_loops_are_enclosed_one_by_one() -> None:
    for side in (9, 10):
        places = np.stack(np.mgrid[:side, :side], axis=-1).reshape(-1, 2)
        fine = Mesh.from_loops([0.4 * ring(8) + place for place in places])
        mesh = LineCycles().decimate(fine, 5 * side**2)
        assert verify(mesh, fine) and len(mesh.vertices) == 5 * side**2
        assert mesh.area < 1.35 * fine.area


def test_both_ways_of_starting_lead_to_the_same_cage() -> None:
    """The paper's, with vertices on the curve, and from lines around it, where the motion has a single step."""
    fine = letter_a()
    curve, outside = (
        nested_cages(fine, 20, core.Settings(decimation=LineCycles(on_curve=way), loops="keep"))[0]
        for way in (True, False)
    )
    assert curve.report.start == "flow" != outside.report.start
    on_it = shapely.distance(polygon(fine).boundary, shapely.points(curve.coarse.vertices))
    assert on_it.max() < 1e-12 and verify(outside.coarse, fine)
    assert curve.excess == pytest.approx(outside.excess, rel=0.01)
    with rejected("setting.invalid"):
        LineCycles(on_curve=2)  # type: ignore[arg-type]


# What a decimation must obey


@pytest.mark.parametrize("decimation", [ArcLength(), LineCycles(), LineCycles(on_curve=False), OnCurve()], ids=repr)
def test_our_own_decimations_obey_what_they_must(decimation: Any) -> None:
    core.check_decimation(decimation)


@dataclass(frozen=True)
class Wrong:
    """Makes of even spacings what a function makes of these."""

    made: Callable[[Mesh, Mesh], Any]
    too_few: bool = False

    def decimate(self, fine: Mesh, count: Any, *, clearance: float = 0.0) -> Any:
        few = self.too_few and count == 3 * len(fine.loops) - 1
        return self.made(ArcLength().decimate(fine, 3 * len(fine.loops) if few else count), fine)


WRONG: dict[str, tuple[Wrong, str]] = {
    "no mesh": (Wrong(lambda coarse, fine: coarse.rings), "instead of a Mesh"),
    "too many vertices": (Wrong(lambda coarse, fine: fine), "makes"),
    "other loops": (Wrong(lambda coarse, fine: Mesh.from_loops([ring(3, 0.1), ring(3, 0.1) + 9.0])), "other loops"),
    "others each time": (
        Wrong(lambda coarse, fine: coarse.moved(coarse.vertices * np.random.default_rng().uniform(0.9, 1.0))),
        "another mesh each time",
    ),
    "one of too few vertices": (Wrong(lambda coarse, fine: coarse, too_few=True), "less than 3 a loop"),
}  # fmt: skip


@pytest.mark.parametrize(("decimation", "said"), WRONG.values(), ids=WRONG.keys())
def test_what_a_decimation_does_wrong_is_named(decimation: Any, said: str) -> None:
    with rejected("method.wrong", name="Wrong") as caught:
        core.check_decimation(decimation)
    assert said in str(caught.value)


# On the curve


@ON_CURVE
@pytest.mark.parametrize("name", SHAPES)
def test_vertices_lie_on_their_loops_in_order(method: Any, name: str) -> None:
    fine = SHAPES[name]
    count = 9 * len(fine.loops)
    coarse = method.decimate(fine, count)
    assert len(coarse.vertices) == count and polygon(coarse).is_valid
    assert (coarse.loop_signs == fine.loop_signs).all()
    assert (coarse.component_of_loop == fine.component_of_loop).all()
    for mine, of_fine in zip(coarse.rings, fine.rings, strict=True):
        curve, points = shapely.LinearRing(of_fine), shapely.points(mine)
        assert len(mine) >= 3 and shapely.distance(curve, points).max() < 1e-12
        along = shapely.line_locate_point(curve, points)
        assert (np.diff(np.append(along, along[0])) < 0.0).sum() == 1  # once around, forwards


@pytest.mark.parametrize(
    ("corners", "inner", "count"),
    slow_after(4, [(30, 0.5, 20), (60, 0.9, 17), (3, 0.2, 6), (12, 0.3, 40), (50, 0.1, 9)]),
)
def test_even_spacing_is_in_proportion_to_length(corners: int, inner: float, count: int) -> None:
    fine = annulus(corners, inner)
    coarse = ArcLength().decimate(fine, min(count, 2 * corners))
    sizes = [len(loop) for loop in coarse.loops]
    assert sum(sizes) == min(count, 2 * corners)
    for mine, of_fine in zip(coarse.rings, fine.rings, strict=True):
        curve = shapely.LinearRing(of_fine)
        along = np.sort(shapely.line_locate_point(curve, shapely.points(mine)))
        assert np.diff(along) == pytest.approx(curve.length / len(mine), rel=1e-6)
    removable = [k for k in range(2) if sizes[k] > 3]
    lengths = [shapely.LinearRing(each).length for each in fine.rings]
    longest = max(length / size for length, size in zip(lengths, sizes, strict=True))
    assert all(lengths[k] / (sizes[k] - 1) >= longest * (1.0 - 1e-9) for k in removable)  # none could give one up


def test_loops_that_even_points_cannot_follow_are_refused() -> None:
    """Close rings cross with points at the same angles, and do not with others; very close ones always do."""
    assert polygon(ArcLength().decimate(annulus(96, 0.9), [8, 8])).is_valid
    with rejected("count.too_small", NestingError):
        ArcLength().decimate(annulus(96, 0.99), [4, 9])


def test_vertices_on_the_curve_are_at_its_corners() -> None:
    corners = OnCurve().decimate(dense_square(), 4).vertices.round(12)
    assert sorted(map(tuple, corners.tolist())) == sorted(map(tuple, SQUARE.tolist()))
    with rejected("setting.invalid"):
        OnCurve(around=3)  # type: ignore[arg-type]


# Of one's own


def every_fourth(loops: Any, count: Any) -> list[Any]:
    return [loop[::4] for loop in loops]


def test_a_decimation_of_ones_own_is_used_and_checked() -> None:
    fine = annulus(48)
    level = nested_cages(fine, 24, decimation=OwnDecimation(every_fourth))[0]
    assert_nested(level.cage, level.fine)
    assert set(map(tuple, level.coarse.vertices.tolist())) <= set(map(tuple, fine.vertices.tolist()))
    crossed = OwnDecimation(lambda loops, count: [loops[0][[0, 24, 12, 36]], loops[1][::4]])
    for wrong in (OwnDecimation(every_fourth), crossed):
        with pytest.raises(NestingError):
            wrong.decimate(fine, 20)
    with rejected("setting.invalid"):
        OwnDecimation(3)  # type: ignore[arg-type]


@dataclass(frozen=True)
class Fewer:
    """Two vertices less than asked for."""

    def decimate(self, fine: Mesh, count: Any, *, clearance: float = 0.0) -> Mesh:
        return LineCycles().decimate(fine, count - 2, clearance=clearance)


def test_any_object_that_decimates_is_a_decimation() -> None:
    level = nested_cages(Mesh.from_loops([ring(20)]), 8, decimation=Fewer())[0]
    (note,) = [each for each in level.report.notes if each.code == "note.count"]
    assert (len(level.cage.vertices), note.data["asked"], note.data["given"]) == (6, 8, 6)
    assert codes(nested_cages(Mesh.from_loops([ring(20)]), 8, decimation=LineCycles(on_curve=False))[0]) == []
    with rejected("setting.invalid"):
        core.Settings(decimation=object())  # type: ignore[arg-type]


# Next to the best there are


@pytest.mark.parametrize("count", slow_after(1, [3, 7, 12, 4, 5, 6, 16], thorough_after=4))
def test_around_a_disc_the_regular_polygon_is_found(count: int) -> None:
    fine = Mesh.from_loops([ring(400)])
    best = count * np.tan(np.pi / count)
    assert nested_cages(fine, count)[0].cage.area == pytest.approx(best, rel=1e-3)
    assert LineCycles().decimate(fine, count).area == pytest.approx(best, rel=1e-3)


def test_straight_sides_cost_nothing() -> None:
    """The smallest triangle around a square is twice as large; parallelograms and their holes are themselves."""
    fine = dense_square().moved(3.0 * turned(dense_square().vertices, 0.4) + (5.0, -2.0)).validated()
    areas = {count: nested_cages(fine, count, clearance=1e-9)[0].cage.area / 9.0 for count in (3, 4, 9)}
    assert areas == pytest.approx({3: 2.0, 4: 1.0, 9: 1.0}, rel=1e-5)
    frame = Mesh.from_loops([resampled(Mesh.from_loops([each]), 60).vertices for each in (3.0 * SQUARE, SQUARE + 1.0)])
    assert nested_cages(frame, 8, clearance=1e-9)[0].cage.area == pytest.approx(8.0, rel=1e-5)


def hull_of(seed: int) -> np.ndarray:
    """Corners of a convex polygon, counter-clockwise."""
    random = np.random.default_rng(seed)
    points = random.normal(size=(20, 2)) * [1.0, random.uniform(0.2, 1.0)]
    return shapely.get_coordinates(shapely.MultiPoint(points).convex_hull.exterior.normalize())[:-1][::-1]


@pytest.mark.parametrize("seed", slow_after(1, range(10), thorough_after=5))
def test_around_a_convex_shape_the_smallest_polygon_is_found(seed: int) -> None:
    """Of all with all edges but one along those of the shape."""
    corners = hull_of(seed)
    fine = Mesh.from_loops([corners])
    for count in range(3, min(6, len(corners)) + 1):
        best = smallest_around(fine.rings[0], count)
        cage = nested_cages(fine, count, clearance=1e-9)[0].cage
        assert cage.area <= best + 1e-3 * (best - fine.area) + 1e-6 * best
        assert LineCycles().decimate(fine, count).area <= best * 1.01


def test_a_small_shape_gets_the_best_cage_there_is() -> None:
    """All lines a degree apart, in all cycles, lead to 13.04 %."""
    points = [(0.715, 0.0), (0.443, 0.322), (0.208, 0.641), (-0.251, 0.771), (-0.413, 0.3), (-0.937, 0.0)]
    fine = Mesh.from_loops([[*points, (-0.75, -0.545), (-0.161, -0.497), (0.278, -0.857), (0.479, -0.348)]])
    assert nested_cages(fine, 6)[0].excess < 0.1306


@pytest.mark.parametrize("seed", slow_after(0, range(5), thorough_after=1))
@pytest.mark.parametrize("spikes", [9, 40])
def test_no_vertex_of_a_small_cage_runs_away_from_spikes(seed: int, spikes: int) -> None:
    random = np.random.default_rng(seed)
    turn = np.sort(random.uniform(0.0, 2.0 * np.pi, spikes))
    outline = random.uniform(0.02, 1.0, (spikes, 1)) * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    fine = Mesh.from_loops([outline])
    low, high = outline.min(axis=0), outline.max(axis=0)
    for count in (4, 5, 7):
        cage = nested_cages(fine, count)[0].cage.vertices
        beyond = np.maximum(0.0, np.maximum(low - cage, cage - high))
        assert np.hypot(*beyond.T).max() < 0.6 * fine.diagonal


# More vertices


@pytest.mark.parametrize(("gap_width", "tight"), slow_after(0, [(0.5, 0.1), (0.5, 0.0), (1.5, 0.1)], thorough_after=1))
def test_more_vertices_around_a_comb_are_never_worse(gap_width: float, tight: float) -> None:
    side = 1.0 / (1.0 + gap_width)
    teeth = [shapely.box(k, -0.1, k + side, 3.0 - 0.2 * k) for k in range(6)]
    fine = shapely.affinity.rotate(shapely.union_all([shapely.box(0.0, -1.0, 6.0, 0.0), *teeth]), 0.3, (0, 0))
    options = {"clearance": tight} if tight else {}
    assert never_rises([nested_cages(fine, count, **options)[0].cage.area for count in range(8, 20)], 1e-4)


@pytest.mark.parametrize("turns", slow_after(0, [7.0, 10.0, 13.0], thorough_after=1))
def test_more_vertices_around_a_spiral_are_never_worse(turns: float) -> None:
    turn = np.linspace(0.6, turns, 30)
    band = shapely.LineString(turn[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)).buffer(1.2, quad_segs=3)
    assert never_rises([nested_cages(band, count)[0].cage.area for count in (9, 10, 11, 12, 14, 16)], 1e-3)


@pytest.mark.parametrize("seed", slow_after(1, range(24), thorough_after=6))
def test_more_vertices_around_a_random_outline_are_never_worse(seed: int) -> None:
    """Cages end in local minima, so half a per cent is allowed."""
    fine = drawing(100 + seed)
    single = Mesh.from_loops([max(fine.rings, key=lambda each: shapely.Polygon(each).area)])
    excess = [
        nested_cages(single, count)[0].excess for count in (4, 5, 6, 8, 11, 16, 24) if count <= len(single.vertices)
    ]
    assert all(after <= 1.005 * before + 1e-9 for before, after in pairwise(excess))
