"""What files paint as one region: overlaps, contacts, fill rules and hairlines, against shapely and exact fractions."""

import json
import math
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import nestedcages_core as core
from nestedcages_core import InvalidMeshError, Mesh, NestedCagesError, from_svg, joined, nested_cages, svg_drawing
from support.documents import area_of, refusal, solid, svg
from support.marks import slow_after
from support.shapes import ring

OUTER, INNER = "M0 0 H10 V10 H0 Z", "M2 2 H8 V8 H2 Z"
INNER_BACK, DEEP = "M2 2 V8 H8 V2 Z", "M4 4 H6 V6 H4 Z"


@pytest.mark.parametrize(
    ("data", "rule", "area"),
    [(f"{OUTER} {INNER}", "evenodd", 64.0), (f"{OUTER} {INNER}", "nonzero", 100.0),
     (f"{OUTER} {INNER_BACK}", "nonzero", 64.0), (f"{OUTER} {INNER_BACK}", "evenodd", 64.0),
     (f"{OUTER} {INNER} {DEEP}", "evenodd", 68.0), (f"{OUTER} {INNER} {DEEP}", "nonzero", 100.0),
     (f"{OUTER} {INNER_BACK} {DEEP}", "nonzero", 68.0)],
)  # fmt: skip
def test_fill_rules(data: str, rule: str, area: float) -> None:
    assert area_of(f'<path fill-rule="{rule}" d="{data}"/>') == area
    assert area_of(f'<path style="fill-rule:{rule}" d="{data}"/>') == area


def path_of(loops: list[np.ndarray], rule: str = "nonzero") -> str:
    data = "".join(f"M{' '.join(f'{x!r} {y!r}' for x, y in loop.tolist())}z" for loop in loops)
    return f'<path fill-rule="{rule}" d="{data}"/>'


def winding(point: np.ndarray, loops: list[np.ndarray]) -> int:
    """Of closed loops around a point, in fractions."""
    x, y = map(Fraction, point.tolist())
    total = 0
    for loop in loops:
        corners = [(Fraction(a) - x, Fraction(b) - y) for a, b in loop.tolist()]
        for (ax, ay), (bx, by) in zip(corners, [*corners[1:], corners[0]], strict=True):
            if (ay <= 0) != (by <= 0):
                turn = ax * by - ay * bx
                total += (turn > 0) - (turn < 0) if (by > 0) == (turn > 0) else 0
    return total


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000), st.booleans())
def test_unions_agree_with_exact_winding_numbers(seed: int, evenodd: bool) -> None:
    rng = np.random.default_rng(seed)
    loops = [rng.integers(-8, 9, (int(rng.integers(3, 9)), 2)).astype(float) for _ in range(int(rng.integers(1, 4)))]
    points = rng.uniform(-9.0, 9.0, (60, 2))
    turns = np.array([winding(point, loops) for point in points])
    expected = turns % 2 == 1 if evenodd else turns != 0
    try:
        found = solid(from_svg(svg(path_of(loops, "evenodd" if evenodd else "nonzero"))))
    except NestedCagesError:
        assert not expected.any()
        return
    assert found.is_valid
    near = shapely.distance(shapely.points(points), found.boundary) < 0.01  # touching corners are joined by necks
    assert ((shapely.contains_xy(found, *points.T) == expected) | near).all()


def blob(seed: int, count: int = 24) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return ring(count) * rng.uniform(0.4, 1.0, count)[:, None] + rng.uniform(-0.6, 0.6, 2)


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@given(st.lists(st.integers(0, 10_000), min_size=3, max_size=5, unique=True))
def test_overlapping_and_clipped_shapes_are_those_of_shapely(seeds: list[int]) -> None:
    first, *others = [blob(seed) for seed in seeds]
    own, clip = shapely.Polygon(first), shapely.union_all([shapely.Polygon(points) for points in others])
    rest = "".join(path_of([points]) for points in others)
    whole = solid(from_svg(svg(path_of([first]) + rest)))
    assert whole.symmetric_difference(own | clip).area < 1e-3
    assert solid_of(f'<clipPath id="c">{rest}</clipPath><g clip-path="url(#c)">{path_of([first])}</g>').area == (
        pytest.approx((own & clip).area, abs=1e-3)
    )
    mask = f'<mask id="m"><path d="M-9-9h18v18h-18z" fill="white"/>{rest}</mask>'
    assert solid_of(f'{mask}<g mask="url(#m)">{path_of([first])}</g>').area == pytest.approx(
        (own - clip).area, abs=1e-3
    )


def solid_of(body: str) -> shapely.Geometry:
    """What a document paints; empty for nothing."""
    try:
        return solid(from_svg(svg(body)))
    except InvalidMeshError:
        return shapely.Polygon()


