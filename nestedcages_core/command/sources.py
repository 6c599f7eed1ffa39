"""Input files of all kinds as shapes, with the notes of their readers."""

from __future__ import annotations

import glob
import os
import re
import sys
from argparse import Namespace
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from ..errors import NestedCagesError, invalid_file
from ..formats import DRAWING_LIMITS, Frame, Limits, map_document, read_map, read_whole, svg_drawing
from ..formats.lonlat import may_be_degrees, system_name
from ..formats.pictures import decode_png
from ..geometry.arrays import AnyArray, FloatArray
from ..geometry.mesh import Mesh
from ..levels import Level
from .options import STREAM, Metres, kind_of

DOWN = {"y": "down"}
"""The `pixels` member for coordinates of a drawing or a picture, as `to_geojson` writes it."""

BEGINNINGS = {b"\x89PNG": "picture", b"<": "drawing", b"{": "map"}
"""The content of a stream by its first bytes."""


class Shape(NamedTuple):
    """The shape to enclose: a mesh, or a picture whose opaque pixels become one."""

    name: str
    content: Mesh | AnyArray
    properties: Mapping[str, Any] = {}
    id: str | int | float | None = None
    given: Sequence[FloatArray] = ()
    """Rings of a map as they were read."""
    drawn: Mesh | None = None
    """What is drawn, where the content is grown by a clearance in metres."""


class Made(NamedTuple):
    """The cages of one shape, from the finest to the coarsest."""

    shape: Shape
    fine: Mesh
    levels: Sequence[Level]


class Source(NamedTuple):
    """A file that was read, and what was made of it."""

    path: str
    kind: str
    """One of `KINDS`."""
    shapes: Sequence[Shape] = ()
    notes: Sequence[str] = ()
    """Sentences about repairs and omissions."""
    failures: Sequence[str] = ()
    """Sentences about shapes that could not be read, or have not all of their cages, and files not written."""
    crs: Any = None
    frame: Frame | None = None
    """Page of a drawing or a picture, for SVG output."""
    pixels: Mapping[str, Any] | None = None
    """How coordinates lie on a picture, as `to_geojson` writes it; None for maps."""
    made: Sequence[Made] = ()
    written: Sequence[str] = ()

    @property
    def y_up(self) -> bool:
        """Whether y points up: in maps, and in pixels that say so."""
        return self.pixels is None or self.pixels.get("y") == "up"


def matching_files(patterns: Sequence[str]) -> list[str]:
    """The files that match patterns such as `icons/*.svg`; what no file matches stays as it is."""
    found = list[str]()
    for pattern in patterns:
        matches = [] if os.path.lexists(pattern) else sorted(filter(kind_of, glob.glob(pattern, recursive=True)))
        found += matches or [pattern]
    return list(dict.fromkeys(found))


def limits_of(given: Namespace, default: Limits | None = None) -> Limits:
    """The limits that the options say."""
    return replace(default or Limits(), **dict(given.limits))


def read(path: str, given: Namespace) -> Source:
    """The shapes of a file, grown where a clearance is in metres. Raises NestedCagesError or OSError."""
    limits, kind = limits_of(given), kind_of(path)
    data: Any
    if path == STREAM:
        data, kind = _streamed(limits)
    else:
        data = map_document(path, limits, given.layers) if kind == "map" else read_whole(path, limits)
    if kind == "map":
        source = _map(path, data, limits, given.inside)
        return _on_ground(source, given) if isinstance(given.clearance, Metres) else source
    if isinstance(given.clearance, Metres):
        raise invalid_file("A clearance in m, km or mi is for a map; give it in units of the file.")
    if kind == "drawing":
        drawing = svg_drawing(
            data,
            **{name: getattr(given, name) for name in ("tolerance", "element", "inside")},
            layers=tuple(given.layers or ()),
            strokes=not given.no_strokes,
            crop=not given.no_crop,
            limits=limits_of(given, DRAWING_LIMITS),
        )
        return Source(path, kind, [Shape("drawing", drawing.mesh)], drawing.notes, frame=drawing.frame, pixels=DOWN)
    if given.inside:
        raise invalid_file("Cages inside are for drawings and maps; leave out --inside, or the picture.")
    picture = decode_png(data, limits=limits)
    height, width = picture.shape[:2]
    opaque = "No pixel is fully transparent, so the whole picture may count as opaque."
    return Source(
        path,
        "picture",
        [Shape("drawing", picture)],
        [opaque] if picture[:, :, 3].min() > 0 else [],
        frame=Frame((0.0, 0.0, float(width), float(height)), str(width), str(height)),
        pixels={**DOWN, "width": width, "height": height},
    )


def _map(path: str, data: Any, limits: Limits, inside: bool) -> Source:
    found = read_map(data, limits, inside=inside)
    if not found.features and not found.refused:
        raise invalid_file("There are no polygons; give a map with Polygon or MultiPolygon features.")
    without = [f"Features without polygons: {found.without_polygons}."] if found.without_polygons else []
    shapes = [Shape(each.name, each.mesh, each.properties, each.id, each.given) for each in found.features]
    return Source(path, "map", shapes, [*found.notes, *without], found.refused, found.crs, pixels=found.pixels)


def _on_ground(source: Source, given: Namespace) -> Source:
    """A map whose shapes, if in degrees, are grown by a clearance on the ground, or shrunk for cages inside."""
    if not may_be_degrees(source.crs):
        name = system_name(source.crs) or ""
        if re.search(r"\bft|foot|feet|degree", name, re.IGNORECASE):
            raise invalid_file(f"The map's system, {name:.60}, is not in metres; give the clearance in its units.")
        note = f"The clearance is taken in units of the map's system, {name:.60}, as metres."
        return source._replace(notes=[*source.notes, note])
    from ..formats.ground import grown_on_ground  # needs shapely

    shapes, failures = list[Shape](), list(source.failures)
    for shape in source.shapes:
        try:
            drawn, grown = grown_on_ground(Mesh.of(shape.content), given.clearance, inside=given.inside)
            shapes.append(shape._replace(content=grown, drawn=drawn))
        except NestedCagesError as error:
            failures.append(f"{shape.name}: {error}")
    return source._replace(shapes=shapes, failures=failures)


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
