"""What files paint as one region: overlaps, contacts, fill rules and hairlines, against shapely and exact fractions."""

import math
import subprocess
import sys
import warnings
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import nestedcages_core as core
from nestedcages_core import InvalidMeshError, Mesh, from_svg, joined, nested_cages, svg_drawing
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


HAIRLINES = {
    "hole": "M0 0H10V10H0zM2 2h6v{0}h-6z",
    "triangular hole": "M0 0H10V10H0zM2 2h6l-6 {0}z",
    "speck": "M0 0H10V10H0zM2 2h{0}v{0}h-{0}z",
    "notch": "M0 0H10V5H3v{0}H10V10H0z",
    "sharp notch": "M0 0H10V5H3L10 {1}V10H0z",
    "gap": "M0 0H10V5H0zM0 {1}H10V10H0z",
}
SPIKES = {
    "spike": "M0 0H10V5H12v{0}H10V10H0z",
    "sharp spike": "M0 0H10V5H12L10 {1}V10H0z",
    "speck": "M0 0H10V10H0zM11 5h{0}v{0}z",
}


@pytest.mark.parametrize("name", HAIRLINES)
@pytest.mark.parametrize("width", slow_after(1, [1e-15, 1e-8, 1e-4], thorough_after=2))
def test_gaps_without_room_are_no_trouble_for_cages(name: str, width: float) -> None:
    drawing = svg_drawing(svg(f'<path fill-rule="evenodd" d="{HAIRLINES[name].format(width, 5.0 + width)}"/>'))
    assert len(drawing.mesh.loops) == 1
    assert drawing.mesh.area == pytest.approx(100.0, abs=2e-3)
    assert drawing.notes or width < 1e-11 or "sharp" in name  # less is rounding, of which nothing needs to be said
    assert nested_cages(drawing.mesh, [4]).levels[0].report.excess < 1e-3


@pytest.mark.parametrize("name", SPIKES)
@pytest.mark.parametrize("width", [1e-8, 5e-4])
def test_specks_and_spikes_stay_unless_they_are_not_wanted(name: str, width: float) -> None:
    text = svg(f'<path d="{SPIKES[name].format(width, 5.0 + width)}"/>')
    drawing = svg_drawing(text)
    assert drawing.mesh.bounds[2] >= 11.0 and not drawing.notes
    drawing = svg_drawing(text, specks=1e-3)
    assert drawing.mesh.bounds[2] < 10.1 and len(drawing.mesh.loops) == len(drawing.notes) == 1
    assert drawing.mesh.area == pytest.approx(100.0, abs=2e-3)


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


def test_without_shapely_loops_have_cages_and_drawings_name_it(monkeypatch: pytest.MonkeyPatch) -> None:
    script = """
import sys
sys.modules["shapely"] = None
import nestedcages_core as core
loop = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 4.5), (0.0, 4.0)]
assert core.nested_cages([loop], 4)[0].excess > 0.0
drawing = '<svg xmlns="http://www.w3.org/2000/svg"><rect width="10" height="10"/></svg>'
touching = {"type": "Polygon", "coordinates": [[(0, 0), (6, 0), (6, 6), (0, 6)], [(0, 2), (2, 1), (2, 3)]]}
for read in (lambda: core.from_svg(drawing), lambda: core.Mesh.of(touching)):
    try:
        read()
    except core.NestedCagesError as error:
        assert (error.code, error.data["library"]) == ("dependency.missing", "shapely")
        print("named")
"""
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, text=True).stdout == "named\nnamed\n"


# Everything that is given lies in the solid, in fractions


def on_or_in(point: tuple[Fraction, Fraction], loops: list[list[tuple[Fraction, Fraction]]]) -> bool:
    x, y = point
    total = 0
    for loop in loops:
        corners = [(a - x, b - y) for a, b in loop]
        for (ax, ay), (bx, by) in zip(corners, [*corners[1:], corners[0]], strict=True):
            turn = ax * by - ay * bx
            if turn == 0 and ax * bx + ay * by <= 0:
                return True
            if (ay <= 0) != (by <= 0) and (by > 0) == (turn > 0):
                total += 1 if turn > 0 else -1
    return total != 0


def leaves(mesh: Mesh, rings: list[np.ndarray]) -> bool:
    """Whether an edge of rings leaves a solid: in the middle between two places where it meets the boundary."""
    loops = [[(Fraction(x), Fraction(y)) for x, y in loop.tolist()] for loop in mesh.rings]
    edges = [edge for loop in loops for edge in zip(loop, [*loop[1:], loop[0]], strict=True)]
    for each in rings:
        points = [(Fraction(x), Fraction(y)) for x, y in each.tolist()]
        for a, b in zip(points, [*points[1:], points[0]], strict=True):
            along = (b[0] - a[0], b[1] - a[1])
            length, cuts = along[0] ** 2 + along[1] ** 2, {Fraction(0), Fraction(1)}
            for p, q in edges if length else ():
                e, w = (q[0] - p[0], q[1] - p[1]), (p[0] - a[0], p[1] - a[1])
                across = along[0] * e[1] - along[1] * e[0]
                if across:
                    cuts.add((w[0] * e[1] - w[1] * e[0]) / across)
                elif w[0] * along[1] == w[1] * along[0]:
                    cuts |= {((c[0] - a[0]) * along[0] + (c[1] - a[1]) * along[1]) / length for c in (p, q)}
            at = sorted(cut for cut in cuts if 0 <= cut <= 1)
            for one, other in pairwise(at):
                middle = (one + other) / 2
                if not on_or_in((a[0] + middle * along[0], a[1] + middle * along[1]), loops):
                    return True
    return False


