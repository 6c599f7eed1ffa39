"""What becomes of a call on hostile input, and grammars of documents that are nearly right."""

from __future__ import annotations

import json
import os
import signal
import warnings
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from nestedcages_core import NestedCagesError
from support.documents import png_chunk, png_header

SECONDS, MEGABYTES = 20.0, 700
"""Processor time and memory that a call may take."""

LONGEST_SENTENCE = 1500
"""Characters of a message: it may quote an input's name, but not the whole input."""


class TooSlowError(BaseException):
    """Raised where a call has taken too long; no `except Exception` catches it."""


def outcome(call: Callable[[], Any]) -> Any:
    """The result of a call, or its NestedCagesError; anything else, and more time or memory, is a failure."""
    try:
        with limits(), warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            return call()
    except NestedCagesError as error:
        assert error.code and 0 < len(str(error)) <= LONGEST_SENTENCE
        return error
    except TooSlowError:
        raise AssertionError(f"took more than {SECONDS:g} s") from None
    except MemoryError:
        raise AssertionError(f"asked for more than {MEGABYTES} MB") from None


@contextmanager
def limits() -> Iterator[None]:
    """Bounds on time and, on Linux, memory."""
    if os.name != "posix":
        yield
        return
    import resource

    def too_slow(*_: Any) -> None:
        raise TooSlowError

    statistics = Path("/proc/self/statm")
    before, (soft, hard) = signal.signal(signal.SIGPROF, too_slow), resource.getrlimit(resource.RLIMIT_AS)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    if statistics.exists():
        pages = int(statistics.read_text(encoding="ascii").split()[0])
        limit = pages * os.sysconf("SC_PAGE_SIZE") + MEGABYTES * 2**20
        resource.setrlimit(resource.RLIMIT_AS, (limit if hard == resource.RLIM_INFINITY else min(limit, hard), hard))
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


# Grammars: most rules are kept, some are broken

Draw = Any
one_of = st.sampled_from


