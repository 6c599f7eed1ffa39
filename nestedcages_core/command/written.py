"""Results as this program writes them, and drawings as cages are made from them, read to be checked.

Pictures are accepted word by word: what the writer makes of all that was read must be the same text. Maps may be of any
program, if they have polygons and nothing else that a viewer could show.
"""

from __future__ import annotations

import argparse
import html
import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import invalid_file
from ..formats import DRAWING_LIMITS, Frame, Limits, read_whole, to_svg
from ..formats.geometries import shown
from ..formats.pictures import HALF, alpha_channel, boundaries_of_picture
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.predicates import orientation
from .ground import on_ground
from .options import Metres, of_drawings
from .sources import DOWN, read

HEAD = re.compile(r'<svg xmlns="[^"]*" ([^>]{,999}) overflow="visible" data-outlines="decoration">\n(<g [^>]*>\n)?')
PATH = re.compile(r'  <path id="([^"]*)" class="(level|inner)-(\d{1,6})" [^>]{,299}"\n    d="([^"]*)"/>\n')
ATTRIBUTE = re.compile(r'(\w+)="([^"]*)"')
"""Where a picture has what its writer was given: the page, and name, level and loops of each path."""

LAST_WORDS = re.compile(r"-?(drawing|shape|cage-\d+)$| (Inner )?(Fine|Cage \d+)(\.\d+)?$")
"""What the command and Blender add to the number or name of a shape in an id."""

MEASURES = {"level", "vertices", "excess", "clearance"}
"""Properties of cages that the command has written."""

STYLES = ("fill", "fill-opacity", "stroke", "stroke-opacity", "stroke-width")
"""Properties that viewers of maps take for a style."""

SAME_BOX = 1e-6
"""Difference of a bounding box from that of the coordinates, over its size, that is the rounding of its decimals."""

Levels = dict[int, Mesh]
"""The drawing, which is level 0, its cages from 1 and its inner cages from -1, those that a file has."""


@dataclass(frozen=True)
class Drawing:
    """A shape that cages are made around."""

    mesh: Mesh
    shown: list[Mesh]
    """What a picture may show of it: of pixels also the outline with holes closed, or with narrow gaps filled."""
    given: Sequence[FloatArray] = ()
    """Rings (k, 2) of a map as they stand in the file."""
    style: Mapping[str, Any] = field(default_factory=dict)
    """Properties that are a style."""


@dataclass(frozen=True)
class Page:
    """Where coordinates lie."""

    frame: Frame | None = None
    """Of a picture."""
    crs: Any = None
    pixels: Mapping[str, Any] | None = None
    """How the coordinates lie on a picture, unless they are those of a map."""
    times: Sequence[float] = ()
    """Those of the shapes, if they are frames of a motion."""


@dataclass(frozen=True)
class Written:
    """What a file of cages has."""

    shapes: list[Levels]
    page: Page
    y_up: bool = False
    """Whether y points up in a picture."""
    styles: Sequence[Mapping[str, Any]] = ()


def read_drawings(given: argparse.Namespace) -> tuple[list[Drawing], Page]:
    """The drawings of a file; several files are the frames of a motion, one each. Raises NestedCagesError."""
    files = [_drawings(path, given) for path in given.drawing]
    if len(files) == 1:
        return files[0]
    for path, (shapes, _) in zip(given.drawing, files, strict=True):
        if len(shapes) != 1:
            raise invalid_file(f"{path} has {len(shapes)} shapes; a frame of a motion is one.")
    page = replace(files[0][1], times=[*map(float, range(len(files)))])
    same = all(each.pixels == page.pixels for _, each in files)
    return [shapes[0] for shapes, _ in files], page if same else replace(page, pixels=DOWN)


def _drawings(path: str, given: argparse.Namespace) -> tuple[list[Drawing], Page]:
    """The drawings of one file; of a picture of this program those that it shows."""
    if Path(path).suffix.lower() == ".svg" and b'class="level-1"' in (content := read_whole(path, DRAWING_LIMITS)):
        picture = _picture(content)
        page = replace(picture.page, pixels=None if picture.y_up else DOWN)
        return [Drawing(levels[0], [levels[0]]) for levels in picture.shapes], page
    source = read(path, Limits(), of_drawings(given))
    if isinstance(given.clearance, Metres):
        source = on_ground(source, given.clearance, inside=given.inside)
    if source.failures:
        raise invalid_file(" ".join(source.failures))
    shapes = []
    for each in source.shapes:
        if isinstance(each.content, Mesh):
            found = [each.drawn or each.content]
            shapes.append(Drawing(each.content, found, each.given, _style(each.properties)))
        else:
            threshold = HALF if given.threshold is None else given.threshold
            found = boundaries_of_picture(alpha_channel(each.content) > threshold, given.clearance or 0.0)
            shapes.append(Drawing(found[0], found))
    times = [each.properties.get("time") for each in source.shapes]
    return shapes, Page(source.frame, source.crs, source.pixels, _increasing(times) if len(times) > 1 else [])


