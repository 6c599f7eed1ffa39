"""Attacks that are known, by the door they knock at: each a name and calls, all of which must be held."""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from nestedcages_core import (
    Mesh,
    OnCurve,
    OuterHull,
    Settings,
    features_from_geojson,
    from_engine_json,
    from_geojson,
    from_svg,
    nested_cages,
    verify,
)
from nestedcages_core.exchange.pictures.png import decode_png

from .grammars import chunk

Calls = Iterator[Callable[[], Any]]
PIXELS = b"\x89PNG\r\n\x1a\n"
TRIANGLE = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]


def svg(body: str, head: str = 'xmlns="http://www.w3.org/2000/svg"', prolog: str = "") -> bytes:
    """A document around elements."""
    return f"{prolog}<svg {head}>{body}</svg>".encode()


def tiny_distances() -> Calls:
    """Loops whose vertices are as near as float64 can tell apart, and cages around them."""
    for small in (1e-200, 1e-310, 5e-324, 1e-160, 1e-100):
        loop = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, small)]
        yield lambda loop=loop: Mesh.from_loops([loop])
        for count in (3, 4):
            yield lambda loop=loop, count=count: nested_cages(Mesh.from_loops([loop]), [count])
    for large in (1e100, 1e149, 1e150, 1e155, 1e308):
        loop = [(0.0, 0.0), (large, 0.0), (large, large), (0.5 * large, 1.0), (0.0, large)]
        yield lambda loop=loop: nested_cages(Mesh.from_loops([loop]), [3])
    small = [(1.0, 1.0), (1.0, 2.0), (2.0, 1.0)]
    around = [(0.0, 1.0), (0.0, 0.0), (1e149, 0.0), (1e149, 1e149), (0.0, 1e149)]
    for hull in (OuterHull(), OnCurve()):
        yield lambda hull=hull: nested_cages(Mesh.from_loops([small, around]), [6], Settings(decimation=hull))


def wrong_types() -> Calls:
    """Python values of the wrong type at the public functions."""
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    plain = (None, 7, "x", b"x", {}, object(), np.zeros(3))
    for wrong in (*plain, [None], [[None]], [["a", "b"]] * 3, [[10**400, 0]] * 3):
        yield partial(Mesh.from_loops, wrong)
        yield lambda wrong=wrong: Mesh(wrong, [[0, 1], [1, 2], [2, 0]])
        yield lambda wrong=wrong: Mesh(square, wrong)
        yield partial(Mesh.from_geometry, wrong)
        yield lambda wrong=wrong: nested_cages(Mesh.from_loops([square]), wrong)
        yield lambda wrong=wrong: nested_cages(wrong, [3])
        yield lambda wrong=wrong: nested_cages(Mesh.from_loops([square]), [3], wrong) if wrong is not None else None
        yield lambda wrong=wrong: Settings(clearance=wrong)
        yield lambda wrong=wrong: Settings(contact=wrong)
        yield lambda wrong=wrong: verify(wrong, Mesh.from_loops([square]))
        yield partial(from_svg, wrong)
        yield partial(from_geojson, wrong)
        yield partial(from_engine_json, wrong)


def json_numbers() -> Calls:
    """Coordinates that are no numbers, or too large ones, in maps and collision outlines."""
    for wrong in ("1", None, [1], {"x": 1}, 10**400, float("inf"), float("nan"), True, "\ud800"):
        for place in (0, 1):
            ring = [list(point) for point in TRIANGLE]
            ring[1][place] = wrong  # type: ignore[call-overload]
            polygon = json.dumps({"type": "Polygon", "coordinates": [ring]})
            outline = {"format": "nested-cages outline", "version": 1, "polygons": [{"outer": ring[:-1], "holes": []}]}
            yield partial(from_geojson, polygon)
            yield partial(features_from_geojson, polygon)
            yield partial(from_engine_json, json.dumps(outline))


