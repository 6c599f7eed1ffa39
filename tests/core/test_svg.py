"""SVG as it is painted: strokes, styles, clips, masks and gradients against areas known beforehand."""

from __future__ import annotations

import math
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from nestedcages_core import InvalidMeshError, Mesh, NestedCagesError, from_svg
from nestedcages_core.exchange import (
    Frame,
    Limits,
    Painted,
    joined,
    read_svg_drawing,
    solid,
    svg_drawing,
    svg_parts,
    to_svg,
    write_svg,
)
from nestedcages_core.geometry.predicates import winding_number
from support.shapes import letter_a, polygon, ring

ROOT = Path(__file__).resolve().parents[2]
SQUARE = '<rect width="10" height="10"/>'


def svg(body: str, attributes: str = "") -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg" {attributes}>{body}</svg>'


def area(body: str, attributes: str = "", **options: object) -> float:
    return from_svg(svg(body, attributes), **options).area


def line(style: str, data: str = "M0 0H10") -> str:
    return f'<path fill="none" stroke="red" d="{data}" {style}/>'


# Strokes


@pytest.mark.parametrize(
    ("style", "data", "expected"),
    [
        ("", "M0 0H10", 10.0),
        ('stroke-width="2"', "M0 0H10", 20.0),
        ('stroke-width="2" stroke-linecap="square"', "M0 0H10", 24.0),
        ('stroke-width="2" stroke-linecap="round"', "M0 0H10", 20.0 + math.pi),
        ('stroke-width="2"', "M0 0H10V10", 40.0),  # the mitre fills the corner
        ('stroke-width="2" stroke-linejoin="bevel"', "M0 0H10V10", 39.5),
        ('stroke-width="2" stroke-linejoin="round"', "M0 0H10V10", 39.0 + math.pi / 4.0),
        ('stroke-width="2" stroke-miterlimit="1.4"', "M0 0H10V10", 39.5),  # beyond the limit: a bevel
        ('stroke-width="2" stroke-miterlimit="1.42"', "M0 0H10V10", 40.0),
        ('stroke-width="2"', "M0 0H10V10H0Z", 80.0),
        ('stroke-width="2" stroke-dasharray="2 1"', "M0 0H10", 14.0),
        ('stroke-width="2" stroke-dasharray="2,1" stroke-dashoffset="1"', "M0 0H10", 14.0),
        ('stroke-width="2" stroke-dasharray="3"', "M0 0H10", 12.0),
        ('stroke-width="2" stroke-dasharray="0"', "M0 0H10", 20.0),
        ('stroke-width="2" stroke-dasharray="-1 2"', "M0 0H10", 20.0),
        ('stroke-width="2" stroke-linecap="square"', "M3 3h0", 4.0),
        ('stroke-width="2" stroke-linecap="round"', "M3 3z", math.pi),
        ('stroke-width="2" transform="scale(2 3)"', "M0 0H10", 120.0),
        ('transform="scale(2)" vector-effect="non-scaling-stroke"', "M0 0H10", 20.0),
    ],
)
def test_strokes_have_their_areas(style: str, data: str, expected: float) -> None:
    assert area(line(style, data), tolerance=1e-4) == pytest.approx(expected, rel=2e-4)


def test_corners_beyond_the_mitre_limit_are_bevelled_beside_corners_within_it() -> None:
    found = shapely.geometry.shape(from_svg(svg(line('stroke-width="2"', "M0 0H20V-20L19 0"))))
    assert found.covers(shapely.Point(20.99, 0.99))  # the right angle has its mitre
    assert found.bounds[1] > -21.1  # the sharp one has none


def test_fill_and_stroke_are_united() -> None:
    assert area('<rect width="10" height="10" stroke="red" stroke-width="2"/>') == pytest.approx(144.0)
    assert area('<rect width="10" height="10" stroke="red" stroke-width="2"/>', strokes=False) == 100.0
    assert area('<rect width="10" height="10" fill="none" stroke="red" stroke-width="2"/>') == pytest.approx(80.0)


