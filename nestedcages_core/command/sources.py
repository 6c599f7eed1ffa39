"""Input files of all kinds as shapes, with the notes of their readers."""

from __future__ import annotations

import glob
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..errors import invalid_file
from ..formats import (
    Frame,
    Limits,
    map_document,
    read_map,
    read_whole,
    svg_drawing,
)
from ..formats.pictures import decode_png
from ..geometry.arrays import AnyArray, FloatArray
from ..geometry.mesh import Mesh
from .options import STREAM, kind_of

DOWN = {"y": "down"}
"""The `pixels` member for coordinates of a drawing or a picture, as `to_geojson` writes it."""

BEGINNINGS = {b"\x89PNG": "picture", b"<": "drawing", b"{": "map"}
"""The content of a stream by its first bytes."""


@dataclass(frozen=True, eq=False)
class NamedShape:
    """The shape to enclose: a mesh, or a picture whose opaque pixels become one."""

    name: str
    content: Mesh | AnyArray
    properties: Mapping[str, Any] = field(default_factory=dict)
    id: str | int | float | None = None
    drawn: Mesh | None = None
    """What is drawn, where the content is grown by a clearance in metres."""
    metres: float | None = None
    given: Sequence[FloatArray] = ()
    """Rings of a map as they were read."""


@dataclass(frozen=True, eq=False)
class Source:
    """A file that was read."""

    path: str
    kind: str
    """One of `KINDS`."""
    shapes: Sequence[NamedShape] = ()
    notes: Sequence[str] = ()
    """Sentences about repairs and omissions."""
    failures: Sequence[str] = ()
    """Sentences about shapes that could not be read."""
    crs: Any = None
    frame: Frame | None = None
    """Page of a drawing or a picture, for SVG output."""
    pixels: Mapping[str, Any] | None = None
    """How coordinates lie on a picture, as `to_geojson` writes it; None for maps."""


def matching_files(patterns: Sequence[str]) -> list[str]:
    """The files that match names and patterns such as `icons/*.svg`. Raises NestedCagesError for one without any."""
    found: list[str] = []
    for pattern in patterns:
        if pattern == STREAM or not glob.has_magic(pattern) or Path(pattern).exists():
            found.append(pattern)
            continue
        matches = sorted(path for path in glob.glob(pattern, recursive=True) if kind_of(path))
        if not matches:
            raise invalid_file(f"{pattern}: no file that can be read has such a name.")
        found.extend(matches)
    return list(dict.fromkeys(found))


def is_up(pixels: Mapping[str, Any] | None) -> bool:
    """Whether y points up: in maps, and in pixels that say so."""
    return pixels is None or pixels.get("y") == "up"


def read(path: str, limits: Limits, options: Mapping[str, Any]) -> Source:
    """The shapes of a file; options: those of drawings. Raises NestedCagesError or OSError."""
    data: Any
    kind: str | None
    if path == STREAM:
        data, kind = _streamed(limits)
    else:
        kind = kind_of(path)
        data = map_document(path, limits, options.get("layers")) if kind == "map" else read_whole(path, limits)
    if kind == "picture":
        picture = decode_png(data, limits=limits)
        opaque = ("No pixel is fully transparent, so the whole picture may count as opaque.",)
        height, width = picture.shape[:2]
        frame = Frame((0.0, 0.0, float(width), float(height)), str(width), str(height))
        pixels = {**DOWN, "width": width, "height": height}
        whole = picture[:, :, 3].min() > 0
        return Source(path, kind, [NamedShape("drawing", picture)], opaque if whole else (), frame=frame, pixels=pixels)
    if kind == "drawing":
        drawing = svg_drawing(data, **options)
        shapes = [NamedShape("drawing", drawing.mesh)]
        return Source(path, kind, shapes, drawing.notes, frame=drawing.frame, pixels=DOWN)
    found = read_map(data, limits, inside=options.get("inside", False))
    if not found.features and not found.refused:
        raise invalid_file("There are no polygons; give a map with Polygon or MultiPolygon features.")
    notes = [f"{note[0].upper()}{note[1:]}" for note in found.notes]
    if found.without_polygons:
        notes.append(f"Features without polygons, left out: {found.without_polygons}.")
    notes.append(
        "The coordinates are those of a picture."
        if found.pixels is not None
        else "The map names no coordinate reference system; coordinates are kept as they are."
        if found.crs is None
        else "The map's coordinate reference system is kept."
    )
    shapes = [NamedShape(each.name, each.mesh, each.properties, each.id, given=each.given) for each in found.features]
    return Source(path, "map", shapes, notes, found.refused, found.crs, pixels=found.pixels)


def _streamed(limits: Limits) -> tuple[bytes, str]:
    """The standard input and its kind by the first bytes. Raises NestedCagesError."""
    if sys.stdin is None or sys.stdin.closed:
        raise invalid_file("The standard input is closed; name a file.")
    data = sys.stdin.buffer.read(limits.bytes + 1)
    limits.check("bytes", len(data))
    for start, kind in BEGINNINGS.items():
        if data[:64].lstrip(b"\xef\xbb\xbf \t\r\n").startswith(start):
            return data, kind
    raise invalid_file("The standard input is neither SVG, GeoJSON nor PNG.")