def json_shapes() -> Calls:
    """Ragged, deep and misplaced lists and objects."""
    for coordinates in (None, 1, [], [[]], [[[]]], {}, [TRIANGLE, 1], [[[0, 0], [1], [1, 1], [0, 0]]], [{}], ["abc"]):
        for kind in ("Polygon", "MultiPolygon"):
            text = json.dumps({"type": kind, "coordinates": coordinates})
            yield partial(from_geojson, text)
            yield partial(features_from_geojson, text)
    for text in ("[" * 100_000, '{"type":' * 5_000, "", "null", "[]", '"x"', "{}", '{"type": null}', b"\xff\xfe\x00"):
        yield partial(from_geojson, text)
        yield partial(features_from_geojson, text)
        yield partial(from_engine_json, text)
    nest: Any = {"type": "Polygon", "coordinates": [TRIANGLE]}
    for _ in range(200):
        nest = {"type": "GeometryCollection", "geometries": [nest]}
    yield lambda: from_geojson(json.dumps(nest))
    for features in (None, 1, {}, [None], [1], [{"type": "Feature"}], [{"type": "Feature", "geometry": 7}]):
        text = json.dumps({"type": "FeatureCollection", "features": features})
        yield partial(from_geojson, text)
        yield partial(features_from_geojson, text)


def foreign_outlines() -> Calls:
    """Collision outlines of other versions and formats."""
    part = {"outer": TRIANGLE[:-1], "holes": []}
    for change in (
        {"version": 999},
        {"version": "x"},
        {"format": "other"},
        {"polygons": [part, part]},
        {"polygons": []},
    ):
        document = {"format": "nested-cages outline", "version": 1, "polygons": [part], **change}
        yield partial(must_be_an_error, from_engine_json, json.dumps(document))
    outside = {"outer": TRIANGLE[:-1], "holes": [[[5, 5], [6, 5], [5, 6]]]}
    document = {"format": "nested-cages outline", "version": 1, "polygons": [outside]}
    yield lambda: must_be_an_error(from_engine_json, json.dumps(document))


def must_be_an_error(read: Callable[[Any], Any], given: Any) -> None:
    """What a reader must not accept."""
    found = read(given)
    raise AssertionError(f"accepted as {found!r}")


def svg_numbers() -> Calls:
    """Numbers that no drawing has, everywhere in a drawing."""
    for number in ("1e999", "1e308", "-1e308", "1e-320", "nan", "9" * 5000, "1e" + "9" * 50, "", "٣", "." * 1000):
        for body in (
            '<rect width="{0}" height="1"/>',
            '<rect width="2" height="3" transform="rotate({0})"/>',
            '<rect width="2" height="3" transform="matrix({0} 0 0 {0} 0 0)"/>',
            '<rect width="2" height="3" transform="skewX({0})"/>',
            '<rect width="2" height="3" rx="{0}"/>',
            '<circle r="{0}"/>',
            '<path d="M0 0 A {0} 1 0 0 1 5 5 L 9 0 Z"/>',
            '<path d="M0 0 A 1 {0} {0} 1 1 5 5 L 9 0 Z"/>',
            '<path d="M0 0 C {0} 1 2 3 4 5 L 9 0 Z"/>',
            '<path d="M0 0 L 1 1 L {0} 0 Z"/>',
            '<path d="M0 0 L 1 1 2 0" stroke="black" stroke-width="{0}"/>',
            '<path d="M0 0 L 1 1 2 0" stroke="black" stroke-dasharray="{0}"/>',
            '<svg viewBox="0 0 {0} 1"><rect width="1" height="1"/></svg>',
            '<svg width="{0}" height="{0}"><rect width="50%" height="50%"/></svg>',
        ):
            text = svg(body.format(number))
            yield partial(from_svg, text)
    for tolerance in (1e-320, 5e-324, 1e-30, 0.0, -1.0, float("nan"), float("inf"), 1e300, "1", None, [1]):
        yield lambda tolerance=tolerance: from_svg(svg('<circle r="1"/>'), tolerance=tolerance)