def test_a_stroke_that_does_not_scale_is_measured_on_the_page() -> None:
    body = line('vector-effect="non-scaling-stroke" stroke-width="3"', "M10 50H90")
    assert area(body, 'viewBox="0 0 100 100" width="200" height="200"') == pytest.approx(80.0 * 1.5)


def test_markers_are_left_out_with_a_note() -> None:
    marker = '<marker id="m" markerWidth="4" markerHeight="4"><rect width="4" height="2"/></marker>'
    marked = ('marker-end="url(#m)" marker-mid="url(#m)"', 'style="marker:url(#m)"', 'marker-end="url(#gone)"')
    for attributes, notes in zip(marked, (("Left out: 2 markers.",), ("Left out: 1 marker.",), ()), strict=True):
        drawing = svg_drawing(svg(f'{marker}<path d="M10 10V20H30Z" {attributes}/>'))
        assert (drawing.mesh.area, drawing.notes) == (100.0, notes)


# Styles


@pytest.mark.parametrize(
    "sheet",
    [
        ".off{fill:none}",
        "g .off{fill:none}",
        "g > rect.off{fill:none}",
        "rect.off.off{fill:none} .off{fill:red}",
        ".off{fill:none!important} #b{fill:red}",
        "@media screen{.off{fill:none}} @media print{.off{fill:red}}",
        '[class~="off"]{fill:none;fill:none} /* a } comment { */',
        "broken { { } } .off{fill:none}",
        ".off{display:none}",
        ".off{visibility:hidden}",
        ".off{fill-opacity:0}",
        ".off{opacity:0%}",
        ".off{fill:#f000}",
        ".off{fill:rgba(1,2,3,0)}",
        ".off{fill:hsl(10 20% 30% / 0)}",
        ".off{color:transparent;fill:currentColor}",
    ],
)
def test_style_sheets_say_what_is_painted(sheet: str) -> None:
    body = f'<style>{sheet.replace(">", "&gt;")}</style><g><rect id="b" class="on off" width="9" height="9"/></g>'
    assert area(body + '<rect x="20" width="1" height="2"/>') == 2.0


def test_the_style_attribute_is_stronger_than_sheets_unless_they_are_important() -> None:
    rect = '<rect width="3" height="1" style="fill:red"/><rect x="5" width="1" height="1"/>'
    assert area(f"<style>rect{{fill:none}}</style>{rect}") == 3.0
    with pytest.raises(NestedCagesError, match="no filled"):
        from_svg(svg(f"<style>rect{{fill:none!important;visibility:hidden}}</style>{rect}"))


@pytest.mark.parametrize(
    ("body", "bounds"),
    [
        ("<style>rect{x:10px;y:1em;width:30px;height:calc(2px * 3)}</style><rect width='1'/>",
         (10, 16, 40, 22)),
        ("""<path d="M0 0h1v1z" style="d:path('M5 5h3v3h-3z')"/>""", (5, 5, 8, 8)),
        ("<style>:root{--c:var(--d)} svg{--d:none} rect{fill:var(--c)} .k{fill:var(--no, red)}</style>"
         f"{SQUARE}<rect class='k' x='30' width='2' height='2'/>", (30, 0, 32, 2)),
        ("<style>rect{transform:rotate(90deg);transform-origin:10px 10px}</style>" + SQUARE, (10, 0, 20, 10)),
        ("<rect x='40' width='10' height='4' transform='rotate(180)' transform-origin='bottom right'/>",
         (150, 396, 160, 400)),
        (f"<o:g xmlns:o='urn:o'>{SQUARE}</o:g><rect x='2' width='5vmin' height='5vmax'/>", (2, 0, 7, 10)),
        ("<style>@supports (fill:red){rect{fill:none}}</style><style type='text/less'>circle{fill:none}</style>"
         f"{SQUARE}<circle cx='20' cy='20' r='2'/>", (18, 18, 22, 22)),
    ],
)  # fmt: skip
def test_styles_place_what_they_paint(body: str, bounds: tuple[float, ...]) -> None:
    found = from_svg(svg(body, 'viewBox="0 0 100 200"'), crop=False)
    assert np.ravel(found.bounds) == pytest.approx(np.array(bounds), abs=1e-3)


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ('<path d="M0 0h80" stroke="red" stroke-width="2" pathLength="8" stroke-dasharray="1"/>', 80.0),
        ('<g fill="none"><rect width="9" height="9" style="fill:unset"/><rect x="9" width="2" height="2" '
         'style="fill:initial"/></g>', 4.0),
        ('<linearGradient id="g"><stop offset=".5"/><stop offset=".5" stop-color="#fff"/></linearGradient><mask id="m">'
         '<rect width="10" height="10" fill="url(#g)"/></mask><rect width="10" height="10" mask="url(#m)"/>', 50.0),
    ],
)  # fmt: skip
def test_dashes_defaults_and_masks_are_those_of_browsers(body: str, expected: float) -> None:
    assert area(body) == pytest.approx(expected)


