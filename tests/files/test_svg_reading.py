"""SVG documents: path data, elements, transforms, lengths, layers and pages, and what is wrong in them."""

import math
from typing import Any

import numpy as np
import pytest
import shapely

from nestedcages_core import InvalidMeshError, from_svg, puppet_parts, svg_drawing
from support.documents import area_of, refusal, solid, svg

SQUARE = '<rect width="10" height="10"/>'
RECT = '<rect x="-9" width="2" height="1"/>'


# Path data


def painted(data: str, tolerance: float = 1e-3) -> shapely.Geometry:
    """What a path fills."""
    return solid(from_svg(svg(f'<path d="{data}"/>'), tolerance=tolerance))


@pytest.mark.parametrize(
    ("absolute", "relative"),
    [("M1 2 L4 2 L4 6 Z", "m1 2 l3 0 l0 4 z"), ("M1 2 H4 V6 Z", "m1,2 h3v4z"), ("M1 2 4 2 4 6Z", "m1 2 3 0 0 4z"),
     ("M0 0 C1 2 3 4 5 0 S9 -4 10 0 Z", "m0 0c1 2 3 4 5 0s4-4 5 0z"),
     ("M0 0 Q2 4 5 0 T10 0 T15 0 Z", "m0 0q2 4 5 0t5 0t5 0z"), ("M0 0Q2 4 5 0T10 0", "M0 0Q2 4 5 0Q8-4 10 0"),
     ("M0 0C1 2 3 4 5 0S9-4 10 0", "M0 0C1 2 3 4 5 0C7-4 9-4 10 0"),
     ("M0 0 A5 3 20 0 1 6 1 A5 3 20 1 0 0 0", "m0 0a5 3 20 01 6 1a5 3 20 10-6-1"),
     ("M1.5 .5 L-.5 1e1 L2 -3 Z", "M1.5.5-.5 10 2-3z"),
     ("M1 1 L3 1 L3 3 Z M5 5 L7 5 L7 7 Z", "m1 1l2 0l0 2zm4 4l2 0l0 2z"),
     ("M1 1 L3 1 L3 3 Z L1 5 L5 5 Z", "M1 1 L3 1 L3 3 Z l0 4 l4 0 z")],
)  # fmt: skip
def test_relative_commands_are_the_absolute_ones(absolute: str, relative: str) -> None:
    assert painted(absolute).area > 0.9
    assert (painted(relative) ^ painted(absolute)).area < 1e-9


def test_arcs_out_of_range_are_mended_as_the_standard_says() -> None:
    half = painted("M0 0 A1 1 0 0 1 10 0 Z")  # radii too small: widened
    assert (half ^ (shapely.Point(5, 0).buffer(5.0, 1000) & shapely.box(0, -5, 10, 0))).area < 0.05
    assert painted("M0 0 A0 5 0 0 1 10 0 V3 Z").area == 15.0  # no radius: a line
    assert painted("M3 3 A1 1 0 0 1 3 3 H9 V9 Z").area == 18.0  # no way to go: nothing


def test_chords_follow_a_fraction_of_the_drawing_without_a_tolerance() -> None:
    for scale in (1e-6, 1.0, 1e6):
        circle = solid(from_svg(svg(f'<circle r="{scale}"/>')))
        assert circle.hausdorff_distance(shapely.Point(0, 0).buffer(scale, 500)) < 2e-3 * scale
        assert len(circle.exterior.coords) < 100


# Elements


INKSCAPE = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
ALONE = '<g id="two" transform="scale(2)"><rect width="1" height="1"/></g><rect id="one" x="9" width="3" height="1"/>'
LAYERS = f'<g inkscape:label="Ink">{SQUARE}</g><g id="two"><rect id="r" x="20" width="2" height="3"/></g>'
SWITCH = f'<switch><foreignObject/><g requiredExtensions="x">{SQUARE}</g><rect width="2" height="1"/>{SQUARE}</switch>'


