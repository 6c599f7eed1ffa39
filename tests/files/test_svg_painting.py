"""SVG as browsers paint it: strokes, styles, gradients, clips and masks against areas known beforehand."""

import math
from typing import Any

import numpy as np
import pytest
import shapely

from nestedcages_core import from_svg, svg_drawing
from support.documents import area_of, refusal, solid, svg

SQUARE = '<rect width="10" height="10"/>'
FINE = 1e-4
"""Tolerance of curves that leaves their areas right to 0.1 %."""


def line(style: str, data: str = "M0 0H10") -> str:
    return f'<path fill="none" stroke="red" d="{data}" {style}/>'


@pytest.mark.parametrize(
    ("style", "data", "expected"),
    [
        ("", "M0 0H10", 10.0),
        ('stroke-width="2" stroke-linecap="square"', "M0 0H10", 24.0),
        ('stroke-width="2" stroke-linecap="round"', "M0 0H10", 20.0 + math.pi),
        ('stroke-width="2"', "M0 0H10V10", 40.0),  # the mitre fills the corner
        ('stroke-width="2" stroke-linejoin="bevel"', "M0 0H10V10", 39.5),
        ('stroke-width="2" stroke-linejoin="round"', "M0 0H10V10", 39.0 + math.pi / 4.0),
        ('stroke-width="2" stroke-miterlimit="1.4"', "M0 0H10V10", 39.5),  # beyond the limit: a bevel
        ('stroke-width="2" stroke-miterlimit="1.42"', "M0 0H10V10", 40.0),
        ('stroke-width="2"', "M0 0H10V10H0Z", 80.0),
        ('stroke-width="2" stroke-dasharray="2,1" stroke-dashoffset="1"', "M0 0H10", 14.0),
        ('stroke-width="2" stroke-dasharray="3"', "M0 0H10", 12.0),
        ('stroke-width="2" stroke-dasharray="0"', "M0 0H10", 20.0),
        ('stroke-width="2" stroke-dasharray="-1 2"', "M0 0H10", 20.0),
        ('stroke-width="2" stroke-linecap="square"', "M3 3h0", 4.0),
        ('stroke-width="2" stroke-linecap="round"', "M3 3z", math.pi),
        ('stroke-width="2" transform="scale(2 3)"', "M0 0H10", 120.0),
        ('transform="scale(2)" vector-effect="non-scaling-stroke"', "M0 0H10", 20.0),
        ('stroke-width="2" pathLength="8" stroke-dasharray="1"', "M0 0H80", 80.0),
    ],
)
def test_strokes_have_their_areas(style: str, data: str, expected: float) -> None:
    assert area_of(line(style, data), tolerance=FINE) == pytest.approx(expected, rel=1e-3)


def test_a_stroke_lies_on_both_sides_of_its_path_and_dashes_where_they_belong() -> None:
    found = from_svg(svg(line('stroke-width="2" stroke-dasharray="2 1" stroke-dashoffset="1"', "M0 5H10")))
    wanted = shapely.union_all(shapely.box([0.0, 2.0, 5.0, 8.0], 4.0, [1.0, 4.0, 7.0, 10.0], 6.0))
    assert solid(found).symmetric_difference(wanted).area < 1e-6


def test_corners_beyond_the_mitre_limit_are_bevelled_beside_corners_within_it() -> None:
    found = solid(from_svg(svg(line('stroke-width="2"', "M0 0H20V-20L19 0"))))
    assert found.covers(shapely.Point(20.99, 0.99))  # the right angle has its mitre
    assert found.bounds[1] > -21.1  # the sharp one has none


# Styles