def test_clips_by_style_alone_are_told() -> None:
    assert "Left out: 1 clip path." in svg_drawing(svg(SQUARE.replace("/>", ' style="clip-path:circle(2px)"/>'))).notes


def test_transforms_of_style_sheets_have_units() -> None:
    body = '<style>rect{transform:translate(10px,5px) rotate(.25turn)}</style><rect width="4" height="2"/>'
    points = from_svg(svg(body)).vertices
    assert [*points.min(axis=0), *points.max(axis=0)] == pytest.approx([8.0, 5.0, 10.0, 9.0])


def test_opacity_counts_from_a_threshold() -> None:
    body = '<g opacity="0.5"><rect width="2" height="1" fill-opacity="0.5"/></g><rect x="5" width="1" height="1"/>'
    assert area(body) == 3.0
    assert area(body, opacity=0.3) == 1.0
    with pytest.raises(NestedCagesError, match="from 0 to 1"):
        from_svg(svg(body), opacity=2.0)


# Gradients


def test_a_line_that_fades_has_no_inside() -> None:
    fade = '<linearGradient id="g"><stop/><stop offset="1" stop-opacity="0"/></linearGradient>'
    assert area(f'{fade}<path d="M0 0L5 5L0 0" fill="url(#g)"/>{SQUARE}') == 100.0


def test_a_linear_gradient_ends_where_it_fades() -> None:
    stops = '<stop stop-color="red"/><stop offset="1" stop-opacity="0"/>'
    linear = f'<linearGradient id="g">{stops}</linearGradient><rect width="10" height="4" fill="url(#g)"/>'
    assert area(linear, opacity=0.25) == pytest.approx(30.0)
    assert area(linear) == pytest.approx(40.0, rel=3e-3)
    turned = linear.replace('id="g"', 'id="g" gradientTransform="rotate(90)"')
    assert area(turned, opacity=0.25) == pytest.approx(30.0)


def test_a_radial_gradient_ends_in_a_circle() -> None:
    radial = (
        '<linearGradient id="s"><stop/><stop offset="1" stop-opacity="0"/></linearGradient>'
        '<radialGradient id="g" href="#s" gradientUnits="userSpaceOnUse" cx="5" cy="5" r="4"/>'
        '<rect width="10" height="10" fill="url(#g)"/>'
    )
    assert area(radial, opacity=0.5) == pytest.approx(math.pi * 4.0, rel=2e-3)
    ring_of = radial.replace("<stop/>", '<stop stop-opacity="0"/><stop offset="0.5"/>')
    assert area(ring_of, opacity=0.5) == pytest.approx(math.pi * (9.0 - 1.0), rel=2e-3)


def test_paint_that_is_missing_has_a_substitute() -> None:
    assert area(f'<g fill="url(#none) red">{SQUARE}</g>') == 100.0
    with pytest.raises(NestedCagesError):
        from_svg(svg('<path fill="url(#none)" d="M0 0H1V1"/>'))
    assert area(f'<pattern id="p"/><g fill="url(#p)">{SQUARE}</g>') == 100.0


# Clips and masks, and filters that are left out