@pytest.mark.parametrize(
    ("body", "area", "options"),
    [('<rect x="1" y="2" width="3" height="4"/>', 12.0, {}), ('<polygon points="0,0 4,0 4,3"/>', 6.0, {}),
     ('<polyline points="0,0 4,0 4,3"/>', 6.0, {}), ('<path d="M0 0 L4 0 L4 3"/>', 6.0, {}),  # filled, they are closed
     ('<rect width="1in" height="25.4mm"/>', 96.0**2, {}), ('<circle cx="5" cy="5" r="3"/>', 9.0 * math.pi, {}),
     ('<ellipse cx="5" cy="5" rx="3" ry="1"/>', 3.0 * math.pi, {}),
     ('<rect width="8" height="6" rx="2" ry="1"/>', 48.0 - (4.0 - math.pi) * 2.0, {}),
     ('<rect width="8" height="6" rx="50"/>', math.pi * 12.0, {}),
     (SWITCH, 2.0, {}),  # its first usable child
     (ALONE, 4.0, {"element": "two"}), (ALONE, 3.0, {"element": "one"}), (ALONE, None, {"element": "three"}),
     (LAYERS, 100.0, {"layers": ("Ink",)}), (LAYERS, 106.0, {"layers": ("Ink", "two")}),
     (LAYERS, 6.0, {"layers": ("two",), "element": "r"}), (LAYERS, None, {"layers": ("Pencil",)})],
)  # fmt: skip
def test_elements_have_their_areas(body: str, area: float | None, options: dict[str, Any]) -> None:
    if area is None:
        assert refusal(area_of, body, INKSCAPE, **options).code == "file.invalid"
    else:
        assert area_of(body, INKSCAPE, tolerance=1e-5, **options) == pytest.approx(area, rel=1e-4)


@pytest.mark.parametrize(
    ("transform", "matrix"),
    [("translate(3, -2)", [[1, 0, 3], [0, 1, -2]]), ("translate(3)", [[1, 0, 3], [0, 1, 0]]),
     ("scale(2 3)", [[2, 0, 0], [0, 3, 0]]), ("scale(-2)", [[-2, 0, 0], [0, -2, 0]]),
     ("rotate(90)", [[0, -1, 0], [1, 0, 0]]), ("rotate(90 1 1)", [[0, -1, 2], [1, 0, 0]]),
     ("matrix(1 2 3 4 5 6)", [[1, 3, 5], [2, 4, 6]]), ("skewX(45)", [[1, 1, 0], [0, 1, 0]]),
     ("skewY(45)", [[1, 0, 0], [1, 1, 0]]), ("translate(1,2)scale(2),rotate(90)", [[0, -2, 1], [2, 0, 2]])],
)  # fmt: skip
def test_transforms(transform: str, matrix: list[list[float]]) -> None:
    rows = np.array(matrix, dtype=float)
    corners = 2.0 * (np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]) @ rows[:, :2].T + rows[:, 2])
    body = f'<g transform="scale(2)"><g transform="{transform}"><polygon points="0,0 4,0 4,3"/></g></g>'
    found = from_svg(svg(body))
    assert sorted(found.vertices.round(9).tolist()) == sorted(corners.round(9).tolist())


def test_symbols_and_references_are_followed() -> None:
    body = '<defs><rect id="r" width="2" height="2"/></defs><use href="#r" x="5"/>'
    assert sorted(from_svg(svg(body)).vertices.tolist()) == [[5, 0], [5, 2], [7, 0], [7, 2]]
    symbol = (
        '<symbol id="s" viewBox="0 0 10 10"><rect width="10" height="10"/></symbol>'
        '<use href="#s" x="3" y="4" width="20" height="40"/>'
    )
    assert np.ravel(from_svg(svg(symbol)).bounds).tolist() == [3, 14, 23, 34]
    linked = '<defs><rect id="r" width="2" height="2"/></defs><use xlink:href="#r"/>'
    assert area_of(linked, 'xmlns:xlink="http://www.w3.org/1999/xlink"') == 4.0
    nested = '<svg x="10" y="0" width="5" height="5" viewBox="0 0 1 1"><rect width="1" height="1"/></svg>'
    assert np.ravel(from_svg(svg(nested)).bounds).tolist() == [10, 0, 15, 5]