@pytest.mark.parametrize(
    "sheet",
    [".off{fill:none}", "g .off{fill:none}", "g > rect.off{fill:none}", "rect.off.off{fill:none} .off{fill:red}",
     ".off{fill:none!important} #b{fill:red}", "@media screen{.off{fill:none}} @media print{.off{fill:red}}",
     '[class~="off"]{fill:none;fill:none} /* a } comment { */', "broken { { } } .off{fill:none}",
     ".off{display:none}", ".off{visibility:hidden}", ".off{fill-opacity:0}", ".off{opacity:0%}", ".off{fill:#f000}",
     ".off{fill:rgba(1,2,3,0)}", ".off{fill:hsl(10 20% 30% / 0)}", ".off{color:transparent;fill:currentColor}"],
)  # fmt: skip
def test_style_sheets_say_what_is_painted(sheet: str) -> None:
    body = f'<style>{sheet.replace(">", "&gt;")}</style><g><rect id="b" class="on off" width="9" height="9"/></g>'
    assert area_of(body + '<rect x="20" width="1" height="2"/>') == 2.0


@pytest.mark.parametrize(
    ("body", "bounds"),
    [
        ("<style>rect{x:10px;y:1em;width:30px;height:calc(2px * 3)}</style><rect width='1'/>",
         (10, 16, 40, 22)),
        ("""<path d="M0 0h1v1z" style="d:path('M5 5h3v3h-3z')"/>""", (5, 5, 8, 8)),
        ("<style>:root{--c:var(--d)} svg{--d:none} rect{fill:var(--c)} .k{fill:var(--no, red)}</style>"
         f"{SQUARE}<rect class='k' x='30' width='2' height='2'/>", (30, 0, 32, 2)),
        ("<style>rect{transform:rotate(90deg);transform-origin:10px 10px}</style>" + SQUARE, (10, 0, 20, 10)),
        ("<style>rect{transform:translate(10px,5px) rotate(.25turn)}</style><rect width='4' height='2'/>",
         (8, 5, 10, 9)),
        ("<rect x='40' width='10' height='4' transform='rotate(180)' transform-origin='bottom right'/>",
         (150, 396, 160, 400)),
        (f"<o:g xmlns:o='urn:o'>{SQUARE}</o:g><rect x='2' width='5vmin' height='5vmax'/>", (2, 0, 7, 10)),
        ("<style>@supports (fill:red){rect{fill:none}}</style><style type='text/less'>circle{fill:none}</style>"
         f"{SQUARE}<circle cx='20' cy='20' r='2'/>", (18, 18, 22, 22)),
    ],
)  # fmt: skip
def test_styles_place_what_they_paint(body: str, bounds: tuple[float, ...]) -> None:
    found = from_svg(svg(body, 'viewBox="0 0 100 200"'), crop=False)
    assert np.ravel(found.bounds) == pytest.approx(np.array(bounds), abs=5e-3)


# Gradients and other paints

STOPS = '<stop stop-color="red"/><stop offset="1" stop-opacity="0"/>'


def test_a_linear_gradient_ends_where_it_fades() -> None:
    linear = f'<linearGradient id="g">{STOPS}</linearGradient><rect width="10" height="4" fill="url(#g)"/>'
    turned = linear.replace('id="g"', 'id="g" gradientTransform="rotate(90)"')
    for body, box in ((linear, (0, 0, 7.5, 4)), (turned, (0, 0, 10, 3))):
        assert np.ravel(from_svg(svg(body), opacity=0.25).bounds) == pytest.approx(np.array(box))
    assert area_of(linear) == pytest.approx(40.0, rel=3e-3)
    slanted = f'{linear.partition("<rect")[0]}<path d="M0 0L5 5L0 0" fill="url(#g)"/>{SQUARE}'
    assert area_of(slanted) == 100.0  # a line has no inside, faded or not


def test_a_radial_gradient_ends_in_a_circle() -> None:
    radial = (
        f'<linearGradient id="s">{STOPS}</linearGradient>'
        '<radialGradient id="g" href="#s" gradientUnits="userSpaceOnUse" cx="5" cy="5" r="4"/>'
        '<rect width="10" height="10" fill="url(#g)"/>'
    )
    assert area_of(radial, opacity=0.5) == pytest.approx(math.pi * 4.0, rel=2e-3)
    ring = radial.replace('<stop stop-color="red"/>', '<stop stop-opacity="0"/><stop offset="0.5"/>')
    assert area_of(ring, opacity=0.5) == pytest.approx(math.pi * (9.0 - 1.0), rel=2e-3)