@pytest.mark.parametrize(
    ("clip", "expected"),
    [
        ('<clipPath id="c"><rect x="5" width="10" height="10"/></clipPath>', 50.0),
        ('<clipPath id="c"><rect x="5" width="9" height="9" transform="translate(0 5)"/></clipPath>', 25.0),
        ('<clipPath id="c"><rect width="2" height="9"/><rect x="5" width="3" height="9"/></clipPath>', 45.0),
        ('<clipPath id="c" clipPathUnits="objectBoundingBox"><rect width=".5" height=".5"/></clipPath>', 25.0),
        ('<clipPath id="c"><path clip-rule="evenodd" d="M0 0H10V10H0zM2 2H8V8H2z"/></clipPath>', 64.0),
        ('<clipPath id="d"><rect width="2" height="9"/></clipPath><clipPath id="c" clip-path="url(#d)">'
         '<rect width="9" height="3"/></clipPath>', 6.0),
        ('<clipPath id="c"><rect x="-5" y="-5" width="99" height="99"/></clipPath>', 100.0),
    ],
)  # fmt: skip
def test_clip_paths(clip: str, expected: float) -> None:
    assert area(f'{clip}<g clip-path="url(#c)">{SQUARE}</g>') == pytest.approx(expected)


@pytest.mark.parametrize(
    ("mask", "expected"),
    [
        ('<mask id="c"><rect fill="white" width="5" height="10"/></mask>', 50.0),
        ('<mask id="c"><rect fill="#fff" width="10" height="10"/><rect width="5" height="5"/></mask>', 75.0),
        ('<mask id="c"><rect fill="black" width="9" height="9"/><rect fill="red" width="5" height="5"/></mask>', 25.0),
        ('<mask id="c" mask-type="alpha"><rect width="5" height="5"/></mask>', 25.0),
        ('<mask id="c" x="0" y="0" width=".5" height="1"><rect fill="white" width="99" height="99"/></mask>', 50.0),
        ('<mask id="c" maskContentUnits="objectBoundingBox"><rect fill="white" width=".5" height="1"/></mask>', 50.0),
        ('<mask id="c"><path stroke="white" stroke-width="2" d="M0 5H10"/></mask>', 20.0),
    ],
)
def test_masks_by_luminance_and_alpha(mask: str, expected: float) -> None:
    assert area(f'{mask}<g mask="url(#c)">{SQUARE}</g>') == pytest.approx(expected)


def test_nested_documents_are_clipped_to_their_viewport() -> None:
    nested = '<svg x="1" y="1" width="4" height="2" viewBox="0 0 2 2" preserveAspectRatio="{}">' + SQUARE + "</svg>"
    assert area(nested.format("xMidYMid")) == pytest.approx(6.0)  # two by two in the middle, and what reaches the right
    assert area(nested.format("none")) == pytest.approx(8.0)
    assert area(nested.format("xMaxYMid")) == pytest.approx(4.0)
    assert area(nested.replace("<svg ", '<svg overflow="visible" ').format("none")) == pytest.approx(200.0)


def test_filters_are_left_out_with_a_note() -> None:
    blur = '<filter id="f"><feGaussianBlur stdDeviation="1"/></filter>'
    drawing = svg_drawing(
        svg(f'{blur}<g filter="url(#f)">{SQUARE}</g><rect x="20" filter="blur(2px)" width="10" height="10"/>')
    )
    assert (drawing.mesh.area, drawing.notes) == (200.0, ("Left out: 2 filters.",))
    clipped = (
        '<clipPath id="c"><rect filter="url(#f)" width="10" height="10"/></clipPath>'  # where filters change nothing
    )
    assert svg_drawing(svg(f'{blur}{clipped}<g clip-path="url(#c)">{SQUARE}</g>')).notes == ()


# What is read, and what is said of the rest


def test_layers_and_elements_can_be_read_alone() -> None:
    label = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
    body = f'<g inkscape:label="Ink">{SQUARE}</g><g id="two"><rect id="r" x="20" width="2" height="3"/></g>'
    assert area(body, label, layers=("Ink",)) == 100.0
    assert area(body, label, layers=("Ink", "two")) == 106.0
    assert area(body, label, layers=("two",), element="r") == 6.0
    with pytest.raises(NestedCagesError, match="no layer 'Pencil'; its layers: Ink, two"):
        from_svg(svg(body, label), layers=("Pencil",))


