"""Grammars (hypothesis strategies) of documents that are nearly right: most rules are kept, some are broken."""

from __future__ import annotations

import json
import struct
import zlib
from typing import Any

from hypothesis import strategies as st

from .damage import Draw, coordinates, mostly, mutated, numbers, rarely
from .svg_grammar import svg_documents

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