def test_nested_loops_keep_their_points_whoever_paints_them() -> None:
    rings = [ring(40, radius) * math.pi for radius in (5.0, 4.0, 3.0, 2.0)]
    both = from_svg(svg(path_of(rings[:2], "evenodd") + path_of(rings[2:], "evenodd")))
    assert both.loop_signs.tolist() == [1, -1, 1, -1]
    assert {*map(tuple, both.vertices.tolist())} == {*map(tuple, np.concatenate(rings).tolist())}
    covered = path_of(rings[:2], "evenodd") + path_of([rings[1] * 1.1]) + path_of([rings[3]])
    assert len(from_svg(svg(covered)).loops) == 1


def test_what_touches_in_a_point_becomes_one() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    chess = [square + np.array([x, y]) for x in range(4) for y in range(4) if (x + y) % 2]
    found = from_svg(svg("".join(path_of([loop]) for loop in chess)))
    assert len(found.loops) == 1 + 2  # the two inner squares left blank are holes
    area = solid(found)
    assert area.is_valid
    assert all(area.covers(shapely.Polygon(loop)) for loop in chess)
    assert area.area == pytest.approx(8.0, abs=1e-2)


@pytest.mark.parametrize("ulps", [-3, -1, 1, 3])
def test_parts_that_sums_of_decimals_put_an_ulp_apart_touch(ulps: int) -> None:
    """Or overlap by as much: they have a neck, and there is room for a cage."""
    corner = 8.0 + ulps * np.spacing(8.0)
    square, ear = np.array([(0, 0), (8, 0), (8, 8), (0, 8)], float), np.array([(corner, corner), (9, 8.5), (8.5, 9)])
    mesh = from_svg(svg(path_of([square]) + path_of([ear])))
    assert len(mesh.loops) == 1
    assert mesh.area == pytest.approx(64.375, abs=1e-2)
    assert nested_cages(mesh, [7]).levels[0].report.strict


@pytest.mark.parametrize("off", [0.0, 1e-16, 4e-16, 1e-14, 1e-12, 1e-10, 1e-8])
def test_shapes_that_nearly_touch_are_told_apart_or_joined(off: float) -> None:
    """Relative path data end off where they began by rounding, and neighbours share edges but for the last digits."""
    data = f"M0 0h2v1h-2z M2 {off!r}h2v1h-2z M{off!r} 1h4v1h-4z M1 {2 + off!r}h1v{1 + off!r}h{-1 - off!r}z m0 {off!r}"
    found = from_svg(svg(f'<path d="{data}"/>'))
    assert found.area == pytest.approx(9.0, abs=1e-5)


def test_edges_in_common_vanish() -> None:
    unit = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    tiles = [path_of([unit + np.array([x, y])]) for x in range(3) for y in range(3)]
    whole = from_svg(svg("".join(tiles)))
    assert (whole.area, len(whole.loops)) == (pytest.approx(9.0), 1)
    frame = from_svg(svg("".join(tile for k, tile in enumerate(tiles) if k != 4)))
    assert (frame.area, sorted(frame.loop_signs.tolist())) == (pytest.approx(8.0), [-1, 1])
    assert area_of(path_of([unit]) + path_of([unit[::-1]])) == 1.0
    left = 2.0 * unit
    for other, area in ((left + np.array([2.0, 1.0]), 8.0), (0.5 * left + np.array([2.0, 0.5]), 5.0)):
        assert area_of(path_of([left]) + path_of([other])) == pytest.approx(area)


HAIRLINES = {
    "hole": "M0 0H10V10H0zM2 2h6v{0}h-6z",
    "triangular hole": "M0 0H10V10H0zM2 2h6l-6 {0}z",
    "speck": "M0 0H10V10H0zM2 2h{0}v{0}h-{0}z",
    "notch": "M0 0H10V5H3v{0}H10V10H0z",
    "sharp notch": "M0 0H10V5H3L10 {1}V10H0z",
    "gap": "M0 0H10V5H0zM0 {1}H10V10H0z",
    "spike": "M0 0H10V5H12v{0}H10V10H0z",
    "sharp spike": "M0 0H10V5H12L10 {1}V10H0z",
    "crumb as a spike": "M0 0H10V10H0zM11 5h{0}v{0}z",
}