# Areas of documents

CLIPS = [
    ('<clipPath id="c"><rect x="5" width="10" height="10"/></clipPath>', 50.0),
    ('<clipPath id="c"><rect x="5" width="9" height="9" transform="translate(0 5)"/></clipPath>', 25.0),
    ('<clipPath id="c"><rect width="2" height="9"/><rect x="5" width="3" height="9"/></clipPath>', 45.0),
    ('<clipPath id="c" clipPathUnits="objectBoundingBox"><rect width=".5" height=".5"/></clipPath>', 25.0),
    ('<clipPath id="c"><path clip-rule="evenodd" d="M0 0H10V10H0zM2 2H8V8H2z"/></clipPath>', 64.0),
    ('<clipPath id="c"><path clip-rule="evenodd" d="M0 0H10V10H0zM2 2C2 2 8 2 8 2V8H2z"/></clipPath>', 64.0),
    ('<clipPath id="d"><rect width="2" height="9"/></clipPath><clipPath id="c" clip-path="url(#d)">'
     '<rect width="9" height="3"/></clipPath>', 6.0),
    ('<clipPath id="c"><rect x="-5" y="-5" width="99" height="99"/></clipPath>', 100.0),
]  # fmt: skip
MASKS = [
    ('id="c"><rect fill="white" width="5" height="10"/>', 50.0),
    ('id="c"><rect fill="#fff" width="10" height="10"/><rect width="5" height="5"/>', 75.0),
    ('id="c"><rect fill="black" width="9" height="9"/><rect fill="red" width="5" height="5"/>', 25.0),
    ('id="c" mask-type="alpha"><rect width="5" height="5"/>', 25.0),
    ('id="c" x="0" y="0" width=".5" height="1"><rect fill="white" width="99" height="99"/>', 50.0),
    ('id="c" maskContentUnits="objectBoundingBox"><rect fill="white" width=".5" height="1"/>', 50.0),
    ('id="c"><path stroke="white" stroke-width="2" d="M0 5H10"/>', 20.0),
    ('id="c"><linearGradient id="g"><stop offset=".5"/><stop offset=".5" stop-color="#fff"/></linearGradient>'
     '<rect width="10" height="10" fill="url(#g)"/>', 50.0),
]  # fmt: skip
FRAMED = SQUARE.replace("/>", ' stroke="red" stroke-width="2"/>')
NESTED = f'<svg x="1" y="1" width="4" height="2" viewBox="0 0 2 2" preserveAspectRatio="{{}}">{SQUARE}</svg>'
UNPAINTED = """<defs><rect width="100" height="100"/></defs><rect width="90" height="9" fill="none"/>
    <rect width="80" height="8" style="display: none"/><g visibility="hidden"><rect width="70" height="7"/></g>
    <clipPath><rect width="60" height="6"/></clipPath><rect width="50" height="5" class="ghost"/>
    <style>/* no paint */ .ghost, .other { fill: none; }</style><rect width="2" height="3"/>"""
LINES = '<g fill="none"{}><rect width="9" height="9"/><path d="M0 0 L50 50 L0 50"/></g>'
FAINT = '<g opacity="0.5"><rect width="2" height="1" fill-opacity="0.5"/></g><rect x="5" width="1" height="1"/>'
STYLED = (
    '<style>rect{{fill:none{}}}</style><rect width="3" height="1" style="fill:red"/><rect x="5" width="1" height="1"/>'
)
FIXED = line('vector-effect="non-scaling-stroke" stroke-width="3"', "M10 50H90")