def svg_bombs() -> Calls:
    """Small drawings that grow: elements used over and over, entities, deep nests, long style sheets."""
    for width, depth in ((10, 9), (2, 40), (100, 5)):
        levels = ['<rect id="u0" width="1" height="1"/>']
        for k in range(1, depth):
            levels.append(f'<g id="u{k}">' + f'<use href="#u{k - 1}" x="1"/>' * width + "</g>")
        yield partial(from_svg, svg("<defs>" + "".join(levels) + f'</defs><use href="#u{depth - 1}"/>'))
    yield lambda: from_svg(svg('<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/></g>'))
    yield lambda: from_svg(svg('<use id="a" href="#a"/>'))
    yield lambda: from_svg(
        svg('<clipPath id="a" clip-path="url(#a)"><use href="#a"/></clipPath><rect clip-path="url(#a)"/>')
    )
    for depth in (500, 5_000, 100_000):
        yield partial(from_svg, svg("<g>" * depth + '<circle r="1"/>' + "</g>" * depth))
    entities = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 12))
    laughs = svg("<text>&e11;</text>", prolog=f'<!DOCTYPE svg [<!ENTITY e0 "ha">{entities}]>')
    yield lambda: from_svg(laughs)
    square = '<rect width="9" height="9"/>'
    for sheet in (
        "a" * 200_000,
        "{" * 200_000,
        "/*" * 100_000,
        "a," * 100_000 + "{}",
        ":not(" * 50_000,
        "[a=" * 60_000,
    ):
        yield partial(from_svg, svg(f"<style>{sheet}</style>{square}"))
    yield lambda: from_svg(svg(f"<style>{'rect{fill:red}' * 10_000}</style>{square * 100}"))
    yield lambda: from_svg(svg(f'<rect style="{"a:" * 100_000}" width="9" height="9"/>'))
    yield lambda: from_svg(svg(f'<rect transform="{"(" * 100_000}" width="9" height="9"/>'))
    yield lambda: from_svg(svg(f'<rect transform="{"translate(1)" * 20_000}" width="9" height="9"/>'))
    yield lambda: from_svg(svg(f'<path d="M0 0{" " * 200_000}x L 9 0 9 9 Z"/>'))
    yield lambda: from_svg(svg(f'<path d="M0 0{"1" * 200_000} L 9 0 9 9 Z"/>'))
    yield lambda: from_svg(svg('<path d="M0 0 A 1e9 1e-9 0 0 1 1 1 L 9 0 Z"/>'), tolerance=1e-12)
    yield lambda: from_svg(svg('<circle r="1e9"/>'), tolerance=1e-9)
    dashes = '<path d="M0 0 L 1e9 0" fill="none" stroke="red" stroke-dasharray="1e-6"/>'
    yield lambda: from_svg(svg(square + dashes))