def read_cages(path: str) -> Written:
    """The cages of a file, and the drawings that it shows. Raises NestedCagesError for what is not to be checked."""
    if Path(path).suffix.lower() == ".svg":
        found = _picture(read_whole(path, DRAWING_LIMITS))
    else:
        found = _map(read_whole(path, Limits()))
    for levels in found.shapes:
        for side in (1, -1):
            numbers = sorted(side * level for level in levels if side * level > 0)
            if numbers != [*range(1, len(numbers) + 1)]:
                raise invalid_file(f"Its levels are {', '.join(map(str, numbers))}, not all from 1 on.")
    return found


def _picture(content: bytes) -> Written:
    """The levels of a picture. Raises NestedCagesError for one that `to_svg` has not written."""
    text = content.decode("utf-8").replace("\r\n", "\n")
    head, found = HEAD.match(text), PATH.findall(text)
    attributes = {key: html.unescape(value) for key, value in ATTRIBUTE.findall(head[1] if head else "")}
    box = tuple(map(float, attributes["viewBox"].split())) if "viewBox" in attributes else None
    sizes = (attributes.get(key, "") for key in ("width", "height", "preserveAspectRatio"))
    frame, y_up = Frame(box, *sizes), bool(head and head[2])  # type: ignore[arg-type]
    numbers = [int(number) if side == "level" else -int(number) for _, side, number, _ in found]
    names = [html.unescape(name) for name, *_ in found]
    meshes = [Mesh.from_loops([_points(loop) for loop in data.split("M")[1:]]) for *_, data in found]
    again = to_svg(dict(zip(names, meshes, strict=True)), frame=frame, levels=numbers, y_up=y_up) if found else ""
    if again != text or len({*names}) < len(names):
        pairs = zip(text.split("\n"), again.split("\n"), strict=False)
        line = next((k for k, (one, other) in enumerate(pairs, 1) if one != other), 1)
        raise invalid_file(f"Line {line} is not as this program writes pictures, so it is not checked; write it again.")
    owners = [LAST_WORDS.sub("", name) for name in names]
    if len({*owners}) != numbers.count(0):  # named by somebody else
        owners = [""] * len(owners)
    shapes: dict[str, Levels] = {}
    for owner, level, mesh, name in zip(owners, numbers, meshes, names, strict=True):
        if level in shapes.setdefault(owner, {}):
            raise invalid_file(f"{name} has the level of another path, and names do not tell whose they are.")
        shapes[owner][level] = mesh
    if any(0 not in levels for levels in shapes.values()):
        raise invalid_file("The picture does not show the drawing of each cage.")
    in_order = sorted(shapes, key=lambda owner: (len(owner), owner))  # numbers by their size
    return Written([shapes[owner] for owner in in_order], Page(frame), y_up)


def _points(loop: str) -> FloatArray:
    """(k, 2) of a loop of path data."""
    return np.array(re.findall(r"[^\sLZ]+", loop), float).reshape(-1, 2)


def _map(content: bytes) -> Written:
    """The features of a map by their levels. Raises NestedCagesError for more than polygons."""
    document = json.loads(
        content.decode("utf-8-sig"), object_pairs_hook=_once, parse_float=_number, parse_constant=_number
    )
    kind = document.get("type") if isinstance(document, dict) else None
    if kind == "FeatureCollection":
        plain = [key for key, value in document.items() if isinstance(value, str | float | int)]
        _only(document, "type features", "crs pixels bbox", *plain)
        features = document["features"]
    else:
        features = [document if kind == "Feature" else {"type": "Feature", "properties": None, "geometry": document}]
    shapes, times, styles = list[Levels](), list[Any](), list[dict[str, Any]]()
    pieces, last = list[Mesh](), 0
    for number, feature in enumerate(features):
        mesh, properties = _feature(feature, number)
        level, piece = properties.get("level", 1), properties.get("piece")
        if type(level) is not int:
            raise invalid_file(f"The level of feature {number} is {shown(level)}, not a whole number.")
        if type(piece) is int:
            pieces.append(mesh)
            if not shapes or level != last or piece != len(pieces):
                raise invalid_file(f"Feature {number} is a piece of no cage before it.")
        else:
            _check_pieces(pieces, shapes, last)
            pieces, last = [], level
            if not shapes or level in shapes[-1]:
                shapes.append({})
                times.append(properties.get("time"))
                styles.append(_style(properties))
            shapes[-1][level] = mesh
        if properties.get("time") != times[-1] or _style(properties) != styles[-1]:
            raise invalid_file(f"Feature {number} has another time or style than what is before it.")
    _check_pieces(pieces, shapes, last)
    if "bbox" in document:
        _check_box(document["bbox"], [mesh for levels in shapes for mesh in levels.values()])
    page = Page(crs=document.get("crs"), pixels=document.get("pixels"), times=_increasing(times))
    return Written(shapes, page, styles=styles)