@pytest.mark.parametrize("name", HAIRLINES)
@pytest.mark.parametrize("width", slow_after(1, [1e-15, 1e-8, 5e-4], thorough_after=2))
def test_hairlines_are_no_trouble_for_cages(name: str, width: float) -> None:
    drawing = svg_drawing(svg(f'<path fill-rule="evenodd" d="{HAIRLINES[name].format(width, 5.0 + width)}"/>'))
    assert len(drawing.mesh.loops) == 1
    assert drawing.mesh.area == pytest.approx(100.0, abs=2e-3)
    assert drawing.notes or width < 1e-11  # less is rounding, of which nothing needs to be said
    assert nested_cages(drawing.mesh, [4]).levels[0].report.excess < 1e-3


def test_narrow_parts_and_necks_stay() -> None:
    """So do sharp corners, and everything else to the last bit."""
    for loops in (
        [[(0, 0), (8, 0), (8, 10), (0, 10)], [(9, 0), (9.5, 0), (9.5, 4e-3), (9, 4e-3)]],
        [[(0, 0), (4, 0), (4, 5), (6, 5), (6, 0), (10, 0), (10, 9), (6, 9), (6, 5.0001), (4, 5.0001), (4, 9), (0, 9)]],
        [[(0, 0), (10, 0), (0, 1)]],
    ):
        drawing = svg_drawing(svg(path_of([np.array(loop, float) for loop in loops])))
        assert sorted(map(tuple, drawing.mesh.vertices)) == sorted(point for loop in loops for point in loop)
        assert not drawing.notes


def speckled() -> list[np.ndarray]:
    """A disc with a speck beside it, and a hole and a hair too small to be seen, among others that are seen."""
    hair = np.array([[1.3, 0.0], [1.3 + 1e-3, 0.0], [1.3 + 1e-3, 1e-4], [1.3, 1e-4]])
    seen = [ring(40), 0.2 * ring(12), ring(8, 0.05) + np.array([1.4, 0.3])]
    return [*seen, ring(6, 2e-4) + np.array([1.2, 0.2]), ring(6, 2e-4) + 0.5, hair]


@pytest.mark.parametrize("angle", [0.0, 1.1])
def test_what_is_smaller_than_a_pixel_costs_no_vertices(angle: float, tmp_path: Path) -> None:
    turn = 100.0 * np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    body = path_of([(loop @ turn + 200.0).round(9) for loop in speckled()], "evenodd")
    (tmp_path / "a.svg").write_text(svg(body, 'width="400" height="400"'))
    found = core.read_svg_drawing(tmp_path / "a.svg")
    assert (len(found.mesh.loops), len(found.notes)) == (3, 1)
    level = nested_cages(found.mesh, 40)[0]
    assert len(level.cage.vertices) <= 40 and not any(note.code == "note.loops" for note in level.report.notes)


def test_maps_lose_what_is_smaller_than_a_tenth_of_the_tolerance_both_ways() -> None:
    text = json.loads(core.to_geojson([Mesh.from_loops(speckled())]))
    assert len(core.from_geojson(text).loops) == 6
    with pytest.warns(UserWarning):
        (found,) = core.features_from_geojson(text, tolerance=0.005)
    assert len(found.mesh.loops) == 3 and found.repairs


def test_parts_closer_than_a_distance_are_joined() -> None:
    square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    apart = Mesh.from_loops([square, square + np.array([4.5, 0.0])])
    assert joined(apart, 0.4) is apart
    bridged = joined(apart, 0.6)
    assert len(bridged.loops) == 1
    assert bridged.area == pytest.approx(34.0)
    assert {tuple(corner) for corner in apart.vertices.tolist()} <= {tuple(at) for at in bridged.vertices.tolist()}
    slit = Mesh.from_loops([[(0, 0), (9, 0), (9, 4), (5.1, 4), (5.1, 1), (5, 1), (5, 4), (0, 4)]])
    assert joined(slit, 0.2).area == pytest.approx(36.0)
    refusal(joined, apart, 0.0)


def test_without_shapely_plain_drawings_are_read_and_others_name_it(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("shapely", "tinycss2", "cssselect2"):
        monkeypatch.setitem(sys.modules, name, None)
    plain = '<rect width="10" height="10"/>'
    assert area_of(f'{plain}<circle cx="30" cy="5" r="3" fill="#f00"/>') == pytest.approx(100.0 + 9.0 * math.pi, 1e-2)
    whole = '<clipPath id="c"><path d="M-1 -1h20v20h-20z"/></clipPath>'
    assert area_of(f'{whole}<g clip-path="url(#c)">{plain}</g>') == 100.0  # as drawing programs write around everything
    for body, library in (
        ('<path fill="none" stroke="red" d="M0 0H10"/>', "shapely"),
        (plain + '<rect x="5" width="10" height="9"/>', "shapely"),
        (f"<style>rect{{fill:red}}</style>{plain}", "tinycss2"),
    ):
        error = refusal(from_svg, svg(body))
        assert error.code == "dependency.missing" and library in error.data["library"]