# Lengths and pages


def test_per_cent_are_of_the_view_box_or_the_size() -> None:
    rect = '<rect x="25%" y="10%" width="50%" height="20%"/>'
    for attributes in ('viewBox="5 0 40 30"', 'width="40" height="30px"', 'viewBox="0 0 40 30" width="100%"'):
        assert np.ravel(from_svg(svg(rect, attributes)).bounds) == pytest.approx([10.0, 3.0, 30.0, 9.0])
    circle = from_svg(svg('<circle cx="50%" cy="50%" r="10%"/>', 'viewBox="0 0 30 40"'))
    assert np.ptp(circle.vertices, axis=0) == pytest.approx(2.0 * 0.1 * math.sqrt((30**2 + 40**2) / 2.0), rel=2e-3)


@pytest.mark.parametrize(
    ("length", "expected"),
    [("2em", 40.0), ("1.5rem", 24.0), ("2ex", 20.0), ("2,5mm", 2.5 * 96.0 / 25.4), ("10vw", 20.0), ("10vh", 10.0),
     ("10%", 20.0), ("calc(1em + 10px)", 30.0), ("calc((10% - 4px) * 2 / 4)", 8.0), ("calc(-1 * -3px)", 3.0),
     ("calc(2em - 1.5in + calc(110px))", 6.0)],
)  # fmt: skip
def test_lengths_by_font_and_view(length: str, expected: float) -> None:
    body = f'<g font-size="10px"><g font-size="2em"><rect width="{length}" height="1"/></g></g>'
    assert area_of(body, 'viewBox="0 0 200 100" width="200" height="100"') == pytest.approx(expected)


def test_a_background_is_named_and_can_be_left_out() -> None:
    page = svg('<rect id="paper" width="100%" height="100%"/><circle cx="5" cy="5" r="2"/>', 'viewBox="0 0 20 10"')
    for background, area in ((True, 200.0), (False, 4.0 * math.pi)):
        found = svg_drawing(page, background=background)
        assert found.mesh.area == pytest.approx(area, rel=1e-2)
        assert len(found.notes) == 1 and "paper" in found.notes[0]


def test_what_lies_outside_the_page_is_cut_off() -> None:
    page = svg('<rect x="-5" y="2" width="10" height="4"/>', 'viewBox="0 0 20 10"')
    found = svg_drawing(page)
    assert np.ravel(found.mesh.bounds) == pytest.approx([0.0, 2.0, 5.0, 6.0])
    assert len(found.notes) == 1
    assert from_svg(page, crop=False).area == 40.0


@pytest.mark.parametrize(
    ("page", "box"),
    [
        ('width="20" height="10"', (-5, 0, 15, 10)),  # 5 units on either side of the view box are seen
        ('width="10mm" height="20mm"', (0, -5, 10, 15)),
        ('width="20" height="10" preserveAspectRatio="xMaxYMid slice"', (0, 2.5, 10, 7.5)),
        ('width="20" height="10" preserveAspectRatio="none"', (0, 0, 10, 10)),
        ('width="20"', (0, 0, 10, 10)),
        ('width="100%" height="50"', (0, 0, 10, 10)),
    ],
)
def test_what_is_seen_next_to_the_view_box_stays(page: str, box: tuple[float, ...]) -> None:
    drawn = svg('<rect x="-30" y="-30" width="70" height="70"/><path d="M0 0h1"/>', f'viewBox="0 0 10 10" {page}')
    assert np.ravel(from_svg(drawn).bounds) == pytest.approx(np.array(box, float))


# Faults