def test_what_is_left_out_is_counted() -> None:
    body = f'{SQUARE}<text>A</text><text>B</text><image/><g display="none"><text>C</text></g>'
    assert svg_drawing(svg(body)).notes == ("Left out: 2 texts, 1 image.",)
    stroked = svg_drawing(svg(f'<g stroke="red">{SQUARE}</g>'), strokes=False)
    assert stroked.notes == ("Left out: 1 stroke, since strokes are turned off.",)
    with pytest.raises(NestedCagesError, match=r"Left out: 1 text\.$"):
        from_svg(svg("<text>A</text>"))


def test_a_background_is_named_and_can_be_left_out() -> None:
    body = '<rect id="paper" width="100%" height="100%"/><circle cx="5" cy="5" r="2"/>'
    page = svg(body, 'viewBox="0 0 20 10"')
    whole = svg_drawing(page)
    assert whole.notes == ("The rect 'paper' covers the whole page; background=False leaves it out.",)
    assert whole.mesh.area == 200.0
    alone = svg_drawing(page, background=False)
    assert alone.mesh.area == pytest.approx(4.0 * math.pi, rel=1e-2)
    assert alone.notes == ("Left out: the rect 'paper', which covers the whole page.",)


def test_what_lies_outside_the_page_is_cut_off() -> None:
    page = svg('<rect x="-5" y="2" width="10" height="4"/>', 'viewBox="0 0 20 10"')
    found = svg_drawing(page)
    assert found.mesh.area == pytest.approx(20.0)
    assert found.notes == ("Cut off: what lies outside the page; crop=False keeps it.",)
    assert from_svg(page, crop=False).area == 40.0


@pytest.mark.parametrize(
    ("page", "expected"),
    [
        ('width="20" height="10"', 200.0),  # 5 units on either side of the view box are seen
        ('width="10mm" height="20mm"', 200.0),
        ('width="20" height="10" preserveAspectRatio="xMinYMid"', 200.0),
        ('width="20" height="10" preserveAspectRatio="xMaxYMid slice"', 50.0),
        ('width="20" height="10" preserveAspectRatio="none"', 100.0),
        ('width="20"', 100.0),
        ('width="100%" height="50"', 100.0),
    ],
)
def test_what_is_seen_next_to_the_view_box_stays(page: str, expected: float) -> None:
    drawn = svg('<rect x="-30" y="-30" width="70" height="70"/><path d="M0 0h1"/>', f'viewBox="0 0 10 10" {page}')
    found = svg_drawing(drawn)
    assert found.mesh.area == pytest.approx(expected)
    again = from_svg(to_svg(found.mesh, frame=found.frame))  # in the same frame
    assert again.area == pytest.approx(expected)


def test_shapes_one_by_one_keep_their_clips_and_copies() -> None:
    body = """<clipPath id="left" clipPathUnits="objectBoundingBox"><rect width=".5" height="1"/></clipPath>
        <g clip-path="url(#left)"><rect id="a" width="4" height="2"/><rect x="6" width="4" height="2"/></g>
        <use href="#a" y="5"/><path id="a" d="M0 9h3v1H0z" fill="none" stroke="red" stroke-width="2"/>
        <rect id="hidden" width="1" height="1" fill="none"/>"""
    found = svg_drawing(svg(body), each=True)
    assert [name for name, _ in found.shapes] == ["a", "a", "a"]
    assert [mesh.area for _, mesh in found.shapes] == pytest.approx([8.0, 8.0, 15.0])
    assert not found.written
    whole = svg_drawing(svg(body), each=None)
    assert len(whole.shapes) == 1
    assert whole.mesh == from_svg(svg(body))
    again = svg_drawing(to_svg({"one": whole.mesh, "two": letter_a()}), each=None)
    assert again.written
    assert [name for name, _ in again.shapes] == ["two", "one"]


