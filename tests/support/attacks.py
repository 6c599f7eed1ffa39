"""Attacks that are known, by the door they knock at: each a name and calls, all of which must be held."""

import json
import struct
import zlib
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from nestedcages_core import Mesh, features_from_geojson, from_geojson, from_svg, read_png
from support.documents import png_chunk, png_header, svg

Calls = Iterator[Callable[[], Any]]
SQUARE = '<rect width="9" height="9"/>'
TRIANGLE = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]
LINE = '<path fill="none" stroke="red" d="{1}" {0}/>'


def drawings(*bodies: str, tolerance: float | None = None, prolog: str = "") -> Calls:
    """Read drawings."""
    for body in bodies:
        yield partial(from_svg, prolog + svg(body), tolerance=tolerance)


def maps(*documents: Any) -> Calls:
    """Read documents of JSON by all that read such."""
    for document in documents:
        text = document if isinstance(document, str | bytes) else json.dumps(document)
        for read in (from_geojson, features_from_geojson):
            yield partial(read, text)


def json_attacks() -> Calls:
    """Deep and endless nests."""
    nest: Any = {"type": "Polygon", "coordinates": [TRIANGLE]}
    for _ in range(200):
        nest = {"type": "GeometryCollection", "geometries": [nest]}
    yield from maps("[" * 100_000, '{"type":' * 5_000, "null", '"x"', nest, {"features": 1}, b"\xff\xfe\x00")


def svg_numbers() -> Calls:
    """Numbers that no drawing has, everywhere in a drawing."""
    for number in ("1e999", "1e308", "-1e308", "1e-320", "nan", "9" * 5000, "1e" + "9" * 50, "", "٣", "." * 1000):
        for body in (
            '<rect width="{0}" height="1"/>',
            *(f'<rect width="2" height="3" transform="{name}"/>' for name in (
                "rotate({0})", "matrix({0} 0 0 {0} 0 0)", "skewX({0})", "translate({0})", "scale({0} 1)")),
            '<rect width="2" height="3" rx="{0}"/>',
            '<circle r="{0}"/>',
            *(f'<path d="M0 0 {data} L 9 0 Z"/>' for data in (
                "A {0} 1 0 0 1 5 5", "A 1 {0} {0} 1 1 5 5", "A 5 9 0 0 1 {0} 9", "C {0} 1 2 3 4 5", "L 1 1 L {0} 0")),
            *(f'<path d="M0 0 L 1 1 2 0" stroke="red" stroke-{name}="{{0}}"/>' for name in (
                "width", "dasharray", "miterlimit", "dashoffset")),
            '<svg viewBox="0 0 {0} 1"><rect width="1" height="1"/></svg>',
            '<svg width="{0}" height="{0}"><rect width="50%" height="50%"/></svg>',
            '<radialGradient id="g" r="{0}" fx="{0}"><stop stop-opacity="0"/><stop offset="1"/></radialGradient>'
            '<rect fill="url(#g)" width="5" height="5"/>',
            '<symbol id="s" viewBox="0 0 {0} 1e-300"><rect width="1" height="1"/></symbol>'
            '<use href="#s" width="{0}" height="1e300"/>',
        ):  # fmt: skip
            yield from drawings(body.format(number))
    for tolerance in (1e-320, 5e-324, 1e-30, 0.0, -1.0, float("nan"), float("inf"), 1e300, "1", [1]):
        yield from drawings('<circle r="1"/>', tolerance=tolerance)  # type: ignore[arg-type]
    yield from drawings(LINE.format('stroke-miterlimit="1e308"', "M0 0L10 0L0 1e-9"))


def svg_bombs() -> Calls:
    """Small drawings that grow: elements used over and over, entities, deep nests, long style sheets and paths."""
    for width, depth in ((10, 9), (2, 40), (100, 5)):
        levels = ['<rect id="u0" width="1" height="1"/>']
        levels += [f'<g id="u{k}">' + f'<use href="#u{k - 1}" x="1"/>' * width + "</g>" for k in range(1, depth)]
        yield from drawings("<defs>" + "".join(levels) + f'</defs><use href="#u{depth - 1}"/>')
    yield from drawings(
        '<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/></g>', '<use id="a" href="#a"/>',
        '<clipPath id="a" clip-path="url(#a)"><use href="#a"/></clipPath><rect clip-path="url(#a)"/>',
        f'<mask id="m"><g mask="url(#m)">{SQUARE}</g></mask><g mask="url(#m)">{SQUARE}</g>',
        f'<linearGradient id="g" href="#g"/><g fill="url(#g)">{SQUARE}</g>',
        *("<g>" * depth + SQUARE + "</g>" * depth for depth in (500, 100_000)),
        *(f"<style>{sheet}</style>{SQUARE}" for sheet in (
            "a" * 200_000, "{" * 200_000, "/*" * 100_000, "a," * 100_000 + "{}", ":not(" * 50_000, "[a=" * 60_000,
            "@media all{" * 3000, ":not(" * 3000 + "a" + ")" * 3000 + "{fill:red}")),
        f"<style>{'rect{fill:red}' * 10_000}</style>{SQUARE * 100}",
        f"<style>{'g ' * 50}rect.x{{fill:red}}</style>{'<g>' * 55}{SQUARE}{'</g>' * 55}",
        *(f'<rect width="9" height="9" {name}/>' for name in (
            f'style="{"a:" * 100_000}"', f'style="{"/*" * 100_000}"', f'transform="{"(" * 100_000}"',
            f'transform="{"translate(1)" * 20_000}"')),
        *(f'<path d="M0 0{data} L 9 0 9 9 Z"/>' for data in (" " * 200_000 + "x", "1" * 200_000)),
        f'<path d="M0 0A{"1 1 0 0 1 2 1 " * 80_000}"/>', '<path d="M0 0h1v1z"/>' * 110_000,
        SQUARE + LINE.format('stroke-dasharray="1e-6"', "M0 0 L 1e9 0"),
    )  # fmt: skip
    yield from drawings('<circle r="1e9"/>', '<path d="M0 0 A 1e9 1e-9 0 0 1 1 1 L 9 0 Z"/>', tolerance=1e-9)
    entities = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 12))
    yield from drawings("<text>&e11;</text>", prolog=f'<!DOCTYPE svg [<!ENTITY e0 "ha">{entities}]>')
    yield from drawings("&x;", prolog='<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]>')


