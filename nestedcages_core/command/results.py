"""Results that are checked: pictures as this program writes them, maps of polygons alone, of any program."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..errors import invalid_file
from ..formats import DRAWING_LIMITS, Frame, Limits, read_whole, to_svg
from ..formats.geojson import LOOKS, is_number, loaded_json
from ..formats.geometries import polygons_of
from ..formats.limits import Quota
from ..formats.svg.document import Document
from ..geometry.mesh import Mesh
from ..geometry.predicates import orientation
from .sources import Source

LAST_WORDS = re.compile(r"-?(drawing|shape|cage-\d+)$| (Inner )?(Fine|Cage \d+)(\.\d+)?$")
"""What the command and Blender add to the number or name of a shape in an id."""

MEASURES = {"level", "vertices", "excess", "clearance"}
"""Properties of cages that the command has written."""

FEATURE, GEOMETRY = {"type", "properties", "geometry", "id", "bbox"}, {"type", "coordinates", "bbox"}
"""Members of a feature, and of a polygon."""

SAME_BOX = 1e-6
"""Difference of a bounding box from that of the coordinates, over its size, that is the rounding of its decimals."""

FEATURES_PER_SECOND = 1_000
"""Features that are read and checked in a second (measured)."""

CLASS = re.compile(r"(level|inner)-(\d{1,6})")
"""The class of a path."""

LETTERS = str.maketrans("LZ", "  ")
"""Letters of path data that are no numbers."""

Levels = dict[int, Mesh]
"""The drawing, which is level 0, its cages from 1 and its inner cages from -1, those that a file has."""


class Results(NamedTuple):
    """What a file of cages has."""

    shapes: list[Levels]
    looks: list[dict[str, Any]] = []
    """When and how each shape of a map is shown."""
    crs: Any = None
    pixels: Mapping[str, Any] | None = None
    picture: bytes = b""
    """What `read_picture` reads."""


def look_of(properties: Mapping[str, Any]) -> dict[str, Any]:
    return {key: properties[key] for key in LOOKS if key in properties}


def read_results(path: str, limits: Limits) -> Results:
    """The cages of a file. Raises NestedCagesError for what is not to be checked."""
    if Path(path).suffix.lower() == ".svg":
        content = read_whole(path, DRAWING_LIMITS)
        found = Results(read_picture(content)[0], picture=content)
    else:
        found = _map(read_whole(path, limits), limits)
    for levels in found.shapes:
        for side in (1, -1):
            numbers = sorted(side * level for level in levels if side * level > 0)
            if numbers != [*range(1, len(numbers) + 1)]:
                raise invalid_file(f"Its levels are {', '.join(map(str, numbers))}, not all from 1 on.")
    return found


def read_picture(content: bytes, drawings: Source | None = None) -> tuple[list[Levels], Frame, bool]:
    """The levels of a picture, its page, and whether y points up.

    Raises NestedCagesError unless it is, word by word, what `to_svg` writes of these levels on the page of the
    drawings, or on its own.
    """
    text = content.decode("utf-8", "replace").replace("\r\n", "\n")
    document = Document(text, DRAWING_LIMITS)
    paths = [each for each in document.root.iter() if str(each.tag).endswith("}path")]
    names = [each.get("id", "") for each in paths]
    sides = [CLASS.fullmatch(each.get("class", "")) for each in paths]
    if not all(sides):
        raise invalid_file(f"{names[sides.index(None)]!r:.60} has no level.")
    levels = [int(side[2]) if side[1] == "level" else -int(side[2]) for side in sides if side]
    try:
        loops = [[loop.translate(LETTERS).split() for loop in each.get("d", "").split("M")[1:]] for each in paths]
        meshes = [Mesh.from_loops([np.array(loop, float).reshape(-1, 2) for loop in each]) for each in loops]
    except ValueError as error:
        raise invalid_file("A path has more than loops of straight edges.") from error
    frame, y_up = document.frame, "<g " in text
    page, up = (frame, y_up) if drawings is None else (drawings.frame, drawings.y_up)
    again = to_svg(dict(zip(names, meshes, strict=True)), frame=page, levels=levels, y_up=up) if paths else ""
    if again != text or len({*names}) < len(names):
        pairs = zip(text.split("\n"), again.split("\n"), strict=False)
        line = next((k for k, (one, other) in enumerate(pairs, 1) if one != other), 1)
        raise invalid_file(f"Line {line} is not as this program writes cages around the drawing; write it again.")
    owners = [LAST_WORDS.sub("", name) for name in names]
    if len({*owners}) != levels.count(0):  # named by somebody else
        owners = [""] * len(owners)
    shapes: dict[str, Levels] = {}
    for owner, level, mesh, name in zip(owners, levels, meshes, names, strict=True):
        if level in shapes.setdefault(owner, {}):
            raise invalid_file(f"{name} has the level of another path, and names do not tell whose they are.")
        shapes[owner][level] = mesh
    if any(0 not in each for each in shapes.values()):
        raise invalid_file("The picture does not show the drawing of each cage.")
    return [shapes[owner] for owner in sorted(shapes, key=lambda owner: (len(owner), owner))], frame, y_up  # by number


def _map(content: bytes, limits: Limits) -> Results:
    """The features of a map by their levels. Raises NestedCagesError for more than polygons."""
    document = loaded_json(content, limits, strict=True)
    if not isinstance(document, dict):
        raise invalid_file("The map is not an object with features.")
    if document.get("type") != "FeatureCollection":
        feature = document if document.get("type") == "Feature" else {"type": "Feature", "geometry": document}
        document = {"type": "FeatureCollection", "features": [feature]}
    others = {key for key, value in document.items() if isinstance(value, dict | list)} - {"crs", "pixels", "bbox"}
    if others != {"features"} or not isinstance(document["features"], list):
        raise invalid_file(f"The map has {', '.join(sorted(others)) or 'no features'}, not features alone.")
    Quota(limits).spend("seconds", len(document["features"]) / FEATURES_PER_SECOND)
    shapes, looks, tiles = list[Levels](), list[dict[str, Any]](), list[tuple[int, Mesh, list[Mesh]]]()
    for number, feature in enumerate(document["features"]):
        mesh, properties = _feature(feature, number)
        level, piece, look = properties.get("level", 1), properties.get("piece"), look_of(properties)
        if type(level) is not int:
            raise invalid_file(f"The level of feature {number} is {level!r:.40}, not a whole number.")
        if type(piece) is not int:
            if not shapes or level in shapes[-1]:
                shapes.append({})
                looks.append(look)
            shapes[-1][level] = mesh
            tiles.append((level, mesh, []))
        elif not tiles or (level, piece) != (tiles[-1][0], len(tiles[-1][2]) + 1):
            raise invalid_file(f"Feature {number} is not the next piece of the cage before it.")
        else:
            tiles[-1][2].append(mesh)
        if look != looks[-1]:
            raise invalid_file(f"Feature {number} has another time or style than what is before it.")
    for level, cage, pieces in tiles:
        if pieces and not _fill(pieces, cage):
            raise invalid_file(f"The pieces of a cage of level {level} do not fill it, each once and convex.")
    _check_box(document, [mesh for levels in shapes for mesh in levels.values()])
    pixels = document.get("pixels")
    return Results(shapes, looks, document.get("crs"), pixels if pixels is None or isinstance(pixels, dict) else {})


def _feature(feature: Any, number: int) -> tuple[Mesh, dict[str, Any]]:
    """The polygons of a feature, and its properties. Raises NestedCagesError for all else."""
    members: dict[str, Any] = feature if isinstance(feature, dict) else {}
    geometry: Any = members.get("geometry")
    properties = members.get("properties")
    kinds = members.get("type"), geometry.get("type") if isinstance(geometry, dict) else None
    if kinds not in (("Feature", "Polygon"), ("Feature", "MultiPolygon")) or not isinstance(properties, dict | None):
        raise invalid_file(f"Feature {number} is no polygon.")
    strange = [*({*members} - FEATURE), *({*geometry} - GEOMETRY)]
    rings = [ring for polygon in polygons_of(geometry) for ring in polygon]
    if strange or any((ring[:1] != ring[-1:]).any() for ring in rings):
        what = ", ".join(strange) or "a ring that is not closed"
        raise invalid_file(f"Feature {number} has {what}, and is not checked.")
    mesh, properties = Mesh.from_geometry(geometry), properties or {}
    if properties.keys() >= MEASURES and properties["vertices"] != len(mesh.vertices):
        raise invalid_file(f"Feature {number} has {len(mesh.vertices)} vertices, not as many as it says.")
    _check_box(members, [mesh])
    _check_box(geometry, [mesh])
    return mesh, properties


def _check_box(owner: Mapping[str, Any], meshes: Sequence[Mesh]) -> None:
    """Raise NestedCagesError for a `bbox` that is not that of the coordinates."""
    if "bbox" not in owner:
        return
    box, right = owner["bbox"], np.zeros(4)
    if meshes:
        points = np.concatenate([mesh.vertices for mesh in meshes])
        right = np.concatenate([points.min(axis=0), points.max(axis=0)])
    if not isinstance(box, list) or len(box) != 4 or not all(map(is_number, box)):
        raise invalid_file("A bbox of the map is not four numbers.")
    if np.abs(np.array(box, float) - right).max() > SAME_BOX * np.ptp(right):
        raise invalid_file("A bbox of the map is not that of its coordinates.")


def _fill(pieces: Sequence[Mesh], cage: Mesh) -> bool:
    """Whether convex pieces cover a cage exactly once: their borders add up to its own, and so do winding numbers."""
    border: Counter[tuple[float, ...]] = Counter()
    for mesh, sign in [*((piece, 1) for piece in pieces), (cage, -1)]:
        for x, y, u, v in np.hstack([mesh.vertices, mesh.edge_ends]).tolist():
            border[x, y, u, v] += sign
            border[u, v, x, y] -= sign
    rings = [piece.rings[0] for piece in pieces if len(piece.loops) == 1]
    turns = (orientation(ring, np.roll(ring, -1, axis=0), np.roll(ring, -2, axis=0)) for ring in rings)
    return len(rings) == len(pieces) and not any(border.values()) and all((turn >= 0).all() for turn in turns)