def test_parts_have_names_groups_and_paints_from_the_style_sheet() -> None:
    body = """<style>.a{fill:teal;stroke:rgb(255,0,0);stroke-width:2}</style>
        <linearGradient id="fade"><stop stop-color="#000"/><stop offset="1" stop-color="#fff"/></linearGradient>
        <g id="body"><g id="arm"><rect class="a" x="10" y="10" width="20" height="30"/>
        <path id="open" d="M50 50h20v20" fill="#00f8" stroke="black" stroke-width="3" transform="scale(2)"/></g></g>
        <circle id="eye" r="5" fill="url(#fade)" opacity="0.5"/><g id="none"/>"""
    parts, notes = svg_parts(svg(body))
    assert notes == ("Gradients become their mean colour.",)
    assert [(part.name, part.groups) for part in parts] == [
        ("arm 1", ("body", "arm")),
        ("open", ("body", "arm")),
        ("eye", ()),
    ]
    rect, opened, eye = parts
    assert (rect.fill_colour, rect.stroke_colour, rect.stroke_width) == ((0, 128 / 255, 128 / 255, 1), (1, 0, 0, 1), 2)
    assert rect.fill is not None and rect.stroke is not None and opened.fill is not None and opened.stroke is not None
    assert (rect.fill.area, rect.stroke.area) == pytest.approx((18 * 28, 22 * 32 - 18 * 28))
    assert opened.fill_colour == (0, 0, 1, 136 / 255)
    # The fill under an open line is cut by it, and both have the same points along the cut.
    assert (opened.fill.area, opened.stroke.area) == pytest.approx((4 * 144.5, 4 * 120))
    assert set(map(tuple, opened.fill.vertices)) <= set(map(tuple, opened.stroke.vertices))
    assert eye.fill_colour == (0.5, 0.5, 0.5, 0.5) and eye.stroke is None and eye.stroke_width == 0
    with pytest.raises(InvalidMeshError):
        svg_parts(svg('<path d="M0 0h1z"/>'))


INKSCAPE = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'


def names_of(body: str) -> list[tuple[str, str]]:
    """The name and the innermost group of each part."""
    return [(part.name, "".join(part.groups[-1:])) for part in svg_parts(svg(body, INKSCAPE))[0]]


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
    ('<g id="cat"><rect width="9" height="9"/><rect width="3" height="3"/></g>', [("rect 1", "cat"),
     ("rect 2", "cat")]),
    ('<rect width="9" height="9"/><g id="leg"><rect width="3" height="3"/></g><g id="leg"><rect width="4" height="4"/>'
     '</g>', [("rect 1", ""), ("leg 2", "leg"), ("leg 2 3", "leg 2")]),
])  # fmt: skip
def test_parts_are_named_by_artists_and_not_by_programs(body: str, wanted: list[tuple[str, str]]) -> None:
    assert names_of(body) == wanted


def test_copies_are_named_after_their_uses() -> None:
    body = """<defs><g id="shoe"><rect width="3" height="2"/><rect width="3" height="1"/></g>
        <symbol id="star"><rect width="2" height="2"/></symbol></defs><rect id="leg" width="1" height="9"/>
        <use id="left" href="#shoe"/><use id="use3" href="#shoe" x="9"/><use id="badge" href="#star"/>
        <use id="other leg" href="#leg"/><use href="#leg"/>"""
    assert names_of(body) == [("leg", ""), ("left 2", "left"), ("left 3", "left"), ("shoe 4", "shoe"),
                              ("shoe 5", "shoe"), ("badge 6", "badge"), ("other leg", ""), ("leg", "")]  # fmt: skip


def test_a_switch_draws_its_first_usable_child() -> None:
    body = (
        f'<switch><foreignObject/><g requiredExtensions="x">{SQUARE}</g><rect width="2" height="1"/>{SQUARE}</switch>'
    )
    assert area(body) == 2.0


# Output lies on its source