def rarely(draw: Draw, odds: int) -> bool:
    """About once in so many times and one; zero and the largest number are drawn more often than others."""
    return bool(draw(st.integers(0, odds)) == odds // 2)


@st.composite
def mostly(draw: Draw, often: Any, seldom: Any, odds: int) -> Any:
    """The second strategy once in so many times and one."""
    return draw(seldom if rarely(draw, odds) else often)


EXTREME = [
    "1e999", "-1e999", "1e308", "1e-320", "5e-324", "nan", "inf", "-0", "", "-", ".", "1e", "0x10", "1_0", "٣", "--1",
    "1e99999999999", "9" * 400, "0." + "0" * 400 + "1", "1,5", "½",
]  # fmt: skip
"""Numbers that readers trip over, and texts that are none."""

numbers = mostly(st.integers(-20, 20).map(str) | st.floats(-100, 100).map(lambda x: f"{x:.6g}"), one_of(EXTREME), 20)
coordinates = st.one_of(
    st.integers(-20, 20),
    st.floats(-10, 10),
    one_of([0.0, -0.0, 1e-200, 1e-310, 5e-324, 1e-160, 1e-16, 1 + 2**-52, 1e16, 1e149, 1e150, 1e151, 1e308]),
)


@st.composite
def mutated(draw: Draw, documents: Any) -> bytes:
    """A document with a few bytes replaced, removed or repeated, or its end cut off; often untouched."""
    data = bytearray(draw(documents))
    for _ in range(draw(one_of([0] * 9 + [1, 2, 5]))):
        if data:
            place, length = draw(st.integers(0, len(data) - 1)), draw(st.integers(1, 8))
            how = draw(st.integers(0, 3))
            new = [draw(st.binary(max_size=8)), b"", 2 * data[place : place + 20 * length], b""][how]
            data[place : [place + length, place + length, place, len(data)][how]] = new
    return bytes(data)


# SVG

names = one_of(["a", "b", "c", "ü", "", "none"])
paints = one_of(
    ["none", "black", "#fff", "#12", "url(#a)", "url(#b) none", "url(#", "currentColor", "inherit", "rgb(1,2,3)",
     "rgb(", "rgba(0,0,0,0)", "hsl(1e999 0% 0%)", "transparent", "context-fill", "var(--x)"]
)  # fmt: skip
lengths = st.builds(lambda x, unit: x + unit, numbers, one_of(["", "", "px", "%", "em", "cm", "rem", "q", " "]))
SHAPES = {
    "rect": "x y width height rx ry", "circle": "cx cy r", "ellipse": "cx cy rx ry", "line": "x1 y1 x2 y2",
    "use": "x y width height", "svg": "x y width height", "image": "x y width height", "linearGradient": "x1 x2",
    "radialGradient": "r fx", "stop": "offset stop-opacity", "feGaussianBlur": "stdDeviation", "path": "",
    "polygon": "", "polyline": "", "unknown": "", "style": "",
}  # fmt: skip
GROUPS = ["g", "svg", "defs", "symbol", "clipPath", "mask", "pattern", "marker", "switch", "a", "text", "filter"]
STYLES = [
    "path { fill: none }", "#a, .b > g rect:hover { fill: red; }", "{", "}", "@media print { * { fill: none } }", "/*",
    "* { fill: url(#a) }", ":not(:not(*)) { display: none }", "a" * 300, '"', "[x='", "@import url(x);", "* {" * 20,
]  # fmt: skip
PROLOGS = [
    *[""] * 20, '<?xml version="1.0"?>', '<?xml version="1.0" encoding="utf-16"?>', '<?xml version="9"?>', "\ufeff",
    '<?xml version="1.0" encoding="no-such"?>', '<!DOCTYPE svg [<!ENTITY a "aaa"><!ENTITY b "&a;&a;">]>', "<!-- -- -->",
    '<!DOCTYPE svg SYSTEM "file:///etc/passwd">',
]  # fmt: skip


@st.composite
def path_data(draw: Draw) -> str:
    """Commands with about the arguments that they need."""
    needed = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
    parts = ["M 0 0"] if draw(st.integers(0, 9)) else []
    for _ in range(draw(st.integers(0, 8))):
        command = draw(one_of(sorted(needed)))
        count = needed[command] * draw(st.integers(1, 2)) - rarely(draw, 9)
        given = [draw(numbers) for _ in range(max(count, 0))]
        parts.append(draw(one_of([command, command.lower()])) + draw(one_of([" ", ","])).join(given))
    return draw(one_of(["", " "])).join(parts) + draw(one_of(["", "Z", "z", " x", "M"]))


@st.composite
def transforms(draw: Draw) -> str:
    """Functions with about the arguments that they need."""
    needed = {"translate": 2, "scale": 1, "rotate": 3, "matrix": 6, "skewX": 1, "skewY": 1, "turn": 1}
    text = ""
    for name in draw(st.lists(one_of(sorted(needed)), min_size=1, max_size=3)):
        given = [draw(numbers) for _ in range(needed[name] - rarely(draw, 9))]
        text += f"{name}({' '.join(given)}{draw(one_of([')', ') ', '),', '']))}"
    return text


COMMON = {
    "id": names, "class": names, "fill": paints, "stroke": paints, "stroke-width": lengths, "opacity": lengths,
    "stroke-linejoin": one_of(["miter", "round", "bevel", "arcs", ""]), "clip-path": paints, "mask": paints,
    "stroke-dasharray": st.lists(lengths, max_size=4).map(" ".join), "filter": paints, "marker-mid": paints,
    "fill-rule": one_of(["evenodd", "nonzero", "inherit", "odd"]), "display": one_of(["none", "inline", ""]),
    "transform": transforms(), "viewBox": st.lists(numbers, min_size=3, max_size=5).map(" ".join),
    "preserveAspectRatio": one_of(["none", "xMidYMid slice", "defer", "x"]),
    "style": st.lists(one_of(["fill:none", "fill:url(#b)", "stroke:red;", ";", ":", "a" * 50])).map(";".join),
}  # fmt: skip


@st.composite
def attributes(draw: Draw, tag: str) -> str:
    """Those of an element, its own and common ones."""
    text = "".join(f' {name}="{draw(lengths)}"' for name in SHAPES.get(tag, "").split() if draw(st.integers(0, 5)))
    if tag == "path":
        text += f' d="{draw(path_data())}"'
    if tag in ("polygon", "polyline"):
        text += f' points="{" ".join(draw(st.lists(numbers, max_size=12)))}"'
    if tag == "use":
        name, place = draw(one_of(["href", "xlink:href"])), draw(one_of(["#", "", "x.svg#"]))
        text += f' {name}="{place}{draw(names)}"'
    for name in draw(st.lists(one_of(sorted(COMMON)), max_size=4, unique=True)):
        text += f' {name}="{draw(COMMON[name])}"'
    return text


@st.composite
def elements(draw: Draw, depth: int = 3) -> str:
    """One element with what is in it."""
    tag = draw(one_of([*SHAPES, *(GROUPS if depth else [])]))
    if tag == "style":
        return f"<style>{draw(one_of(STYLES))}</style>"
    inside = "".join(draw(st.lists(elements(depth - 1), max_size=3))) if tag in GROUPS and depth else ""
    return f"<{tag}{draw(attributes(tag))}>{inside}</{tag}>"


@st.composite
def svg_texts(draw: Draw) -> bytes:
    """A document with a prolog."""
    space = draw(one_of([' xmlns="http://www.w3.org/2000/svg"'] * 8 + ["", ' xmlns="x"']))
    space += draw(one_of([' xmlns:xlink="http://www.w3.org/1999/xlink"'] * 8 + [""]))
    body = "".join(draw(st.lists(elements(), min_size=1, max_size=4)))
    body += draw(one_of(["", '<rect x="1" y="2" width="30" height="40"/>']))
    end = draw(one_of([""] * 18 + ["&b;", "<"]))
    text = f"{draw(one_of(PROLOGS))}<svg{space}{draw(attributes('svg'))}>{body}{end}</svg>"
    return text.encode(draw(one_of(["utf-8"] * 18 + ["utf-16", "latin-1"])), "replace")


# JSON: maps and collision outlines

json_numbers = st.one_of(
    st.integers(-20, 20),
    st.floats(-10, 10),
    one_of([10**400, -(10**30), float("inf"), float("nan"), 1e300, 1e-310]),
)
scraps = st.one_of(
    st.none(), st.booleans(), json_numbers, st.text(max_size=4), one_of(["\ud800", "Polygon", [], {}, [[]], [[[]]]])
)
points = mostly(st.lists(st.integers(-5, 5), min_size=2, max_size=2), st.lists(json_numbers | scraps, max_size=4), 15)


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
    kinds = ["Polygon"] * 8 + ["MultiPolygon"] * 4 + ["Point", "LineString", "Star"]
    kind = draw(one_of(kinds + ["GeometryCollection"] * (depth > 0)))
    if rarely(draw, 19):
        return draw(scraps)
    if kind == "GeometryCollection":
        return {"type": kind, "geometries": draw(st.lists(geometries(depth - 1), max_size=3) | scraps)}
    polygon = st.lists(rings(), max_size=3)
    inside = {"Polygon": polygon, "MultiPolygon": st.lists(polygon, max_size=3)}.get(kind, points)
    found = {"type": kind, "coordinates": draw(mostly(inside, scraps, 19))}
    return {"type": kind} if rarely(draw, 19) else found


@st.composite
def maps(draw: Draw) -> Any:
    """A map, a feature or a geometry alone."""
    features = []
    for _ in range(draw(st.integers(0, 3))):
        known = draw(st.none() | st.just({"name": "a"}) | scraps | st.builds(lambda name: {"name": name}, scraps))
        features.append({"type": "Feature", "geometry": draw(geometries()), "properties": known, "id": draw(scraps)})
    whole = {"type": "FeatureCollection", "features": draw(one_of([*[features] * 12, None, {}, "x", [1]]))}
    return draw(one_of([whole, whole, features[0] if features else whole, draw(geometries()), draw(scraps)]))


@st.composite
def outlines(draw: Draw) -> Any:
    """A collision outline for game engines."""
    parts = [
        {"outer": draw(rings()), "holes": draw(mostly(st.lists(rings(), max_size=1), scraps, 9))}
        for _ in range(draw(st.integers(0, 3)))
    ]
    document = {
        "format": draw(one_of(["nested-cages outline"] * 20 + ["other", None, 7])),
        "version": draw(one_of([*[1] * 30, 0, 999, "1", None, 1.5, 10**400])),
        "polygons": draw(one_of([*[parts] * 20, None, {}, "x", [[]]])),
    }
    if rarely(draw, 3):
        del document[draw(one_of(sorted(document)))]
    return document


def as_json(documents: Any) -> Any:
    """Texts of JSON values, in some encoding."""
    encodings = one_of([*["utf-8"] * 12, "utf-8-sig", "utf-16", "latin-1"])
    return mutated(st.builds(lambda value, code: json.dumps(value).encode(code), documents, encodings))


# PNG, loops, and options of the command


@st.composite
def png_files(draw: Draw) -> bytes:
    """A small picture whose header, data and palette mostly belong together."""
    width, height = draw(st.integers(1, 9)), draw(st.integers(1, 9))
    if rarely(draw, 19):
        width, height = (draw(one_of([1, 8, 0, 2**31 - 1, 2**16])) for _ in range(2))
    kinds = [(8, 6), (8, 6), (16, 6), (8, 2), (1, 0), (4, 0), (2, 3), (8, 3), (8, 4), (16, 4)]
    depth, colour = draw(mostly(one_of(kinds), st.tuples(st.integers(0, 17), st.integers(0, 7)), 19))
    interlaced = draw(one_of([*[0] * 8, 1, 2]))
    stride = (min(width, 20) * {2: 3, 4: 2, 6: 4}.get(colour, 1) * depth + 7) // 8
    rows = min(min(height, 20) * (2 if interlaced == 1 else 1), 12)
    line = st.binary(min_size=stride, max_size=stride)
    data = b"".join(bytes([draw(one_of([*[*range(5)] * 4, 9]))]) + draw(line) for _ in range(rows))
    data += bytes(draw(one_of([0, 0, 1, 100, 10**6])))
    packed = zlib.compress(data[: draw(one_of([len(data)] * 14 + [len(data) // 2]))])
    cut = draw(st.integers(0, len(packed)))
    parts = [png_header(width, height, depth, colour, interlaced)[8:]]
    if colour == 3 or rarely(draw, 4):
        parts.append(png_chunk(b"PLTE", draw(st.binary(max_size=30))))
    if draw(st.booleans()):
        parts.append(png_chunk(b"tRNS", draw(st.binary(max_size=8))))
    parts += [png_chunk(b"IDAT", packed[:cut]), png_chunk(b"IDAT", packed[cut:])]
    if rarely(draw, 4):
        parts.append(png_chunk(draw(st.binary(min_size=4, max_size=4)), draw(st.binary(max_size=8))))
    parts.append(png_chunk(b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(draw(st.permutations(parts)) if rarely(draw, 9) else parts)


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


DOCUMENTS = {
    ".svg": mutated(svg_texts()),
    ".geojson": as_json(maps()),
    ".json": as_json(outlines()),
    ".png": mutated(png_files()),
}
"""Documents by the ending of their files."""


@st.composite
def commands(draw: Draw) -> tuple[str, bytes, list[str]]:
    """The ending and content of a file, and the options after its name."""
    ending = draw(one_of(sorted(DOCUMENTS)))
    values = st.one_of(*[one_of(["12", "6", "3", "40"])] * 6, numbers)
    options = ["--levels", *draw(st.lists(values, min_size=1, max_size=2))]
    for name in ("--clearance", "--tolerance", "--threshold", "--element"):
        if rarely(draw, 5):
            options += [name, draw(values)]
    options += [name for name in ("--flip-y", "--quiet", "--no-strokes") if rarely(draw, 3)]
    return ending, draw(DOCUMENTS[ending]), options