def star_polygon(corners: int) -> list[tuple[float, float]]:
    """Every edge crosses nearly every other one."""
    angles = 2.0 * np.pi * (corners // 2) * np.arange(corners) / corners
    return np.round(1000.0 * np.stack((np.cos(angles), np.sin(angles)), axis=1), 6).tolist()


def crossings() -> Calls:
    """Small outlines that cross themselves or each other hundreds of thousands of times."""
    for corners in (101, 501, 5_001):
        points = star_polygon(corners)
        data = "M" + " ".join(f"{x} {y}" for x, y in points) + "Z"
        for style in (
            "fill-rule:evenodd",
            "fill-rule:nonzero",
            "fill:none;stroke:red",
            "stroke:red;stroke-dasharray:9",
        ):
            yield partial(from_svg, svg(f'<path style="{style}" d="{data}"/>'))
        for many in (1, 3):
            polygons = [[[*points, points[0]]]] * many
            text = json.dumps({"type": "MultiPolygon", "coordinates": polygons})
            yield partial(from_geojson, text)
            yield partial(features_from_geojson, text)
        yield partial(Mesh.from_loops, [points])
    for bars in (70, 2_000):
        across = "".join(f'<rect x="{3 * k}" y="-1" width="1" height="{3 * bars}"/>' for k in range(bars))
        along = "".join(f'<rect y="{3 * k}" x="-1" height="1" width="{3 * bars}"/>' for k in range(bars))
        yield partial(from_svg, svg(across + along))
        yield partial(from_svg, svg(f'<clipPath id="c">{across}</clipPath><g clip-path="url(#c)">{along}</g>'))
        yield partial(from_svg, svg(f'<mask id="m" maskUnits="userSpaceOnUse" x="-9" y="-9" width="9999" height="9999">'
                                    f'<g fill="white">{across}</g></mask><g mask="url(#m)">{along}</g>'))  # fmt: skip
    back_and_forth = "M0 0" + "".join(f"H{k}H{k / 2}" for k in range(1, 20_000)) + "V1Z"
    for paint in ("", 'fill="none" stroke="red"'):
        yield partial(from_svg, svg(f'<path {paint} d="{back_and_forth}"/>'))


def svg_lengths() -> Calls:
    """Long paths, whose points are counted while they are read."""
    arcs = "M0 0" + "".join(f"a1 1 0 0 1 {k % 7} {k * k % 5 + 1}" for k in range(200_000)) + "Z"
    yield partial(must_be_an_error, from_svg, svg(f'<path d="{arcs}"/>'))
    yield partial(must_be_an_error, from_svg, svg(f'<path d="M0 0{"h1v1" * 600_000}Z"/>'))
    yield partial(must_be_an_error, from_svg, svg(f'<polygon points="{"1 2 3 4 " * 600_000}"/>'))
    yield partial(must_be_an_error, from_svg, svg('<path d="M0 0h1v1z"/>' * 110_000))


def svg_encodings() -> Calls:
    """Bytes in encodings that are unknown, or not those announced."""
    plain = '<svg xmlns="http://www.w3.org/2000/svg"><circle r="1"/></svg>'
    for code in (
        "no-such",
        "utf-16",
        "utf-32",
        "utf-7",
        "idna",
        "punycode",
        "undefined",
        "zlib",
        "rot13",
        "unicode_escape",
    ):
        announced = f'<?xml version="1.0" encoding="{code}"?>{plain}'
        yield partial(from_svg, announced)
        yield partial(from_svg, announced.encode())
    for data in (
        b"",
        b"\x00",
        b"\xff\xfe",
        b"\xff" * 100,
        plain.encode("utf-16"),
        plain.encode("utf-32"),
        b"<svg",
        b"<" * 99,
    ):
        yield partial(from_svg, data)
    yield lambda: from_svg(plain.replace("circle", "circle id='\ud800'"))
    yield lambda: from_svg(plain.replace("r=", "x\x00="))
    yield lambda: from_svg(svg("&x;", prolog='<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]>'))


def png_bombs() -> Calls:
    """Small files whose data unpack to far more than the picture has."""

    def picture(width: int, height: int, packed: bytes, depth: int = 8, colour: int = 6, interlaced: int = 0) -> bytes:
        header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, interlaced))
        return PIXELS + header + chunk(b"IDAT", packed) + chunk(b"IEND", b"")

    blocks = 150  # of 16 MB
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    block = packer.compress(bytes(2**24)) + packer.flush(zlib.Z_FULL_FLUSH)
    check = struct.pack(">I", ((blocks * 2**24 % 65521) << 16) + 1)
    packed = b"\x78\xda" + blocks * block + packer.flush() + check
    yield lambda: decode_png(picture(1, 1, packed))
    yield lambda: decode_png(picture(2**31 - 1, 2**31 - 1, b""))
    yield lambda: decode_png(picture(2**16, 2**12, packed[:1000]))
    yield lambda: decode_png(picture(2**14, 2**14, zlib.compress(b"x")))
    yield lambda: decode_png(picture(1, 2**28, zlib.compress(b"x"), 1, 0))
    yield lambda: decode_png(picture(2**28, 1, zlib.compress(b"x"), 1, 0, 1))
    yield lambda: decode_png(PIXELS + struct.pack(">I4s", 2**31 - 1, b"IHDR"))
    yield lambda: decode_png(PIXELS + chunk(b"abcd", b"") * 100_000)
    yield lambda: decode_png(b"")


ATTACKS: dict[str, Callable[[], Calls]] = {
    "loops at the limits of float64": tiny_distances,
    "Python values of wrong types": wrong_types,
    "JSON: coordinates that are no numbers": json_numbers,
    "JSON: ragged, deep, misplaced lists": json_shapes,
    "collision outlines of foreign formats": foreign_outlines,
    "SVG: extreme and broken numbers": svg_numbers,
    "SVG: bombs of uses, entities, nests, style sheets": svg_bombs,
    "SVG: encodings": svg_encodings,
    "SVG: paths of a million points": svg_lengths,
    "SVG and JSON: crossings by the hundred thousand": crossings,
    "PNG: bombs and broken headers": png_bombs,
}
"""Attack and the calls that carry it out."""