def test_output_has_the_frame_of_its_source(tmp_path: Path) -> None:
    attributes = 'viewBox="3 4 50 20" width="5cm" height="20mm" preserveAspectRatio="xMinYMin"'
    (tmp_path / "a.svg").write_text(svg('<rect x="5" y="5" width="30" height="10"/>', attributes))
    drawing = read_svg_drawing(tmp_path / "a.svg")
    write_svg(tmp_path / "b.svg", drawing.mesh, frame=drawing.frame)
    again = read_svg_drawing(tmp_path / "b.svg")
    assert again.frame == drawing.frame == Frame((3.0, 4.0, 50.0, 20.0), "5cm", "20mm", "xMinYMin")
    assert sorted(again.mesh.vertices.tolist()) == sorted(drawing.mesh.vertices.tolist())
    sized = svg_drawing(svg(SQUARE, 'width="40" height="30"'))
    assert svg_drawing(to_svg(sized.mesh, frame=sized.frame)).frame == sized.frame


def test_a_cage_beyond_the_page_is_read_back_whole() -> None:
    page = Frame((0.0, 0.0, 1.0, 1.0))
    mesh = letter_a(1)
    assert from_svg(to_svg(mesh, frame=page)).area == mesh.area


def test_levels_are_styled_apart_and_cages_lie_below() -> None:
    meshes = {name: Mesh.from_loops([ring(8, r)]) for name, r in (("a", 1.0), ("a-1", 2.0), ("b", 1.5), ("b-1", 3.0))}
    text = to_svg(meshes, levels=[0, 1, 0, 1])
    colours = {name: text.split(f'id="{name}"')[1].split('fill="')[1].split('"')[0] for name in meshes}
    assert colours["a"] == colours["b"] != colours["a-1"] == colours["b-1"]
    assert text.index('id="b-1"') < text.index('id="a"')
    with pytest.raises(NestedCagesError, match="2 levels for 4 shapes"):
        to_svg(meshes, levels=[0, 1])


def test_maps_are_written_with_y_pointing_up() -> None:
    text = to_svg(Mesh.from_loops([[(0, 0), (4, 0), (0, 3)]]), y_up=True)
    assert from_svg(text).vertices.min(axis=0).tolist() == [0.0, -3.0]


def test_names_that_xml_cannot_hold_are_mended() -> None:
    mesh = Mesh.from_loops([ring(3)])
    assert from_svg(to_svg({'a\x00"<b>': mesh}), element='a_"<b>').area == mesh.area


# Unions


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000), st.booleans())
def test_unions_agree_with_exact_winding_numbers(seed: int, evenodd: bool) -> None:
    rng = np.random.default_rng(seed)
    loops = [rng.integers(-8, 9, (int(rng.integers(3, 9)), 2)).astype(float) for _ in range(int(rng.integers(1, 4)))]
    points = rng.uniform(-9.0, 9.0, (200, 2))
    starts, ends = np.concatenate(loops), np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    winding = winding_number(points, starts, ends)
    expected = winding % 2 == 1 if evenodd else winding != 0
    try:
        mesh = solid([Painted(loops, evenodd)])
    except InvalidMeshError:
        assert not expected.any()
        return
    found = winding_number(points, mesh.vertices[mesh.edges[:, 0]], mesh.vertices[mesh.edges[:, 1]]) != 0
    distance = shapely.distance(shapely.points(points), polygon(mesh).boundary)
    assert ((found == expected) | (distance < 1e-4)).all()  # touching corners are joined by necks


def test_nested_loops_keep_their_points_whoever_paints_them() -> None:
    rings = [ring(40, radius) * math.pi for radius in (5.0, 4.0, 3.0, 2.0)]
    both = solid([Painted(rings[:2], evenodd=True), Painted(rings[2:], evenodd=True)])
    assert both.loop_signs.tolist() == [1, -1, 1, -1]
    assert np.array_equal(both.vertices, np.concatenate(rings))
    covered = solid([Painted(rings[:2], evenodd=True), Painted([rings[1] * 1.1]), Painted([rings[3]])])
    assert len(covered.loops) == 1


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
    with pytest.raises(NestedCagesError, match="positive length"):
        joined(apart, 0.0)


# Without the libraries