@pytest.mark.parametrize(
    ("body", "expected", "named"),
    [
        ('<polygon points="0 0 4 0 4 3 0 3 no 9 9"/>', 12.0, "no"),
        ('<rect width="4" height="3" transform="rotate(NaN)"/>', 12.0, "rotate(NaN)"),
        ('<rect width="4" height="3" transform="translate(1 NaN)"/>', 12.0, ""),
        ('<rect width="4" height="3" transform="scale(1,2,3)"/>', 12.0, ""),
        ('<use href="#nothing"/>', 0.0, "#nothing"),
        ('<use href="other.svg#a"/>', 0.0, "other.svg#a"),
        ('<g id="a"><use href="#a"/><rect width="4" height="3"/></g>', 12.0, "#a"),
        ('<rect width="4" height="3" rx="wide"/>', 12.0, "wide"),
        ('<path d="M0 0H4" stroke="red" stroke-width="fat"/>', 4.0, "fat"),
        ('<path d="M0 0H4" stroke="red" stroke-dasharray="1 x"/>', 4.0, "1 x"),
        ('<rect width="4" height="3"/><rect width="1e200" height="1" y="9"/>', 12.0, ""),
        ('<rect width="1e-3em" height="3"/>' * 9 + '<rect width="4" height="3"/>', 12.0, None),
        *(
            (f'<rect width="{length}" height="1"/>', 0.0, "")
            for length in ("calc(1px", "calc()", "calc(1px 2px)", "calc(1/0)", "calc(" + "(" * 150, "calc(a)")
        ),
        *(
            (f'<path id="wing" d="{data}"/>', float("V" in data) * 12.0, "wing")  # up to where they go wrong
            for data in ("L1 1 2 2", "M1 1 L2", "M1 1 L2 2 X", "M0 0 A5 5 0 2 1 9 9", "5 5", "M0 0H4V3H0z L2")
        ),
    ],
)
def test_one_bad_attribute_loses_nothing_else(body: str, expected: float, named: str | None) -> None:
    found = svg_drawing(svg(RECT + body))
    assert found.mesh.area == pytest.approx(2.0 + expected)
    assert len(found.notes) == (named is not None)
    assert (named or "") in " ".join(found.notes)


def test_of_many_bad_attributes_some_are_named() -> None:
    found = svg_drawing(svg(RECT + "".join(f'<use href="#u{k}"/>' * 2 for k in range(20))))
    assert "#u0" in found.notes[0] and "14" in found.notes[-1]
    assert len(found.notes) < 20


@pytest.mark.parametrize(
    "text",
    ["hello", "<html/>", b"\xff\xfe\x00", None, 5, svg(""), svg('<text x="0">A</text>'),
     '<svg><rect width="50%" height="1"/></svg>', svg('<rect width="5furlongs" height="1"/>'),
     svg('<path d="M0 0 L1e300 1 L2 1e300 Z"/>'), svg('<path d="M0 0 L1 1 L2 2 Z"/>'),
     svg('<path d="M0 0 L1e999 1 L2 5 Z"/>'), svg('<path d="M0 0 L0 0 Z"/>'),
     svg("<g>" * 5000 + SQUARE + "</g>" * 5000)],
)  # fmt: skip
def test_what_is_no_drawing_is_an_error(text: object) -> None:
    refusal(from_svg, text)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, math.nan, math.inf, "1"])
def test_tolerances_are_positive_lengths(tolerance: object) -> None:
    assert refusal(from_svg, svg(SQUARE), tolerance=tolerance).code == "setting.invalid"


# Shapes one by one


def test_shapes_one_by_one_keep_their_clips_and_copies() -> None:
    body = """<clipPath id="left" clipPathUnits="objectBoundingBox"><rect width=".5" height="1"/></clipPath>
        <g clip-path="url(#left)"><rect id="a" width="4" height="2"/><rect x="6" width="4" height="2"/></g>
        <use href="#a" y="5"/><path id="a" d="M0 9h3v1H0z" fill="none" stroke="red" stroke-width="2"/>
        <rect id="hidden" width="1" height="1" fill="none"/>"""
    found = svg_drawing(svg(body), each=True)
    assert [name for name, _ in found.shapes] == ["a", "a", "a"]
    assert [mesh.area for _, mesh in found.shapes] == pytest.approx([8.0, 8.0, 15.0])
    whole = svg_drawing(svg(body), each=None)
    assert len(whole.shapes) == 1
    assert whole.mesh == from_svg(svg(body))