def _feature(feature: Any, number: int) -> tuple[Mesh, dict[str, Any]]:
    """The polygons of a feature, and its properties. Raises NestedCagesError for all else."""
    _only(feature, "type properties geometry", "id bbox")
    geometry, properties = feature["geometry"], feature["properties"]
    _only(geometry, "type coordinates", "bbox")
    properties = {} if properties is None else properties
    if (
        feature["type"] != "Feature"
        or geometry["type"] not in ("Polygon", "MultiPolygon")
        or type(properties) is not dict
    ):
        raise invalid_file(f"Feature {number} is no polygon.")
    mesh = Mesh.from_geometry(geometry)
    if properties.keys() >= MEASURES and properties["vertices"] != len(mesh.vertices):
        raise invalid_file(f"Feature {number} has {len(mesh.vertices)} vertices, not {shown(properties['vertices'])}.")
    polygons = [geometry["coordinates"]] if geometry["type"] == "Polygon" else geometry["coordinates"]
    if any(ring[0] != ring[-1] for polygon in polygons for ring in polygon):
        raise invalid_file(f"Feature {number} has a ring that is not closed.")
    for owner in (feature, geometry):
        if "bbox" in owner:
            _check_box(owner["bbox"], [mesh])
    return mesh, properties


def _only(found: Any, needed: str, others: str = "", *more: str) -> None:
    """Raise NestedCagesError for a JSON object with other members than these."""
    keys = {*found} if isinstance(found, dict) else set()
    if wrong := ({*needed.split()} - keys) | (keys - {*needed.split(), *others.split(), *more}):
        what = f"a {found.get('type')!s:.20}" if isinstance(found, dict) else shown(found)
        raise invalid_file(f"The map is no plain map of polygons: {', '.join(sorted(wrong))} of {what}.")


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object. Raises NestedCagesError for a member that is there twice."""
    found = dict(pairs)
    if len(found) < len(pairs):
        raise invalid_file("The map has an object with the same member twice.")
    return found


def _number(text: str) -> float:
    """A number of JSON. Raises NestedCagesError for one that is not finite."""
    if not np.isfinite(number := float(text)):
        raise invalid_file(f"The map has {text:.40}, which is no finite number.")
    return number


def _check_box(box: Any, meshes: list[Mesh]) -> None:
    """Raise NestedCagesError for a `bbox` that is not that of the coordinates."""
    bounds = np.array([mesh.bounds for mesh in meshes])
    right = np.concatenate([bounds[:, :2].min(axis=0), bounds[:, 2:].max(axis=0)])
    if np.shape(box) != (4,) or not np.allclose(box, right, 0.0, SAME_BOX * np.ptp(right)):
        raise invalid_file("A bbox of the map is not that of its coordinates.")


def _style(properties: Mapping[str, Any]) -> dict[str, Any]:
    return {key: properties[key] for key in STYLES if key in properties}


def _increasing(times: list[Any]) -> list[float]:
    """Times of frames; none if one is no number, or they do not increase."""
    numbers = [time for time in times if isinstance(time, int | float)]
    return numbers if len(numbers) == len(times) and sorted({*numbers}) == numbers else []


def _check_pieces(pieces: list[Mesh], shapes: list[Levels], level: int) -> None:
    """Raise NestedCagesError unless convex pieces, if there are any, cover a level exactly once.

    Their borders add up to those of the cage, and so do their winding numbers, none of which is negative.
    """
    if not pieces:
        return
    border: Counter[tuple[float, ...]] = Counter()
    for mesh, sign in [*((piece, 1) for piece in pieces), (shapes[-1][level], -1)]:
        for x, y, u, v in np.hstack([mesh.vertices, mesh.edge_ends]).tolist():
            border[x, y, u, v] += sign
            border[u, v, x, y] -= sign
    if any(border.values()) or not all(map(_is_convex, pieces)):
        raise invalid_file(f"The pieces of a cage of level {level} do not fill it, each once and convex.")


def _is_convex(piece: Mesh) -> bool:
    corners = piece.rings[0]
    turns = orientation(corners, np.roll(corners, -1, axis=0), np.roll(corners, -2, axis=0))
    return len(piece.loops) == 1 and bool((turns >= 0).all())