def test_without_shapely_plain_drawings_are_read_and_others_get_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("shapely", "tinycss2", "cssselect2"):
        monkeypatch.setitem(sys.modules, name, None)
    assert area(f'{SQUARE}<circle cx="30" cy="5" r="3" fill="#f00"/>') == pytest.approx(100.0 + 9.0 * math.pi, rel=1e-2)
    whole = '<clipPath id="c"><path d="M-1 -1h20v20h-20z"/></clipPath>'
    assert area(f'{whole}<g clip-path="url(#c)">{SQUARE}</g>') == 100.0  # as drawing programs write around everything
    for body in (line(""), SQUARE + '<rect x="5" width="10" height="9"/>', f"<style>rect{{fill:red}}</style>{SQUARE}"):
        with pytest.raises(NestedCagesError, match=r"needs .*pip install nested-cages\[formats\]"):
            from_svg(svg(body))


# Hostile documents, next to those of benchmarks/hostile/attacks.py

HOSTILE = {
    "turn": svg(f'<g transform="rotate(1e999)">{SQUARE}</g>'),
    "arc radius": svg('<path d="M0 0 A1e999 5 0 0 1 9 9 L0 9Z"/>'),
    "large arc": svg('<path d="M0 0 A1e308 1e308 0 0 1 9 9 L0 9Z"/>'),
    "arc axis": svg('<path d="M0 0 A5 9 1e999 0 1 9 9 L0 9Z"/>'),
    "arc end": svg('<path d="M0 0 A5 9 0 0 1 1e308 9 L0 9Z"/>'),
    "arcs": svg(f'<path d="M0 0A{"1 1 0 0 1 2 1 " * 80_000}"/>'),
    "two bytes": b'<?xml version="1.0" encoding="gbk"?><svg/>',
    "digits": svg(f'<rect width="{"9" * 5000}" height="1"/>'),
    "digits of the page": svg(SQUARE, f'width="{"9" * 5000}" height="{"9" * 5000}"'),
    "no number": svg(f'<rect width="{"9" * 200_000}x!" height="1"/>'),
    "sheet of commas": svg(f"<style>{'a,' * 100_000}</style>{SQUARE}"),
    "sheet of braces": svg(f"<style>{'@media all{' * 3000}</style>{SQUARE}"),
    "selectors": svg(f"<style>{':not(' * 3000}a{')' * 3000}{{fill:red}}</style>{SQUARE}"),
    "descendants": svg(f"<style>{'g ' * 50}rect.x{{fill:red}}</style>{'<g>' * 55}{SQUARE}{'</g>' * 55}"),
    "comments": svg(f'<rect width="9" height="9" style="{"/*" * 100_000}"/>'),
    "wide stroke": svg(line('stroke-width="1e140"')),
    "no width": svg(line('stroke-width="1e-300"')),
    "mitre": svg(line('stroke-miterlimit="1e308"', "M0 0L10 0L0 1e-9")),
    "flat": svg(f'<g transform="scale(0 1)" stroke="red">{SQUARE}</g>'),
    "gradient": svg('<radialGradient id="g" r="1e300" fx="1e300"><stop stop-opacity="0"/><stop offset="1"/>'
                    '</radialGradient><rect fill="url(#g)" width="5" height="5"/>'),
    "gradients": svg(f'<linearGradient id="g" href="#g"/><g fill="url(#g)">{SQUARE}</g>'),
    "mask of itself": svg(f'<mask id="m"><g mask="url(#m)">{SQUARE}</g></mask><g mask="url(#m)">{SQUARE}</g>'),
    "symbol": svg('<symbol id="s" viewBox="0 0 1e-300 1e-300"><rect width="1" height="1"/></symbol>'
                  '<use href="#s" width="1e300" height="1e300"/>'),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.parametrize("tolerance", [None, 1e-320])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.slow
def test_hostile_documents_end_in_a_mesh_or_a_sentence(name: str, tolerance: float | None) -> None:
    start = time.process_time()
    try:
        assert svg_drawing(HOSTILE[name], tolerance=tolerance, limits=Limits(elements=20_000)).mesh.area > 0.0
    except NestedCagesError as error:
        assert str(error).endswith(".")
    assert time.process_time() - start < 30.0
