"""What becomes of a call on hostile input, and grammars of documents that are nearly right."""

import json
import os
import signal
import warnings
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from copy import deepcopy
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
    "use": "href xlink:href x y width height", "svg": "x y width height", "image": "x y width height",
    "linearGradient": "x1 x2", "radialGradient": "r fx", "stop": "offset stop-opacity", "path": "d",
    "feGaussianBlur": "stdDeviation", "polygon": "points", "polyline": "points", "unknown": "", "style": "",
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
def steps(draw: Draw, needed: dict[str, int], form: str) -> str:
    """Commands in a form, with about the arguments that they need."""
    text = ""
    for name in draw(st.lists(one_of(sorted(needed)), max_size=8)):
        count = needed[name] * draw(one_of([1, 1, 1, 2])) - rarely(draw, 9)
        text += form.format(name, draw(one_of([" ", ","])).join(draw(numbers) for _ in range(count)))
    return text


needed = dict(zip("MLHVCSQTAZmlhvcsqtaz", 2 * (2, 2, 1, 1, 6, 4, 4, 2, 7, 0), strict=True))
paths = st.builds("{}{}{}".format, one_of(["M 0 0"] * 9 + [""]), steps(needed, "{}{}"), one_of(["", "Z", " x", "M"]))
needed = {"translate": 2, "scale": 1, "rotate": 3, "matrix": 6, "skewX": 1, "skewY": 1, "turn": 1}
transforms = st.one_of(*(steps(needed, form) for form in ("{}({})", "{}({}) ", "{}({}),", "{}({}")))
references = st.builds("{}{}".format, one_of(["#", "#", "", "x.svg#"]), names)
ATTRIBUTES = {
    "id": names, "class": names, "fill": paints, "stroke": paints, "stroke-width": lengths, "opacity": lengths,
    "stroke-linejoin": one_of(["miter", "round", "bevel", "arcs", ""]), "clip-path": paints, "mask": paints,
    "stroke-dasharray": st.lists(lengths, max_size=4).map(" ".join), "filter": paints, "marker-mid": paints,
    "fill-rule": one_of(["evenodd", "nonzero", "inherit", "odd"]), "display": one_of(["none", "inline", ""]),
    "transform": transforms, "viewBox": st.lists(numbers, min_size=3, max_size=5).map(" ".join),
    "preserveAspectRatio": one_of(["none", "xMidYMid slice", "defer", "x"]), "d": paths, "href": references,
    "style": st.lists(one_of(["fill:none", "fill:url(#b)", "stroke:red;", ";", ":", "a" * 50])).map(";".join),
    "points": st.lists(numbers, max_size=12).map(" ".join), "xlink:href": references,
}  # fmt: skip
"""Their values; those of others are lengths."""


@st.composite
def elements(draw: Draw, depth: int = 3, tag: str = "", inside: str = "", more: str = "") -> str:
    """One element with what is in it; of its own attributes most, and some that any has."""
    tag = tag or draw(one_of([*SHAPES, *(GROUPS if depth else [])]))
    if tag == "style":
        return f"<style>{draw(one_of(STYLES))}</style>"
    known = {name for name in SHAPES.get(tag, "").split() if draw(st.integers(0, 5))}
    known |= {*draw(st.lists(one_of(sorted(ATTRIBUTES)), max_size=4))}
    given = "".join(f' {name}="{draw(ATTRIBUTES.get(name, lengths))}"' for name in sorted(known))
    if tag in GROUPS and depth:
        inside += "".join(draw(st.lists(elements(depth - 1), max_size=3)))
    return f"<{tag}{more}{given}>{inside}</{tag}>"


@st.composite
def svg_texts(draw: Draw) -> bytes:
    """A document with a prolog."""
    space = draw(one_of([' xmlns="http://www.w3.org/2000/svg"'] * 8 + ["", ' xmlns="x"']))
    space += draw(one_of([' xmlns:xlink="http://www.w3.org/1999/xlink"'] * 8 + [""]))
    inside = draw(one_of(["", '<rect x="1" y="2" width="30" height="40"/>'] * 9 + ["&b;", "<"]))
    text = draw(one_of(PROLOGS)) + draw(elements(tag="svg", inside=inside, more=space))
    return text.encode(draw(one_of(["utf-8"] * 18 + ["utf-16", "latin-1"])), "replace")


# JSON: maps

small = st.integers(-9, 9)
rings = mostly(
    st.builds(lambda x, y, w, h: [[x, y], [x + w, y], [x + w, y + 1 + abs(w)], [x, y + h], [x, y]], *[small] * 4),
    st.lists(st.lists(small, min_size=2, max_size=2), max_size=9),
    9,
)
polygons = st.lists(rings, min_size=1, max_size=3)
geometries = st.recursive(
    st.builds(lambda inside: {"type": "Polygon", "coordinates": inside}, polygons)
    | st.builds(lambda inside: {"type": "MultiPolygon", "coordinates": inside}, st.lists(polygons, max_size=3))
    | st.builds(lambda kind: {"type": kind, "coordinates": [0, 0]}, one_of(["Point", "LineString", "Star"])),
    lambda inside: st.builds(lambda given: {"type": "GeometryCollection", "geometries": given}, st.lists(inside)),
    max_leaves=4,
)
features = st.builds(
    lambda a, x: {"type": "Feature", "geometry": a, "properties": {"name": x}, "id": x}, geometries, names
)
maps = st.builds(lambda a: {"type": "FeatureCollection", "features": a}, st.lists(features, max_size=3)) | geometries
scraps = st.one_of(
    st.none(), st.booleans(), small, st.floats(-10, 10), st.text(max_size=4),
    one_of([10**400, -(10**30), float("inf"), float("nan"), 1e300, 1e-310, "\ud800", "Polygon", [], {}, [[]], [[[]]]]),
)  # fmt: skip