AREAS = [
    *((f'{clip}<g clip-path="url(#c)">{SQUARE}</g>', area, {}) for clip, area in CLIPS),
    *((f'<mask {mask}</mask><g mask="url(#c)">{SQUARE}</g>', area, {}) for mask, area in MASKS),
    (f'<mask {MASKS[6][0]}</mask><g mask="url(#c)">{SQUARE}</g>', 20.0, {"strokes": False}),
    (FRAMED, 144.0, {}), (FRAMED, 100.0, {"strokes": False}), (FRAMED.replace(" s", ' fill="none" s', 1), 80.0, {}),
    (FIXED, 80.0 * 1.5, {"attributes": 'viewBox="0 0 100 100" width="200" height="200"'}),  # measured on the page
    (NESTED.format("xMidYMid"), 6.0, {}),  # two by two in the middle, and to its right
    (NESTED.format("none"), 8.0, {}), (NESTED.format("xMaxYMid"), 4.0, {}),
    (NESTED.replace("<svg ", '<svg overflow="visible" ').format("none"), 200.0, {}),
    (UNPAINTED, 6.0, {}),
    ('<g fill="none"><rect width="9" height="9"/><rect width="2" height="3" fill="red"/></g>', 6.0, {}),
    ('<g fill="none"><rect width="9" height="9" style="fill:unset"/><rect width="2" height="2" style="fill:initial"/>'
     '</g>', 4.0, {}),
    (LINES.format(""), 81.0, {}), (LINES.format(' stroke="black"'), 81.0, {"strokes": False}),
    (FAINT, 3.0, {}), (FAINT, 3.0, {"opacity": 0.2}), (FAINT, 1.0, {"opacity": 0.3}), (FAINT, None, {"opacity": 2.0}),
    (STYLED.format(""), 3.0, {}), (STYLED.format("!important;visibility:hidden"), None, {}),
    (f'<g fill="url(#none) red">{SQUARE}</g>', 100.0, {}), ('<path fill="url(#none)" d="M0 0H1V1"/>', None, {}),
    (f'<pattern id="p"/><g fill="url(#p)">{SQUARE}</g>', 100.0, {}),
]  # fmt: skip


@pytest.mark.parametrize(("body", "area", "options"), AREAS)
def test_documents_paint_what_browsers_paint(body: str, area: float | None, options: dict[str, Any]) -> None:
    if area is None:
        refusal(area_of, body, **options)
    else:
        assert area_of(body, **options) == pytest.approx(area)


MARKER = '<marker id="m" markerWidth="4" markerHeight="4"><rect width="4" height="2"/></marker>'
BLUR = '<filter id="f"><feGaussianBlur stdDeviation="1"/></filter>'


@pytest.mark.parametrize(
    ("body", "area", "notes"),
    [
        (f'{MARKER}<path d="M0 0V10H20Z" marker-end="url(#m)" marker-mid="url(#m)"/>', 100.0, 1),
        (f'{MARKER}<path d="M0 0V10H20Z" style="marker:url(#m)"/>', 100.0, 1),
        (f'{MARKER}<path d="M0 0V10H20Z" marker-end="url(#gone)"/>', 100.0, 0),
        (f'{BLUR}<g filter="url(#f)">{SQUARE}</g>', 100.0, 1),
        ('<rect filter="blur(2px)" width="10" height="10"/>', 100.0, 1),
        (f'{BLUR}<clipPath id="c"><rect filter="url(#f)" width="10" height="10"/></clipPath>'
         f'<g clip-path="url(#c)">{SQUARE}</g>', 100.0, 0),  # where filters change nothing
        (SQUARE.replace("/>", ' style="clip-path:circle(2px)"/>'), 100.0, 1),
        (f'{SQUARE}<text>A</text><text>B</text><image/><g display="none"><text>C</text></g>', 100.0, 1),
    ],
)  # fmt: skip
def test_what_cannot_be_painted_is_left_out_with_a_note(body: str, area: float, notes: int) -> None:
    found = svg_drawing(svg(body))
    assert (found.mesh.area, len(found.notes)) == (area, notes)