def test_parts_have_names_groups_and_all_that_they_paint() -> None:
    body = """<style>.a{fill:teal;stroke:rgb(255,0,0);stroke-width:2}</style>
        <linearGradient id="fade"><stop stop-color="#000"/><stop offset="1" stop-color="#fff"/></linearGradient>
        <g id="body"><g id="arm"><rect class="a" x="10" y="10" width="20" height="30"/>
        <path id="open" d="M50 50h20v20" fill="#00f8" stroke="black" stroke-width="3" transform="scale(2)"/></g></g>
        <circle id="eye" r="5" fill="url(#fade)" opacity="0.5"/><g id="none"/>"""
    parts, notes = puppet_parts(svg(body))
    assert not notes
    assert [part.groups for part in parts] == [("body", "arm"), ("body", "arm"), ()]
    assert [part.name for part in parts[1:]] == ["open", "eye"]
    assert [part.outline.area for part in parts] == pytest.approx([22 * 32, 4 * 265, 25 * math.pi], rel=6e-3)
    assert np.ravel(parts[0].outline.bounds).tolist() == [9, -41, 31, -9]  # y points up
    with pytest.raises(InvalidMeshError):
        puppet_parts(svg('<path d="M0 0h1z"/>'))


DEFINED = """<defs><g id="shoe"><rect width="3" height="2"/><rect width="3" height="1"/></g>
    <symbol id="star"><rect width="2" height="2"/></symbol></defs><rect id="leg" width="1" height="9"/>"""


@pytest.mark.parametrize(("body", "wanted"), [
    ('<g inkscape:label="head" id="layer2"><g id="g12"><rect id="rect7" width="9" height="9"/>'
     '<rect id="rect8-3" inkscape:label="eye" width="1" height="1"/></g></g><rect id="path3-6" width="4" height="4"/>',
     [("head 1", "head"), ("eye", "head"), ("path3-6", "")]),  # as Inkscape writes
    ('<g id="Right_x20_arm"><rect id="XMLID_4_" width="9" height="9"/></g><g id="Torso_1_"><rect width="3" height="3"/>'
     '</g><rect id="a-2" data-name="left hand" width="1" height="1"/>',
     [("Right arm 1", "Right arm"), ("Torso 2", "Torso"), ("left hand", "")]),  # as Illustrator does
    ('<g inkscape:label="Layer 1" id="layer1"><rect id="rect1" width="9" height="9"/><rect width="3" height="3"/>'
     '<g id="g5"><rect id="rect2" width="5" height="5"/></g></g>',
     [("rect1", ""), ("rect 2", ""), ("g5 3", "g5")]),
    ('<g id="cat"><rect width="9" height="9"/><rect width="3" height="3"/></g>',
     [("rect 1", "cat"), ("rect 2", "cat")]),
    ('<rect width="9" height="9"/><g id="leg"><rect width="3" height="3"/></g><g id="leg"><rect width="4" height="4"/>'
     '</g>', [("rect 1", ""), ("leg 2", "leg"), ("leg 2 3", "leg 2")]),
    (DEFINED + '<use id="left" href="#shoe"/><use id="use3" href="#shoe" x="9"/><use id="badge" href="#star"/>'
     '<use id="other leg" href="#leg"/><use href="#leg"/>',
     [("leg", ""), ("left 2", "left"), ("left 3", "left"), ("shoe 4", "shoe"), ("shoe 5", "shoe"),
      ("badge 6", "badge"), ("other leg", ""), ("leg", "")]),
])  # fmt: skip
def test_parts_are_named_by_artists_and_not_by_programs(body: str, wanted: list[tuple[str, str]]) -> None:
    parts, _ = puppet_parts(svg(body, INKSCAPE))
    assert [(part.name, "".join(part.groups[-1:])) for part in parts] == wanted