@st.composite
def damaged(draw: Draw, documents: Any) -> Any:
    """A document with a few values, at any depth, left out or replaced by scraps; often untouched."""
    whole = [draw(documents)]
    for _ in range(draw(one_of([0, 0, 1, 1, 2, 4]))):
        node: Any = whole
        while node:
            key = draw(one_of(sorted(node) if isinstance(node, dict) else range(len(node))))
            if not isinstance(node[key], list | dict) or rarely(draw, 5):
                node[key] = deepcopy(draw(scraps))
                if rarely(draw, 3) and node is not whole:
                    del node[key]
                break
            node = node[key]
    return whole[0]


def as_json(documents: Any) -> Any:
    """Texts of JSON values, in some encoding."""
    encodings = one_of([*["utf-8"] * 12, "utf-8-sig", "utf-16", "latin-1"])
    return mutated(st.builds(lambda value, code: json.dumps(value).encode(code), damaged(documents), encodings))


# PNG, loops, and options of the command


@st.composite
def png_files(draw: Draw) -> bytes:
    """A small picture whose header, data and palette mostly belong together."""
    sides = mostly(st.integers(1, 9), one_of([0, 2**31 - 1, 2**16]), 29)
    width, height, interlaced = draw(sides), draw(sides), draw(one_of([*[0] * 8, 1, 2]))
    kinds = one_of([(8, 6), (8, 6), (16, 6), (8, 2), (1, 0), (4, 0), (2, 3), (8, 3), (8, 4), (16, 4)])
    depth, colour = draw(mostly(kinds, st.tuples(st.integers(0, 17), st.integers(0, 7)), 19))
    stride = (min(width, 20) * {2: 3, 4: 2, 6: 4}.get(colour, 1) * depth + 7) // 8
    line = st.builds(lambda kind, data: bytes([kind]) + data, one_of([*range(5), *range(5), 9]), st.binary(
        min_size=stride, max_size=stride))  # fmt: skip
    data = b"".join(draw(line) for _ in range(min(height * (2 if interlaced else 1), 12)))
    data += bytes(draw(one_of([0, 0, 1, 100, 10**6])))
    packed = zlib.compress(data[: draw(one_of([len(data)] * 14 + [len(data) // 2]))])
    cut = draw(st.integers(0, len(packed)))
    own = [(b"PLTE", draw(st.binary(max_size=30))), (b"tRNS", draw(st.binary(max_size=8)))]
    own += [(draw(st.binary(min_size=4, max_size=4)), b"x")]
    own = [chunk for chunk in own if draw(st.booleans())]
    chunks = [*own, (b"IDAT", packed[:cut]), (b"IDAT", packed[cut:]), (b"IEND", b"")]
    if rarely(draw, 9):
        chunks = draw(st.permutations(chunks))
    return png_header(width, height, depth, colour, interlaced) + b"".join(png_chunk(*each) for each in chunks)


coordinates = small | st.floats(-10, 10) | one_of(
    [0.0, -0.0, 1e-200, 1e-310, 5e-324, 1e-160, 1e-16, 1 + 2**-52, 1e16, 1e149, 1e150, 1e151, 1e308]
)  # fmt: skip
squares = st.builds(lambda x, y, a: [(x, y), (x + a, y), (x + a, y + a), (x, y + a)], *[coordinates] * 3)
loops = st.lists(
    st.lists(st.tuples(coordinates, coordinates), min_size=3, max_size=7)
    | st.builds(lambda a, k, x, y, end: [*a[:k], (x, y), *a[k:]][:end], squares, st.integers(0, 4), *[coordinates] * 2,
                st.integers(3, 5)),
    min_size=1, max_size=3,
)  # fmt: skip
"""Loops that are often valid: squares with one more corner."""

DOCUMENTS = {
    ".svg": mutated(svg_texts()),
    ".geojson": as_json(maps),
    ".json": as_json(maps),
    ".png": mutated(png_files()),
}
"""Documents by the ending of their files."""


@st.composite
def commands(draw: Draw) -> tuple[str, bytes, list[str]]:
    """The ending and content of a file, and the options after its name."""
    ending = draw(one_of(sorted(DOCUMENTS)))
    values = mostly(one_of(["12", "6", "3", "40"]), numbers, 6)
    options = ["--levels", *draw(st.lists(values, min_size=1, max_size=2))]
    for name in ("--clearance", "--tolerance", "--threshold", "--element"):
        options += [name, draw(values)] if rarely(draw, 5) else []
    options += [name for name in ("--flip-y", "--quiet", "--no-strokes") if rarely(draw, 3)]
    return ending, draw(DOCUMENTS[ending]), options
