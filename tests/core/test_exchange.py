"""SVG, GeoJSON and collision outlines against shapely, Bernstein polynomials and each other."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BPoly

from nestedcages_core import Mesh, NestedCagesError, convex_pieces, nested_cages, verify
from nestedcages_core.exchange import (
    Feature,
    Painted,
    clipped,
    features_from_geojson,
    from_engine_json,
    from_svg,
    is_engine_json,
    read_geojson,
    read_svg,
    solid,
    svg_drawing,
    to_engine_json,
    to_geojson,
    to_svg,
    write_engine_json,
    write_geojson,
    write_svg,
)
from nestedcages_core.exchange.fill import _without_remnants
from nestedcages_core.exchange.limits import Limits, Quota
from nestedcages_core.exchange.svg.path_data import PathReader, Subpath, flattened
from support.engine_json import pieces_of
from support.marks import slow_after
from support.shapes import annulus, islands, letter_a, polygon, ring, star

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4]]


def outline_text(**changed: object) -> str:
    """A collision outline, some members of it changed."""
    sound = {"format": "nested-cages outline", "version": 1, "polygons": [{"outer": SQUARE, "holes": []}]}
    return json.dumps({**sound, **changed})


def svg(body: str, attributes: str = "") -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg" {attributes}>{body}</svg>'


def area_of(body: str, **options: float) -> float:
    return from_svg(svg(body), **options).area


def same(one: Mesh, other: Mesh) -> bool:
    """Whether both have the same loops, as closed sequences of the very same points."""

    def canonical(mesh: Mesh) -> list[tuple]:
        loops = []
        for loop in mesh.loops:
            rows = [tuple(row) for row in mesh.vertices[loop].tolist()]
            first = rows.index(min(rows))
            loops.append(tuple(rows[first:] + rows[:first]))
        return sorted(loops)

    return canonical(one) == canonical(other)


# Path data


def read_path(data: str) -> list[Subpath]:
    return PathReader(data, Quota(Limits())).read()


def on_path(data: str, count: int = 40) -> np.ndarray:
    """Points along a path by Bernstein polynomials."""
    parts = []
    for path in read_path(data):
        ends = np.cumsum(path.degrees)
        for begin, end in zip(ends - path.degrees, ends, strict=True):
            parts.append(BPoly(path.points[begin : end + 1, None, :], [0.0, 1.0])(np.linspace(0.0, 1.0, count)))
    return np.concatenate(parts)


@pytest.mark.parametrize(
    ("absolute", "relative"),
    [
        ("M1 2 L4 2 L4 6 Z", "m1 2 l3 0 l0 4 z"),
        ("M1 2 H4 V6 Z", "m1,2 h3v4z"),
        ("M1 2 4 2 4 6Z", "m1 2 3 0 0 4z"),
        ("M0 0 C1 2 3 4 5 0 S9 -4 10 0 Z", "m0 0c1 2 3 4 5 0s4-4 5 0z"),
        ("M0 0 Q2 4 5 0 T10 0 T15 0 Z", "m0 0q2 4 5 0t5 0t5 0z"),
        ("M0 0 A5 3 20 0 1 6 1 A5 3 20 1 0 0 0", "m0 0a5 3 20 01 6 1a5 3 20 10-6-1"),
        ("M1.5 .5 L-.5 1e1 L2 -3 Z", "M1.5.5-.5 10 2-3z"),
        ("M1 1 L3 1 L3 3 Z M5 5 L7 5 L7 7 Z", "m1 1l2 0l0 2zm4 4l2 0l0 2z"),
        ("M1 1 L3 1 L3 3 Z L1 5 L5 5 Z", "M1 1 L3 1 L3 3 Z l0 4 l4 0 z"),
    ],
)
def test_relative_commands_are_the_absolute_ones(absolute: str, relative: str) -> None:
    assert on_path(relative) == pytest.approx(on_path(absolute), abs=1e-12)
    assert [path.closed for path in read_path(relative)] == [path.closed for path in read_path(absolute)]


def test_smooth_commands_mirror_the_last_control_point() -> None:
    assert on_path("M0 0 C1 2 3 4 5 0 S9 -4 10 0") == pytest.approx(on_path("M0 0 C1 2 3 4 5 0 C7 -4 9 -4 10 0"))
    assert on_path("M0 0 L5 0 S9 -4 10 0") == pytest.approx(on_path("M0 0 L5 0 C5 0 9 -4 10 0"))
    assert on_path("M0 0 Q2 4 5 0 T10 0 T15 0") == pytest.approx(on_path("M0 0 Q2 4 5 0 Q8 -4 10 0 Q12 4 15 0"))
    assert on_path("M0 0 L5 0 T10 0") == pytest.approx(on_path("M0 0 L5 0 Q5 0 10 0"))
    assert on_path("M0 0 C1 2 3 4 5 0 T10 0") == pytest.approx(on_path("M0 0 C1 2 3 4 5 0 Q5 0 10 0"))


@pytest.mark.parametrize("large", [0, 1])
@pytest.mark.parametrize("sweep", [0, 1])
def test_arcs_lie_on_their_ellipse_and_turn_the_right_way(large: int, sweep: int) -> None:
    start, end, radii, turn = np.array([1.0, 2.0]), np.array([4.0, 3.0]), np.array([5.0, 2.5]), math.radians(30)
    points = on_path(f"M1 2 A5 2.5 30 {large} {sweep} 4 3")
    assert points[0] == pytest.approx(start)
    assert points[-1] == pytest.approx(end)
    axes = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    circle = points @ axes / radii
    # the centre of the unit circle through all of them, by least squares
    system = np.column_stack((2.0 * circle, np.ones(len(circle))))
    (cx, cy, rest), *_ = np.linalg.lstsq(system, (circle**2).sum(axis=1), rcond=None)
    assert math.sqrt(rest + cx * cx + cy * cy) == pytest.approx(1.0, abs=1e-6)
    angles = np.unwrap(np.arctan2(circle[:, 1] - cy, circle[:, 0] - cx))
    assert (abs(angles[-1] - angles[0]) > math.pi) == bool(large)
    assert (angles[-1] > angles[0]) == bool(sweep)


def test_arcs_out_of_range_are_mended_as_the_standard_says() -> None:
    half_circle = on_path("M0 0 A1 1 0 0 1 10 0")  # radii too small: widened
    assert np.hypot(half_circle[:, 0] - 5.0, half_circle[:, 1]) == pytest.approx(np.full(len(half_circle), 5.0))
    assert on_path("M0 0 A0 5 0 0 1 10 0", 2) == pytest.approx(np.array([[0, 0], [10, 0]]))
    assert read_path("M3 3 A1 1 0 0 1 3 3") == []


@pytest.mark.parametrize("tolerance", [1.0, 0.1, 1e-3])
@pytest.mark.parametrize("data", ["M0 0C30 90 60 -80 100 5", "M0 0Q40 90 100 0", "M0 0A40 90 10 1 1 30 0", "M0 0L5 5"])
def test_chords_stay_within_the_tolerance(data: str, tolerance: float) -> None:
    (path,) = read_path(data)
    chords = shapely.LineString(flattened(path.points, path.degrees, tolerance))
    dense = on_path(data, 500)
    assert shapely.distance(shapely.points(dense), chords).max() <= tolerance * 1.0001
    assert shapely.distance(shapely.points(np.array(chords.coords)), shapely.LineString(dense)).max() < 0.01
    assert chords.length == pytest.approx(shapely.LineString(dense).length, rel=0.05)


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        ("L1 1 2 2", "begins with M"),
        ("M1 1 L2", "argument 2 of L is missing"),
        ("M1 1 L2 2 X", r"character 9 \(X\)"),
        ("M0 0 A5 5 0 2 1 9 9", "argument 4 of A"),
        ("5 5", "a command is missing"),
        ("M0 0 L1 1 Z 5 5", "a command is missing"),
    ],
)
def test_path_data_that_go_wrong_are_located(data: str, sentence: str) -> None:
    found = svg_drawing(svg(f'{RECT}<path d="{data}"/>'))
    assert found.mesh.area == 2.0
    assert re.search(sentence, found.notes[0])


# Elements


def test_basic_shapes_have_their_areas() -> None:
    assert area_of('<rect x="1" y="2" width="3" height="4"/>') == 12.0
    assert area_of('<circle cx="5" cy="5" r="3"/>', tolerance=1e-5) == pytest.approx(9.0 * math.pi, rel=1e-5)
    assert area_of('<ellipse cx="5" cy="5" rx="3" ry="1"/>', tolerance=1e-5) == pytest.approx(3.0 * math.pi, rel=1e-5)
    rounded = '<rect width="8" height="6" rx="2" ry="1"/>'
    assert area_of(rounded, tolerance=1e-5) == pytest.approx(48.0 - (4.0 - math.pi) * 2.0, rel=1e-5)
    assert area_of('<rect width="8" height="6" rx="50"/>', tolerance=1e-5) == pytest.approx(math.pi * 12.0, rel=1e-4)
    assert area_of('<polygon points="0,0 4,0 4,3"/>') == 6.0
    assert area_of('<polyline points="0,0 4,0 4,3"/>') == 6.0  # filled, it is closed
    assert area_of('<path d="M0 0 L4 0 L4 3"/>') == 6.0
    assert area_of('<rect width="1in" height="25.4mm"/>') == pytest.approx(96.0**2)


@pytest.mark.parametrize(
    ("transform", "matrix"),
    [
        ("translate(3, -2)", [[1, 0, 3], [0, 1, -2]]),
        ("translate(3)", [[1, 0, 3], [0, 1, 0]]),
        ("scale(2 3)", [[2, 0, 0], [0, 3, 0]]),
        ("scale(-2)", [[-2, 0, 0], [0, -2, 0]]),
        ("rotate(90)", [[0, -1, 0], [1, 0, 0]]),
        ("rotate(90 1 1)", [[0, -1, 2], [1, 0, 0]]),
        ("matrix(1 2 3 4 5 6)", [[1, 3, 5], [2, 4, 6]]),
        ("skewX(45)", [[1, 1, 0], [0, 1, 0]]),
        ("skewY(45)", [[1, 0, 0], [1, 1, 0]]),
        ("translate(1,2)scale(2),rotate(90)", [[0, -2, 1], [2, 0, 2]]),
    ],
)
def test_transforms(transform: str, matrix: list[list[float]]) -> None:
    rows = np.array(matrix, dtype=float)
    corners = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]])
    body = f'<g transform="{transform}"><polygon points="0,0 4,0 4,3"/></g>'
    assert from_svg(svg(body)).vertices == pytest.approx(corners @ rows[:, :2].T + rows[:, 2], abs=1e-12)


def test_transforms_of_groups_multiply() -> None:
    body = '<g transform="translate(10 0)"><g transform="scale(2)"><rect x="1" width="1" height="1"/></g></g>'
    assert from_svg(svg(body)).vertices.min(axis=0) == pytest.approx([12.0, 0.0])


def test_what_is_not_painted_is_left_out() -> None:
    hidden = (
        '<defs><rect width="100" height="100"/></defs><rect width="90" height="9" fill="none"/>'
        '<rect width="80" height="8" style="display: none"/><g visibility="hidden"><rect width="70" height="7"/></g>'
        '<clipPath><rect width="60" height="6"/></clipPath><rect width="50" height="5" class="ghost"/>'
        "<style>/* no paint */ .ghost, .other { fill: none; }</style>"
    )
    assert area_of(hidden + '<rect width="2" height="3"/>') == 6.0
    assert area_of('<g fill="none"><rect width="9" height="9"/><rect width="2" height="3" fill="red"/></g>') == 6.0


def test_per_cent_are_of_the_view_box_or_the_size() -> None:
    rect = '<rect x="25%" y="10%" width="50%" height="20%"/>'
    for attributes in ('viewBox="5 0 40 30"', 'width="40" height="30px"', 'viewBox="0 0 40 30" width="100%"'):
        low, high = (edge(from_svg(svg(rect, attributes)).vertices, axis=0) for edge in (np.min, np.max))
        assert [*low, *high] == pytest.approx([10.0, 3.0, 30.0, 9.0])
    circle = from_svg(svg('<circle cx="50%" cy="50%" r="10%"/>', 'viewBox="0 0 30 40"'))
    assert np.ptp(circle.vertices, axis=0) == pytest.approx(2.0 * 0.1 * math.sqrt((30**2 + 40**2) / 2.0), rel=1e-3)


def test_outlines_count_where_nothing_is_painted() -> None:
    body = '<g fill="none"{}><rect width="9" height="9"/><path d="M0 0 L50 50 L0 50"/></g>'
    assert area_of(body.format("")) == 81.0
    assert area_of(body.format(' stroke="black"'), strokes=False) == 81.0


def test_symbols_and_references_are_followed() -> None:
    body = '<defs><rect id="r" width="2" height="2"/></defs><use href="#r" x="5"/>'
    assert from_svg(svg(body)).vertices.tolist() == [[5, 0], [7, 0], [7, 2], [5, 2]]
    symbol = (
        '<symbol id="s" viewBox="0 0 10 10"><rect width="10" height="10"/></symbol>'
        '<use href="#s" x="3" y="4" width="20" height="40"/>'
    )
    assert from_svg(svg(symbol)).vertices.min(axis=0).tolist() == [3, 14]
    assert from_svg(svg(symbol)).area == 400.0
    linked = '<defs><rect id="r" width="2" height="2"/></defs><use xlink:href="#r"/>'
    assert from_svg(svg(linked, 'xmlns:xlink="http://www.w3.org/1999/xlink"')).area == 4.0
    nested = '<svg x="10" y="0" width="5" height="5" viewBox="0 0 1 1"><rect width="1" height="1"/></svg>'
    assert from_svg(svg(nested)).vertices.max(axis=0).tolist() == [15, 5]


def test_one_element_can_be_read_alone() -> None:
    body = '<g id="two" transform="scale(2)"><rect width="1" height="1"/></g>'
    body += '<rect id="one" x="9" width="3" height="1"/>'
    assert from_svg(svg(body), element="two").area == 4.0
    assert from_svg(svg(body), element="one").area == 3.0
    with pytest.raises(NestedCagesError, match="no element with the id 'three'; its ids: one, two"):
        from_svg(svg(body), element="three")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("hello", "not an SVG document"),
        ("<html/>", "its root element is 'html'"),
        (svg(""), "no filled or closed shapes"),
        (svg('<text x="0">A</text>'), "convert strokes and text to paths"),
        ('<svg><rect width="50%" height="1"/></svg>', "width of the rect is '50%'"),
        (svg('<rect width="5furlongs" height="1"/>'), "width of the rect is '5furlongs'"),
        (svg('<path d="M0 0 L1e300 1 L2 1e300 Z"/>'), "too large"),
        (svg('<path d="M0 0 L1 1 L2 2 Z"/>'), "inside"),
        (svg('<path d="M0 0 L1e999 1 L2 5 Z"/>'), "not finite"),
        (svg('<path d="M0 0 L0 0 Z"/>'), "inside|coincide"),
    ],
)
def test_bad_documents_get_a_sentence(text: str, sentence: str) -> None:
    with pytest.raises(NestedCagesError, match=sentence):
        from_svg(text)
    with pytest.raises(NestedCagesError, match="tolerance"):
        from_svg(text, tolerance=0.0)


RECT = '<rect x="-9" width="2" height="1"/>'


@pytest.mark.parametrize(
    ("body", "expected", "sentence"),
    [
        ('<path id="p" d="M0 0H4V3H0zL9"/>', 12.0, r"path 'p' go wrong at character 13 \(its end\): argument 2 of L"),
        ('<polygon points="0 0 4 0 4 3 0 3 no 9 9"/>', 12.0, "points of the polygon without an id go wrong at 'no"),
        ('<rect width="4" height="3" transform="rotate(NaN)"/>', 12.0, "'rotate\\(NaN\\)', which cannot be read"),
        ('<rect width="4" height="3" transform="translate(1 NaN)"/>', 12.0, "cannot be read: it is left out"),
        ('<rect width="4" height="3" transform="scale(1,2,3)"/>', 12.0, "cannot be read"),
        ('<use href="#nothing"/>', 0.0, "Left out: the use of '#nothing', which is not an element"),
        ('<use href="other.svg#a"/>', 0.0, "other.svg#a"),
        ('<g id="a"><use href="#a"/><rect width="4" height="3"/></g>', 12.0, "'#a', which is used by itself"),
        ('<rect width="4" height="3" rx="wide"/>', 12.0, "rx of the rect is 'wide', which is not a length: 0 is used"),
        ('<path d="M0 0H4" stroke="red" stroke-width="fat"/>', 4.0, "stroke-width is 'fat', .*: 1 is used"),
        ('<path d="M0 0H4" stroke="red" stroke-dasharray="1 x"/>', 4.0, "stroke-dasharray is '1 x'"),
        (
            '<rect width="4" height="3"/><rect width="1e200" height="1" y="9"/>',
            12.0,
            "Left out: the rect without an id",
        ),
        ('<rect width="1e-3em" height="3"/>' * 9 + '<rect width="4" height="3"/>', 12.0, ""),
    ],
)
def test_one_bad_attribute_loses_nothing_else(body: str, expected: float, sentence: str) -> None:
    found = svg_drawing(svg(RECT + body))
    assert found.mesh.area == pytest.approx(2.0 + expected)
    assert len(found.notes) == (1 if sentence else 0)
    assert re.search(sentence, " ".join(found.notes))


def test_of_many_bad_attributes_some_are_named() -> None:
    found = svg_drawing(svg(RECT + "".join(f'<use href="#{k}"/>' * 2 for k in range(20))))
    assert "'#0', which is not an element of the drawing (2 times)." in found.notes[0]
    assert found.notes[-1] == "14 more attributes cannot be read."


@pytest.mark.parametrize(
    ("length", "expected"),
    [
        ("2em", 40.0),
        ("1.5rem", 24.0),
        ("2ex", 20.0),
        ("2,5mm", 2.5 * 96.0 / 25.4),
        ("10vw", 20.0),
        ("10vh", 10.0),
        ("10%", 20.0),
        ("calc(1em + 10px)", 30.0),
        ("calc((10% - 4px) * 2 / 4)", 8.0),
        ("calc(-1 * -3px)", 3.0),
        ("calc(2em - 1.5in + calc(110px))", 6.0),
    ],
)
def test_lengths_by_font_and_view(length: str, expected: float) -> None:
    body = f'<g font-size="10px"><g font-size="2em"><rect width="{length}" height="1"/></g></g>'
    assert area_of(f'<svg viewBox="0 0 200 100" width="200" height="100">{body}</svg>') == pytest.approx(expected)


@pytest.mark.parametrize("length", ["calc(1px", "calc()", "calc(1px 2px)", "calc(1/0)", "calc(" + "(" * 150, "calc(a)"])
def test_calculations_that_make_no_sense(length: str) -> None:
    found = svg_drawing(svg(f'{RECT}<rect width="{length}" height="1"/>'))
    assert "which is not a length: 0 is used" in found.notes[0]


# Fill rules and overlaps

OUTER, INNER = "M0 0 H10 V10 H0 Z", "M2 2 H8 V8 H2 Z"
INNER_BACK, DEEP = "M2 2 V8 H8 V2 Z", "M4 4 H6 V6 H4 Z"


@pytest.mark.parametrize(
    ("data", "rule", "area"),
    [
        (f"{OUTER} {INNER}", "evenodd", 64.0),
        (f"{OUTER} {INNER}", "nonzero", 100.0),
        (f"{OUTER} {INNER_BACK}", "nonzero", 64.0),
        (f"{OUTER} {INNER_BACK}", "evenodd", 64.0),
        (f"{OUTER} {INNER} {DEEP}", "evenodd", 68.0),
        (f"{OUTER} {INNER} {DEEP}", "nonzero", 100.0),
        (f"{OUTER} {INNER_BACK} {DEEP}", "nonzero", 68.0),
    ],
)
def test_fill_rules(data: str, rule: str, area: float) -> None:
    assert area_of(f'<path fill-rule="{rule}" d="{data}"/>') == area
    assert area_of(f'<path style="fill-rule:{rule}" d="{data}"/>') == area


def blob(seed: int, count: int = 24) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return ring(count) * rng.uniform(0.4, 1.0, count)[:, None] + rng.uniform(-0.6, 0.6, 2)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(st.lists(st.integers(0, 10_000), min_size=1, max_size=6, unique=True))
def test_overlapping_shapes_are_united(seeds: list[int]) -> None:
    blobs = [blob(seed) for seed in seeds]
    expected = shapely.unary_union([shapely.Polygon(points) for points in blobs])
    found = polygon(solid([Painted([points]) for points in blobs]))
    assert found.symmetric_difference(expected).area < 1e-9
    assert len(shapely.get_parts(found)) == len(shapely.get_parts(expected))


@pytest.mark.slow
@settings(max_examples=50, deadline=None)
@given(st.lists(st.integers(0, 10_000), min_size=3, max_size=5, unique=True), st.booleans())
def test_areas_are_clipped_by_others(seeds: list[int], inside: bool) -> None:
    first, *others = [Painted([blob(seed)]) for seed in seeds]
    own, clip = polygon(solid([first])), polygon(solid(others))
    expected = own & clip if inside else own - clip
    found = clipped([first], others, inside=inside)
    assert sum(polygon(solid([area])).area for area in found) == pytest.approx(expected.area, abs=1e-4)
    assert bool(found) == (expected.area > 0.0)


def test_what_touches_in_a_point_becomes_one() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    chess = [square + np.array([x, y]) for x in range(4) for y in range(4) if (x + y) % 2]
    found = solid([Painted([loop]) for loop in chess])
    assert len(found.loops) == 1 + 2  # the two inner squares left blank are holes
    area = polygon(found)
    assert area.is_valid
    assert all(area.covers(shapely.Polygon(loop)) for loop in chess)
    assert area.area == pytest.approx(8.0, abs=1e-4)


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
    "spike": "M0 0H10V5H12v{0}H10V10H0z",
    "sharp spike": "M0 0H10V5H12L10 {1}V10H0z",
    "crumb as a spike": "M0 0H10V10H0zM11 5h{0}v{0}z",
}


@pytest.mark.parametrize("name", HAIRLINES)
@pytest.mark.parametrize("width", slow_after(1, [1e-15, 1e-8, 5e-4]))
def test_hairlines_go_with_a_note(name: str, width: float) -> None:
    drawing = svg_drawing(svg(f'<path fill-rule="evenodd" d="{HAIRLINES[name].format(width, 5.0 + width)}"/>'))
    assert len(drawing.mesh.loops) == 1
    assert drawing.mesh.area == pytest.approx(100.0, abs=2e-3)
    if width > 1e-11:  # less is rounding, of which nothing needs to be said
        what = "1 spike cut off" if "spike" in name else "1 gap closed"
        assert re.fullmatch(rf"Narrower than 0.000\d+: {what}\.", " ".join(drawing.notes))
    assert nested_cages(drawing.mesh, [4]).levels[0].report.excess < 1e-3


def test_slivers_that_closed_gaps_leave_go() -> None:
    square, sliver = np.array([(0, 0), (9, 0), (9, 9), (0, 9)], float), np.array([(2, 2), (3, 2), (2, 2.0 + 1e-14)])
    assert len(_without_remnants([square, sliver[::-1]], 1e-3).loops) == 1


def test_narrow_parts_and_necks_stay() -> None:
    """So do sharp corners, and everything else to the last bit."""
    for points in (
        [[(0, 0), (8, 0), (8, 10), (0, 10)], [(9, 0), (9.5, 0), (9.5, 4e-3), (9, 4e-3)]],
        [[(0, 0), (4, 0), (4, 5), (6, 5), (6, 0), (10, 0), (10, 9), (6, 9), (6, 5.0001), (4, 5.0001), (4, 9), (0, 9)]],
        [[(0, 0), (10, 0), (0, 1)]],
    ):
        loops = "".join(f"M{' '.join(f'{x} {y}' for x, y in loop)}z" for loop in points)
        drawing = svg_drawing(svg(f'<path d="{loops}"/>'))
        assert sorted(map(tuple, drawing.mesh.vertices)) == sorted(point for loop in points for point in loop)
        assert not drawing.notes


@pytest.mark.parametrize("ulps", [-3, -1, 1, 3])
def test_parts_that_sums_of_decimals_put_an_ulp_apart_touch(ulps: int) -> None:
    """Or overlap by as much: as one vertex, with a neck, and there is room for a cage."""
    corner = 8.0 + ulps * np.spacing(8.0)
    square, ear = [(0, 0), (8, 0), (8, 8), (0, 8)], [(corner, corner), (9, 8.5), (8.5, 9)]
    mesh = solid([Painted([np.array(square, float)]), Painted([np.array(ear)])])
    assert len(mesh.loops) == 1
    assert mesh.area == pytest.approx(64.375, abs=2e-4)  # with the neck
    assert min(np.abs(mesh.vertices - place).sum(axis=1).min() for place in square[:2] + ear[1:]) < 1e-9
    assert nested_cages(mesh, [7]).levels[0].report.strict
    apart = solid([Painted([np.array(square, float)]), Painted([np.array(ear) + 1e-9])])
    assert len(apart.loops) == 2


def test_edges_in_common_vanish() -> None:
    squares = [ring(4, math.sqrt(0.5), math.pi / 4).round(12) + np.array([x, y]) for x in range(3) for y in range(3)]
    whole = solid([Painted([square]) for square in squares])
    assert whole.area == pytest.approx(9.0)
    assert len(whole.loops) == 1
    frame = solid([Painted([square]) for k, square in enumerate(squares) if k != 4])
    assert frame.area == pytest.approx(8.0)
    assert frame.loop_signs.tolist().count(-1) == 1
    twice = solid([Painted([squares[0]]), Painted([squares[0][::-1]])])
    assert twice.area == pytest.approx(1.0)


def test_half_overlapping_edges_are_cut() -> None:
    left = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    assert solid([Painted([left]), Painted([left + np.array([2.0, 1.0])])]).area == pytest.approx(8.0)
    assert solid([Painted([left]), Painted([0.5 * left + np.array([2.0, 0.5])])]).area == pytest.approx(5.0)


# There and back

SHAPES = {"letter": letter_a(1), "islands": islands(), "star": star(5, 40)}


@pytest.mark.parametrize("name", SHAPES)
def test_what_is_written_is_read_back_to_the_last_bit(name: str, tmp_path: Path) -> None:
    mesh = SHAPES[name]
    mesh = Mesh(mesh.vertices * math.pi, mesh.edges)
    write_svg(tmp_path / "a.svg", mesh)
    write_geojson(tmp_path / "a.geojson", mesh)
    write_engine_json(tmp_path / "a.json", mesh)
    assert same(read_svg(tmp_path / "a.svg"), mesh)
    assert same(read_geojson(tmp_path / "a.geojson"), mesh)
    assert same(from_engine_json((tmp_path / "a.json").read_text()), mesh)


def test_cages_hold_after_writing_and_reading() -> None:
    fine = letter_a(2)
    hierarchy = nested_cages(fine, [60, 30])
    meshes = {"drawing": fine, "inner": hierarchy.cages[0], "outer": hierarchy.cages[1]}
    text = to_svg(meshes)
    read = {name: from_svg(text, element=name) for name in meshes}
    assert all(same(read[name], mesh) for name, mesh in meshes.items())
    assert verify(read["inner"], read["drawing"])
    assert verify(read["outer"], read["inner"])
    assert same(from_svg(text), hierarchy.cages[1])  # all painted together
    features = features_from_geojson(to_geojson([Feature(mesh, {"name": name}) for name, mesh in meshes.items()]))
    assert all(same(item.mesh, meshes[item.properties["name"]]) for item in features)


def test_geojson_agrees_with_shapely() -> None:
    mesh = islands()
    document = json.loads(to_geojson(Feature(mesh, {"excess": 0.1}, id="a")))
    assert document["type"] == "FeatureCollection"
    (feature,) = document["features"]
    assert (feature["id"], feature["properties"]) == ("a", {"excess": 0.1})
    shape = shapely.geometry.shape(feature["geometry"])
    assert shape.is_valid
    assert shape.equals(polygon(mesh))
    for part in shape.geoms:  # RFC 7946: outer rings counter-clockwise, holes clockwise
        assert part.exterior.is_ccw
        assert not any(hole.is_ccw for hole in part.interiors)


def test_collision_outlines_turn_as_engines_expect() -> None:
    mesh = annulus(6)
    for flip in (None, 100.0):
        document = json.loads(to_engine_json(mesh, flip_y=flip, triangles=True))
        (part,) = document["polygons"]
        assert shapely.LinearRing(part["outer"]).is_ccw
        assert not shapely.LinearRing(part["holes"][0]).is_ccw
        points = np.array(document["points"])
        corners = points[document["triangles"]]
        assert all(shapely.LinearRing(each).is_ccw for each in corners)
        union = shapely.unary_union([shapely.Polygon(each) for each in corners])
        assert union.symmetric_difference(shapely.Polygon(part["outer"], part["holes"])).area < 1e-12
        again = from_engine_json(json.dumps(document), flip_y=flip)
        assert polygon(again).symmetric_difference(polygon(mesh)).area < 1e-12
    flipped = np.array(json.loads(to_engine_json(mesh, flip_y=8.0))["polygons"][0]["outer"])
    assert sorted(flipped[:, 1].tolist()) == pytest.approx(sorted((8.0 - mesh.vertices[mesh.loops[0], 1]).tolist()))


@pytest.mark.parametrize("flip", [None, 100.0])
def test_convex_pieces_are_written(flip: float | None, tmp_path: Path) -> None:
    mesh = islands()
    write_engine_json(tmp_path / "out.json", mesh, flip_y=flip, triangles=True, pieces=5)
    text = (tmp_path / "out.json").read_text()
    document = json.loads(text)
    written = [np.array(document["points"])[piece] for piece in document["pieces"]]
    assert all(shapely.LinearRing(each).is_ccw for each in written)
    assert polygon(from_engine_json(text, flip_y=flip)).equals(polygon(mesh)) == (flip is None)
    pieces = pieces_of(text, flip_y=flip)
    wanted = convex_pieces(mesh, 5)
    assert len(pieces) == len(wanted) < len(document["triangles"])
    for found, piece in zip(pieces, wanted, strict=True):
        assert 3 <= len(found) <= 5
        assert shapely.LinearRing(found).is_ccw
        assert np.array_equal(found, piece) if flip is None else np.allclose(found, piece, atol=1e-12)


def test_outlines_are_told_from_other_json() -> None:
    text = to_engine_json(annulus(6))
    assert is_engine_json(text)
    assert is_engine_json(text.encode())
    others = ("", "[1]", to_geojson(annulus(6)), '{"name": "nested-cages outline"}', text[:-1])
    assert not any(map(is_engine_json, others))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "not a collision outline"),
        ("{}", "its format is not"),
        ("[" * 100_000, "not a collision outline"),
        ('{"polygons": [{"outer": [1, 2], "holes": []}]}', "its format is not"),
        (outline_text(polygons=3), "has 3 where its list"),
        (outline_text(version=999), "of version 999"),
        (outline_text(version=True), "of version True"),
        (outline_text(version="1"), "of version '1'"),
        (outline_text(format="spine"), "its format is not"),
        (outline_text(polygons=[5]), "Polygon 0 .* outer and holes"),
        (outline_text(polygons=[{"outer": []}, {"holes": []}]), "Polygon 1 .* outer and holes"),
        (outline_text(polygons=[{"outer": [1, 2], "holes": []}]), "Point 0 of ring 0 of polygon 0 is 1, not two"),
        (outline_text(polygons=[{"outer": [[0, 0], ["1", 0], [1, 1]]}]), r"Point 1 of .* is \['1', 0\]"),
        (outline_text(polygons=[{"outer": SQUARE, "holes": [[[5, 5], [6, 5], [6, 6]]]}]), "not directly inside it"),
        (outline_text(polygons=[{"outer": SQUARE, "holes": [SQUARE]}]), "both lie at"),
        (outline_text(polygons=[]), "is empty"),
    ],
)
def test_bad_outlines_get_a_sentence(text: str, sentence: str) -> None:
    with pytest.raises(NestedCagesError, match=sentence):
        from_engine_json(text)


@pytest.mark.parametrize("given", [None, 5, ["a"], {"format": "nested-cages outline"}, Path("a.json")])
def test_outlines_are_read_from_text_alone(given: object) -> None:
    with pytest.raises(NestedCagesError, match="read from text or bytes, not from"):
        from_engine_json(given)


def test_the_drawing_of_the_demo_is_read() -> None:
    mesh = read_svg(EXAMPLES / "letter_a.svg")
    assert len(mesh.loops) >= 2
    assert verify(nested_cages(mesh, [48]).cages[0], mesh)