def touching_piers(rng: np.random.Generator) -> list[list[np.ndarray]]:
    width, tip = 10.0 ** rng.uniform(-8, -3), rng.uniform(1.5, 4.0)
    block = [(0, 0), (1, 0), (1, 0.5), (tip, 0.5 + width / 2), (1, 0.5 + width), (1, 1), (0, 1)]
    return [[np.array(block)], [np.array([(-1, -1), (0, -1), (0, 0), (-1, 0)])]]


def combs(rng: np.random.Generator) -> list[list[np.ndarray]]:
    points = [(0.0, -1.0), (4.0, -1.0)]
    for x in (3, 2, 1, 0):
        points += [(x + 0.9, 0.0), (x + 0.5, rng.uniform(0.5, 2.0)), (x + 0.5 - 10.0 ** rng.uniform(-9, -1), 0.0)]
    return [[np.array(points)], [np.array([(4, -1), (5, -1), (5, -2), (4, -2)])]]


def needles(rng: np.random.Generator) -> list[list[np.ndarray]]:
    found = []
    for _ in range(4):
        at, along = rng.uniform(0, 1, 2), rng.normal(size=2)
        across = 10.0 ** rng.uniform(-12, -2) * along[::-1] * (-1, 1)
        found.append([np.array([at, at + along, at + along / 2 + across])])
    return found


def duplicates(rng: np.random.Generator) -> list[list[np.ndarray]]:
    loop = ring(int(rng.integers(3, 12))) + rng.normal(size=2)
    return [[loop], [loop[::-1]], [np.roll(loop, 2, axis=0)], [0.5 * loop + (3.0, 0.0)]]


def self_touching(rng: np.random.Generator) -> list[list[np.ndarray]]:
    near = [(5, 0), (9, 0), (9, 4), (7, 10.0 ** rng.uniform(-17, -8)), (5, 4)]
    return [[np.array([(0, 0), (4, 0), (4, 4), (2 + rng.normal() / 3, 0), (0, 4)])], [np.array(near)]]


def bow_ties(rng: np.random.Generator) -> list[list[np.ndarray]]:
    return [[rng.uniform(0, 1, (int(rng.integers(4, 8)), 2))] for _ in range(2)]


def nested_holes(rng: np.random.Generator) -> list[list[np.ndarray]]:
    one, two, three, four = (ring(int(rng.integers(5, 12)), 5 - k) * rng.uniform(0.9, 1.1) for k in range(4))
    return [[one, two, three], [two * rng.choice([1.0, 1.01]), four]]


def partly_shared_edges(rng: np.random.Generator) -> list[list[np.ndarray]]:
    a, b, c = rng.uniform(0, 1, (3, 2))
    return [[np.array([a, b, c])], [np.array([0.8 * a + 0.2 * b, 0.3 * a + 0.7 * b, a + b - c])]]


FAMILIES = [touching_piers, combs, needles, duplicates, self_touching, bow_ties, nested_holes, partly_shared_edges]


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("seed", slow_after(2, list(range(12)), thorough_after=6))
def test_nothing_that_is_given_lies_outside_and_little_is_added(family: Any, seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = rng.normal(size=(2, 2)) if seed % 2 else np.eye(2)
    polygons = [[np.asarray(each, float) @ turn for each in rings] for rings in family(rng)]
    rings = [each for polygon in polygons for each in polygon]
    closed = [[np.vstack([each, each[:1]]).tolist() for each in polygon] for polygon in polygons]
    lines = [shapely.LineString(each) for polygon in closed for each in polygon]
    parts = [shapely.make_valid(shapely.Polygon(each[0], each[1:]), method="structure") for each in closed]
    whole = shapely.union_all([*parts, *lines])
    for inside in (False, True):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            mesh = core.from_geojson({"type": "MultiPolygon", "coordinates": closed}, inside=inside)
        if inside:
            assert shapely.union_all(parts).buffer(1e-12 * mesh.diagonal).covers(solid(mesh))
            assert shapely.union_all(parts).area - mesh.area < 1e-4 * mesh.diagonal**2
            continue
        assert not leaves(mesh, rings)
        assert whole.buffer(3e-5 * mesh.diagonal).covers(solid(mesh))
        assert mesh.area - shapely.union_all(parts).area < 1e-4 * mesh.diagonal**2