def crossings() -> Calls:
    """Small outlines that cross themselves or each other hundreds of thousands of times."""
    for corners in (101, 501, 5_001):
        angles = 2.0 * np.pi * (corners // 2) * np.arange(corners) / corners
        points = np.round(1000.0 * np.stack((np.cos(angles), np.sin(angles)), axis=1), 6).tolist()
        data = "M" + " ".join(f"{x} {y}" for x, y in points) + "Z"
        for style in ("fill-rule:evenodd", "fill:none;stroke:red", "stroke:red;stroke-dasharray:9"):
            yield from drawings(f'<path style="{style}" d="{data}"/>')
        for many in (1, 3):
            yield from maps({"type": "MultiPolygon", "coordinates": [[[*points, points[0]]]] * many})
        yield partial(Mesh.from_loops, [points])
    for bars in (70, 2_000):
        across = "".join(f'<rect x="{3 * k}" y="-1" width="1" height="{3 * bars}"/>' for k in range(bars))
        along = "".join(f'<rect y="{3 * k}" x="-1" height="1" width="{3 * bars}"/>' for k in range(bars))
        yield from drawings(
            across + along,
            f'<clipPath id="c">{across}</clipPath><g clip-path="url(#c)">{along}</g>',
            '<mask id="m" maskUnits="userSpaceOnUse" x="-9" y="-9" width="9999" height="9999">'
            f'<g fill="white">{across}</g></mask><g mask="url(#m)">{along}</g>',
        )
    back_and_forth = "M0 0" + "".join(f"H{k}H{k / 2}" for k in range(1, 20_000)) + "V1Z"
    yield from drawings(f'<path d="{back_and_forth}"/>', LINE.format("", back_and_forth))


def encodings() -> Calls:
    """Bytes in encodings that are unknown, or not those announced."""
    plain = svg('<circle r="1"/>')
    for code in ("no-such", "utf-16", "utf-32", "utf-7", "idna", "punycode", "undefined", "zlib", "rot13", "gbk"):
        announced = f'<?xml version="1.0" encoding="{code}"?>{plain}'
        yield from (partial(from_svg, announced), partial(from_svg, announced.encode()))
    for data in (b"", b"\x00", b"\xff\xfe", b"\xff" * 100, plain.encode("utf-16"), plain.encode("utf-32"), b"<svg",
                 plain.replace("circle", "circle id='\ud800'"), plain.replace("r=", "x\x00=")):  # fmt: skip
        yield partial(from_svg, data)


def png_bombs(path: Path) -> Calls:
    """Small files whose data unpack to far more than the picture has."""

    def picture(data: bytes) -> Any:
        path.write_bytes(data)
        return read_png(path)

    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    block = packer.compress(bytes(2**24)) + packer.flush(zlib.Z_FULL_FLUSH)  # 150 times 16 MB
    packed = b"\x78\xda" + 150 * block + packer.flush() + struct.pack(">I", ((150 * 2**24 % 65521) << 16) + 1)
    for *size, data in (
        (1, 1, packed), (2**31 - 1, 2**31 - 1, b""), (2**16, 2**12, packed[:1000]), (2**14, 2**14, zlib.compress(b"x")),
        (1, 2**28, 1, 0, zlib.compress(b"x")), (2**28, 1, 1, 0, 1, zlib.compress(b"x")),
    ):  # fmt: skip
        yield partial(picture, png_header(*size) + png_chunk(b"IDAT", data) + png_chunk(b"IEND", b""))
    begins = b"\x89PNG\r\n\x1a\n"
    for content in (begins + struct.pack(">I4s", 2**31 - 1, b"IHDR"), begins + png_chunk(b"abcd", b"") * 100_000):
        yield partial(picture, content)


ATTACKS = {each.__name__: each for each in (json_attacks, svg_numbers, svg_bombs, crossings, encodings)}
"""By their names; those on pictures need a file."""
