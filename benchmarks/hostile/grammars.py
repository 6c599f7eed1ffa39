"""Grammars (hypothesis strategies) of documents that are nearly right: most rules are kept, some are broken."""

from __future__ import annotations

import json
import struct
import zlib
from typing import Any

from hypothesis import strategies as st

Draw = Any

# Numbers

EXTREME = [
    "1e999", "-1e999", "1e308", "1e-320", "5e-324", "nan", "inf", "-0", "", "-", ".", "1e", "0x10", "1_0", "٣", "--1",
    "1e99999999999", "9" * 400, "0." + "0" * 400 + "1", "1,5", "½",
]  # fmt: skip
"""Numbers that readers trip over, and texts that are none."""


def rarely(draw: Draw, odds: int) -> bool:
    """About once in so many times and one; zero and the largest number are drawn more often than others."""
    return bool(draw(st.integers(0, odds)) == odds // 2)


@st.composite
def mostly(draw: Draw, often: st.SearchStrategy[Any], seldom: st.SearchStrategy[Any], odds: int) -> Any:
    """The second strategy once in so many times and one."""
    return draw(seldom if rarely(draw, odds) else often)


plain_numbers = st.one_of(st.integers(-20, 20).map(str), st.floats(-100, 100).map(lambda x: f"{x:.6g}"))
numbers = mostly(plain_numbers, st.sampled_from(EXTREME), 20)
coordinates = st.one_of(
    st.integers(-20, 20),
    st.floats(-10, 10),
    st.sampled_from([0.0, -0.0, 1e-200, 1e-310, 5e-324, 1e-160, 1e-16, 1 + 2**-52, 1e16, 1e149, 1e150, 1e151, 1e308]),
)


@st.composite
def mutated(draw: Draw, documents: st.SearchStrategy[bytes]) -> bytes:
    """A document with a few bytes replaced, removed or repeated, or its end cut off; often untouched."""
    data = bytearray(draw(documents))
    for _ in range(draw(st.sampled_from([0] * 9 + [1, 2, 5]))):
        if not data:
            break
        place, length = draw(st.integers(0, len(data) - 1)), draw(st.integers(1, 8))
        how = draw(st.integers(0, 3))
        if how == 0:
            data[place : place + length] = draw(st.binary(max_size=8))
        elif how == 1:
            del data[place : place + length]
        elif how == 2:
            data[place:place] = data[place : place + 20 * length]
        else:
            del data[place:]
    return bytes(data)


# SVG

lengths = st.builds(
    lambda x, unit: x + unit, numbers, st.sampled_from(["", "", "px", "%", "em", "cm", "rem", "q", " "])
)
names = st.sampled_from(["a", "b", "c", "ü", "", "none"])
paints = st.one_of(
    st.sampled_from(["none", "black", "#fff", "#12", "url(#a)", "url(#b) none", "url(#", "currentColor", "inherit"]),
    st.sampled_from(
        ["rgb(1,2,3)", "rgba(0,0,0,0)", "rgb(", "hsl(1e999 0% 0%)", "transparent", "context-fill", "var(--x)"]
    ),
)


@st.composite
def path_data(draw: Draw) -> str:
    """Commands with about the arguments that they need."""
    needed = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
    parts = ["M 0 0"] if draw(st.integers(0, 9)) else []
    for _ in range(draw(st.integers(0, 8))):
        command = draw(st.sampled_from(sorted(needed)))
        count = needed[command] * draw(st.integers(1, 2)) - (rarely(draw, 9))
        given = [draw(numbers) for _ in range(max(count, 0))]
        parts.append(draw(st.sampled_from([command, command.lower()])) + draw(st.sampled_from([" ", ","])).join(given))
    return draw(st.sampled_from(["", " "])).join(parts) + draw(st.sampled_from(["", "Z", "z", " x", "M"]))


@st.composite
def transforms(draw: Draw) -> str:
    """Functions with about the arguments that they need."""
    needed = {"translate": 2, "scale": 1, "rotate": 3, "matrix": 6, "skewX": 1, "skewY": 1, "turn": 1}
    text = ""
    for _ in range(draw(st.integers(1, 3))):
        name = draw(st.sampled_from(sorted(needed)))
        given = [draw(numbers) for _ in range(needed[name] - (rarely(draw, 9)))]
        text += f"{name}({' '.join(given)}{draw(st.sampled_from([')', ') ', '),', '']))}"
    return text


SHAPES = {
    "rect": ("x", "y", "width", "height", "rx", "ry"),
    "circle": ("cx", "cy", "r"),
    "ellipse": ("cx", "cy", "rx", "ry"),
    "line": ("x1", "y1", "x2", "y2"),
    "use": ("x", "y", "width", "height"),
    "svg": ("x", "y", "width", "height"),
    "image": ("x", "y", "width", "height"),
    "linearGradient": ("x1", "x2"),
    "stop": ("offset", "stop-opacity"),
}
GROUPS = (
    "g",
    "svg",
    "defs",
    "symbol",
    "clipPath",
    "mask",
    "pattern",
    "marker",
    "switch",
    "a",
    "text",
    "linearGradient",
)
STYLES = [
    "path { fill: none }", "#a, .b > g rect:hover { fill: red; }", "{", "}", "@media print { * { fill: none } }", "/*",
    "* { fill: url(#a) }", ":not(:not(*)) { display: none }", "a" * 300, '"', "[x='", "@import url(x);", "* {" * 20,
]  # fmt: skip


@st.composite
def attributes(draw: Draw, tag: str) -> str:
    """Those of an element, its own and common ones."""
    text = "".join(f' {name}="{draw(lengths)}"' for name in SHAPES.get(tag, ()) if draw(st.integers(0, 5)))
    if tag == "path":
        text += f' d="{draw(path_data())}"'
    if tag in ("polygon", "polyline"):
        text += f' points="{" ".join(draw(st.lists(numbers, max_size=12)))}"'
    if tag == "use":
        name, place = draw(st.sampled_from(["href", "xlink:href"])), draw(st.sampled_from(["#", "", "x.svg#"]))
        text += f' {name}="{place}{draw(names)}"'
    common = {
        "id": names,
        "class": names,
        "fill": paints,
        "stroke": paints,
        "stroke-width": lengths,
        "stroke-linejoin": st.sampled_from(["miter", "round", "bevel", "arcs", ""]),
        "stroke-dasharray": st.lists(lengths, max_size=4).map(" ".join),
        "fill-rule": st.sampled_from(["evenodd", "nonzero", "inherit", "odd"]),
        "clip-path": paints,
        "mask": paints,
        "marker-mid": paints,
        "opacity": lengths,
        "display": st.sampled_from(["none", "inline", ""]),
        "transform": transforms(),
        "viewBox": st.lists(numbers, min_size=3, max_size=5).map(" ".join),
        "preserveAspectRatio": st.sampled_from(["none", "xMidYMid slice", "defer", "x"]),
        "style": st.lists(
            st.sampled_from(["fill:none", "fill:url(#b)", "stroke:red;", ";", ":", "a" * 50]), max_size=4
        ).map(";".join),
    }
    for name in draw(st.lists(st.sampled_from(sorted(common)), max_size=4, unique=True)):
        text += f' {name}="{draw(common[name])}"'
    return text


@st.composite
def elements(draw: Draw, depth: int = 3) -> str:
    """One element with what is in it."""
    leaves = (
        "path",
        "rect",
        "circle",
        "ellipse",
        "line",
        "polygon",
        "polyline",
        "use",
        "image",
        "stop",
        "unknown",
        "style",
    )
    tag = draw(st.sampled_from(leaves + (GROUPS if depth else ())))
    if tag == "style":
        return f"<style>{draw(st.sampled_from(STYLES))}</style>"
    inside = "".join(draw(st.lists(elements(depth - 1), max_size=3))) if tag in GROUPS and depth else ""
    return f"<{tag}{draw(attributes(tag))}>{inside}</{tag}>"


PROLOGS = [
    *[""] * 20, '<?xml version="1.0"?>', '<?xml version="1.0" encoding="utf-16"?>', '<?xml version="9"?>', "\ufeff",
    '<?xml version="1.0" encoding="no-such"?>', '<!DOCTYPE svg [<!ENTITY a "aaa"><!ENTITY b "&a;&a;">]>', "<!-- -- -->",
    '<!DOCTYPE svg SYSTEM "file:///etc/passwd">',
]  # fmt: skip


@st.composite
def svg_texts(draw: Draw) -> bytes:
    """A document with a prolog."""
    prolog = draw(st.sampled_from(PROLOGS))
    space = draw(st.sampled_from([' xmlns="http://www.w3.org/2000/svg"'] * 8 + ["", ' xmlns="x"']))
    space += draw(st.sampled_from([' xmlns:xlink="http://www.w3.org/1999/xlink"'] * 8 + [""]))
    body = "".join(draw(st.lists(elements(), min_size=1, max_size=4)))
    if draw(st.booleans()):
        body += '<rect x="1" y="2" width="30" height="40"/>'
    text = f"{prolog}<svg{space}{draw(attributes('svg'))}>{body}{draw(st.sampled_from([''] * 18 + ['&b;', '<']))}</svg>"
    return text.encode(draw(st.sampled_from(["utf-8"] * 18 + ["utf-16", "latin-1"])), "replace")


svg_documents = mutated(svg_texts())

# JSON: maps and collision outlines

json_numbers = st.one_of(
    st.integers(-20, 20),
    st.floats(-10, 10),
    st.sampled_from([10**400, -(10**30), float("inf"), float("nan"), 1e300, 1e-310]),
)
scraps = st.one_of(
    st.none(),
    st.booleans(),
    json_numbers,
    st.text(max_size=4),
    st.sampled_from(["\ud800", "Polygon", [], {}, [[]], [[[]]]]),
)
points = mostly(
    st.lists(st.integers(-5, 5), min_size=2, max_size=2), st.lists(st.one_of(json_numbers, scraps), max_size=4), 15
)


@st.composite
def rings(draw: Draw) -> Any:
    """A ring, mostly simple and closed; sometimes something else."""
    if rarely(draw, 29):
        return draw(scraps)
    if rarely(draw, 9):
        ring = draw(st.lists(points, max_size=9))
    else:
        x, y, size = (draw(st.integers(-9, 9)) for _ in range(3))
        ring = [[x, y], [x + size, y], [x + size, y + 1 + abs(size)], [x, y + draw(st.integers(1, 9))]]
        if rarely(draw, 9):
            ring[draw(st.integers(0, 3))] = draw(points)
    return ring if rarely(draw, 9) or not ring else [*ring, ring[0]]


@st.composite
def geometries(draw: Draw, depth: int = 2) -> Any:
    """A geometry; sometimes of a type without an inside or with the wrong nesting."""
    kind = draw(
        st.sampled_from(
            ["Polygon"] * 8
            + ["MultiPolygon"] * 4
            + ["Point", "LineString", "Star"]
            + ["GeometryCollection"] * (depth > 0)
        )
    )
    if rarely(draw, 19):
        return draw(scraps)
    if kind == "GeometryCollection":
        return {"type": kind, "geometries": draw(st.one_of(st.lists(geometries(depth - 1), max_size=3), scraps))}
    polygon = st.lists(rings(), max_size=3)
    inside = {"Polygon": polygon, "MultiPolygon": st.lists(polygon, max_size=3)}.get(kind, points)
    found = {"type": kind, "coordinates": draw(mostly(inside, scraps, 19))}
    return {"type": kind} if rarely(draw, 19) else found


@st.composite
def maps(draw: Draw) -> Any:
    """A map, a feature or a geometry alone."""

    def feature() -> Any:
        made = {
            "type": "Feature",
            "geometry": draw(geometries()),
            "properties": draw(st.one_of(st.none(), st.just({"name": "a"}), scraps)),
        }
        if draw(st.booleans()):
            made["id"] = draw(scraps)
            made["properties"] = {"name": draw(scraps)}
        return made

    if rarely(draw, 19):
        return draw(scraps)
    kind = draw(st.integers(0, 4))
    if kind == 1:
        return draw(geometries())
    if kind == 2:
        return feature()
    members = [feature() for _ in range(draw(st.integers(0, 3)))]
    return {
        "type": "FeatureCollection",
        "features": draw(st.sampled_from([*[members] * 12, None, {}, "x", [1]])),
    }


@st.composite
def outlines(draw: Draw) -> Any:
    """A collision outline for game engines."""
    parts = [
        {"outer": draw(rings()), "holes": draw(mostly(st.lists(rings(), max_size=1), scraps, 9))}
        for _ in range(draw(st.integers(0, 3)))
    ]
    document = {
        "format": draw(st.sampled_from(["nested-cages outline"] * 20 + ["other", None, 7])),
        "version": draw(st.sampled_from([*[1] * 30, 0, 999, "1", None, 1.5, 10**400])),
        "polygons": draw(st.sampled_from([*[parts] * 20, None, {}, "x", [[]]])),
    }
    for name in draw(st.lists(st.sampled_from(sorted(document)), max_size=1)):
        if rarely(draw, 3):
            del document[name]
    return document


def as_json(documents: st.SearchStrategy[Any]) -> st.SearchStrategy[bytes]:
    """Texts of JSON values, in some encoding."""
    encodings = st.sampled_from([*["utf-8"] * 12, "utf-8-sig", "utf-16", "latin-1"])
    return mutated(st.builds(lambda value, code: json.dumps(value).encode(code), documents, encodings))


geojson_documents = as_json(maps())
engine_documents = as_json(outlines())

# PNG


def chunk(kind: bytes, content: bytes) -> bytes:
    """One part of a PNG with its right check sum."""
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


@st.composite
def png_files(draw: Draw) -> bytes:
    """A small picture whose header, data and palette mostly belong together."""
    width, height = (draw(st.sampled_from([1, 2, 3, 7, 8, 9, 0, 2**31 - 1, 2**16])) for _ in range(2))
    if not rarely(draw, 19):
        width, height = draw(st.integers(1, 9)), draw(st.integers(1, 9))
    depth, colour = draw(
        st.sampled_from([(8, 6), (8, 6), (16, 6), (8, 2), (1, 0), (4, 0), (2, 3), (8, 3), (8, 4), (16, 4)])
    )
    if rarely(draw, 19):
        depth, colour = draw(st.integers(0, 17)), draw(st.integers(0, 7))
    interlaced = draw(st.sampled_from([*[0] * 8, 1, 2]))
    channels = {2: 3, 4: 2, 6: 4}.get(colour, 1)
    stride = (min(width, 20) * channels * depth + 7) // 8
    rows = min(height, 20) * (2 if interlaced == 1 else 1)
    data = b"".join(
        bytes([draw(st.sampled_from([*range(5), *range(5), *range(5), *range(5), 9]))])
        + draw(st.binary(min_size=stride, max_size=stride))
        for _ in range(min(rows, 12))
    )
    data += bytes(draw(st.sampled_from([0, 0, 1, 100, 10**6])))
    packed = zlib.compress(data[: draw(st.sampled_from([len(data)] * 14 + [len(data) // 2]))])
    parts = [chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, interlaced))]
    if colour == 3 or rarely(draw, 4):
        parts.append(chunk(b"PLTE", draw(st.binary(max_size=30))))
    if draw(st.booleans()):
        parts.append(chunk(b"tRNS", draw(st.binary(max_size=8))))
    cut = draw(st.integers(0, len(packed)))
    parts += [chunk(b"IDAT", packed[:cut]), chunk(b"IDAT", packed[cut:])]
    if rarely(draw, 4):
        parts.append(chunk(draw(st.binary(min_size=4, max_size=4)), draw(st.binary(max_size=8))))
    parts.append(chunk(b"IEND", b""))
    if rarely(draw, 9):
        parts = draw(st.permutations(parts))
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


png_documents = mutated(png_files())

# Loops


@st.composite
def loops(draw: Draw) -> list[list[tuple[float, float]]]:
    """Loops that are often valid: polygons around centres, some coordinates replaced by extreme ones."""
    found = []
    for _ in range(draw(st.integers(1, 3))):
        if draw(st.booleans()):
            found.append(draw(st.lists(st.tuples(coordinates, coordinates), min_size=3, max_size=7)))
            continue
        x, y, size = draw(coordinates), draw(coordinates), draw(coordinates)
        square = [(x, y), (x + size, y), (x + size, y + size), (x, y + size)]
        square.insert(draw(st.integers(0, 4)), (draw(coordinates), draw(coordinates)))
        found.append(square[: draw(st.integers(3, 5))])
    return found


# Options of the command


@st.composite
def commands(draw: Draw) -> tuple[str, bytes, list[str]]:
    """The ending and content of a file, and the options after its name."""
    ending, documents = draw(
        st.sampled_from(
            [
                (".svg", svg_documents),
                (".geojson", geojson_documents),
                (".json", engine_documents),
                (".png", png_documents),
            ]
        )
    )
    values = st.one_of(*[st.sampled_from(["12", "6", "3", "40"])] * 6, numbers)
    options = ["--levels", *draw(st.lists(values, min_size=1, max_size=2))]
    for name in ("--clearance", "--tolerance", "--padding", "--threshold", "--element"):
        if rarely(draw, 5):
            options += [name, draw(values)]
    for name in ("--holes", "--flip-y", "--triangles", "--quiet"):
        if rarely(draw, 3):
            options.append(name)
    return ending, draw(documents), options
