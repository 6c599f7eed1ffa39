"""Collision outlines for game engines: polygons with holes as plain JSON."""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..errors import invalid_file
from ..geometry.arrays import FloatArray
from ..geometry.drawable import Drawable
from ..geometry.mesh import Mesh, MeshLike
from ..geometry.predicates import orientation
from ..geometry.triangulation import triangulate
from .decimals import check_decimals, subtracted
from .files import write_whole
from .geojson import loaded_json
from .geometries import polygons_of, shown
from .limits import Limits, Quota
from .meshes import meshes_of
from .pieces import piece_vertices

FORMAT = "nested-cages outline"
FRAMES = "nested-cages frames"
VERSION = 1
"""Format names, and a version that counts incompatible changes."""


def to_engine_json(
    shape: Drawable | MeshLike,
    *,
    flip_y: float | None = None,
    triangles: bool = False,
    pieces: int | None = None,
    indent: int | None = None,
    decimals: int | None = None,
) -> str:
    """The outline as JSON; of a level its cage, of a hierarchy its coarsest cage.

    {"format", "version", "polygons": [{"outer": [[x, y], …], "holes": [[[x, y], …], …]}]}.

    Outer loops turn counter-clockwise in the numbers written and holes clockwise, as Godot, Unity and Box2D tell them
    apart. flip_y: write y as `flip_y - y`; the height of a picture turns it over, 0 mirrors it.
    triangles: also {"points": [[x, y], …], "triangles": [[i, j, k], …]}, for engines whose pieces must be convex.
    pieces: also {"points", "pieces": [[i, j, …], …]}, convex and counter-clockwise, of at most this many vertices each.
    decimals: as of `to_geojson`.

    Raises NestedCagesError if ``pieces`` is less than 3, and for coordinates with more decimals.
    """
    mesh = meshes_of(shape)[-1]
    check_decimals([mesh], decimals)
    document = engine_document([mesh], flip_y=flip_y, triangles=triangles, pieces=pieces)
    return json.dumps(document, indent=indent, allow_nan=False)


def engine_document(
    meshes: Sequence[Mesh], *, flip_y: float | None, triangles: bool, pieces: int | None
) -> dict[str, Any]:
    """What `to_engine_json` writes, of several outlines in one document."""
    polygons = [polygon for mesh in meshes for polygon in _polygons(mesh, flip_y)]
    document: dict[str, Any] = {"format": FORMAT, "version": VERSION, "polygons": polygons}
    turn = 1 if flip_y is None else -1
    firsts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)]).tolist()
    numbered = list(zip(firsts, meshes, strict=False))
    if triangles or pieces is not None:
        document["points"] = [point for mesh in meshes for point in flipped(mesh.vertices, flip_y).tolist()]
    if triangles:
        document["triangles"] = [
            corners for first, mesh in numbered for corners in (first + triangulate(mesh).triangles[:, ::turn]).tolist()
        ]
    if pieces is not None:
        document["pieces"] = [
            [first + corner for corner in piece[::turn]]
            for first, mesh in numbered
            for piece in piece_vertices(mesh, pieces)
        ]
    return document


def frames_to_engine_json(
    outlines: Sequence[Mesh],
    times: ArrayLike | None = None,
    *,
    flip_y: float | None = None,
    indent: int | None = None,
    decimals: int | None = None,
) -> str:
    """Outlines of an animation as JSON: {"format", "version", "frames": [{"time", "polygons": [...]}]}.

    The polygons of a frame are those of `to_engine_json`; outlines of one moving cage list its vertices in the same
    order in all frames. times: (K,) 0, 1, ... by default. decimals: as of `to_geojson`.
    """
    check_decimals(outlines, decimals)
    if not outlines:
        raise invalid_file("There are no frames to write.")
    moments = np.arange(len(outlines), dtype=float) if times is None else np.asarray(times, dtype=float)
    if moments.shape != (len(outlines),) or not np.isfinite(moments).all():
        raise invalid_file(f"The times must be {len(outlines)} finite numbers, one per frame.")
    frames = [
        {"time": time, "polygons": _polygons(outline, flip_y)}
        for time, outline in zip(moments.tolist(), outlines, strict=True)
    ]
    return json.dumps({"format": FRAMES, "version": VERSION, "frames": frames}, indent=indent, allow_nan=False)


def write_engine_json(path: str | os.PathLike[str], shape: Drawable, **options: Any) -> None:
    """Write the outline to a file, whole or not at all; options as of `to_engine_json`."""
    write_whole(path, to_engine_json(shape, **options))


def is_engine_json(text: str | bytes) -> bool:
    """Whether a text is a collision outline rather than another kind of JSON."""
    if (FORMAT if isinstance(text, str) else FORMAT.encode()) not in text:  # type: ignore[operator]
        return False
    try:
        document = json.loads(text)
    except (ValueError, RecursionError):
        return False
    return isinstance(document, dict) and document.get("format") == FORMAT


def from_engine_json(text: str | bytes, *, flip_y: float | None = None, limits: Limits | None = None) -> Mesh:
    """The mesh of an outline written by `to_engine_json` with the same `flip_y`.

    Raises NestedCagesError for another format or version, and for invalid numbers, with their place; InvalidMeshError
    if loops cross or touch, or a hole is not inside its polygon.
    """
    limits = limits or Limits()
    return _mesh_of(_document(text, (FORMAT,), limits), flip_y, Quota(limits))


def outlines_from_engine_json(text: str | bytes, *, limits: Limits | None = None) -> tuple[list[Mesh], bool]:
    """The outline of a document, or those of its frames, and whether it has frames.

    Raises NestedCagesError as `from_engine_json`, and where triangles or pieces do not fill their outline.
    """
    limits = limits or Limits()
    document, quota = _document(text, (FORMAT, FRAMES), limits), Quota(limits)
    moves = document["format"] == FRAMES
    parts = document.get("frames") if moves else [document]
    if not isinstance(parts, list) or not parts or not all(isinstance(part, Mapping) for part in parts):
        raise invalid_file(f"The collision outline has {shown(parts)} where its list of frames belongs.")
    outlines = []
    for part in parts:
        outlines.append(_mesh_of(part, None, quota))
        for name in ("triangles", "pieces"):
            if name in part and not _fill(part, part[name], outlines[-1]):
                raise invalid_file(f"The {name} of the collision outline do not fill it, each once and convex.")
    return outlines, moves


def _fill(document: Mapping[str, Any], faces: Any, outline: Mesh) -> bool:
    """Whether faces of a document's points, all convex, cover an outline exactly once.

    Their borders add up to the outline, and so do their winding numbers, none of which is negative.
    """
    (points,) = polygons_of({"type": "Polygon", "coordinates": [document.get("points")]})[0] or [np.zeros((0, 2))]
    border: Counter[tuple[tuple[float, float], ...]] = Counter()
    for face in faces if isinstance(faces, list) else [None]:
        whole = isinstance(face, list) and len(face) > 2 and all(type(k) is int and 0 <= k < len(points) for k in face)
        if not whole or not _is_convex(corners := points[face]):
            return False
        ends = [*map(tuple, corners.tolist())]
        for begin, end in zip(ends, [*ends[1:], ends[0]], strict=True):
            border[begin, end] += 1
            border[end, begin] -= 1
    for begin, end in outline.vertices[outline.edges].tolist():
        border[tuple(begin), tuple(end)] -= 1
        border[tuple(end), tuple(begin)] += 1
    return not any(border.values())


def _is_convex(corners: FloatArray) -> bool:
    """Whether a loop turns left wherever it turns."""
    turns = orientation(corners, np.roll(corners, -1, axis=0), np.roll(corners, -2, axis=0))
    return bool((turns >= 0).all() and turns.any())


def _document(text: str | bytes, formats: Sequence[str], limits: Limits) -> Mapping[str, Any]:
    """A document in one of some formats. Raises NestedCagesError."""
    document, _ = loaded_json(text, "a collision outline", limits)
    if not isinstance(document, Mapping) or document.get("format") not in formats:
        raise invalid_file(f'This is not a collision outline: its format is not "{formats[0]}".')
    version = document.get("version")
    if type(version) is not int or version != VERSION:
        raise invalid_file(
            f"The collision outline is of version {shown(version)}, but version {VERSION} is read; export it again."
        )
    return document


def _polygons(mesh: Mesh, flip_y: float | None) -> list[dict[str, Any]]:
    """Outer loop and holes of each component."""
    polygons: list[dict[str, Any]] = [{"outer": [], "holes": []} for _ in range(int(mesh.component_of_loop.max()) + 1)]
    for k, loop in enumerate(mesh.loops):
        points = flipped(mesh.vertices[loop], flip_y)
        rows = (points if flip_y is None else points[::-1]).tolist()
        polygon = polygons[mesh.component_of_loop[k]]
        if mesh.loop_signs[k] > 0:
            polygon["outer"] = rows
        else:
            polygon["holes"].append(rows)
    return polygons


def _mesh_of(document: Mapping[str, Any], flip_y: float | None, quota: Quota) -> Mesh:
    """The mesh of the polygons of a document."""
    parts = document.get("polygons")
    if not isinstance(parts, list):
        raise invalid_file(f"The collision outline has {shown(parts)} where its list of polygons belongs.")
    quota.spend("elements", len(parts))
    rings = []
    for k, part in enumerate(parts):
        if not isinstance(part, Mapping) or not isinstance(part.get("holes", []), list) or "outer" not in part:
            raise invalid_file(f"Polygon {k} of the collision outline is not an object with outer and holes.")
        rings.append([part["outer"], *part.get("holes", [])])
    polygons = polygons_of({"type": "MultiPolygon", "coordinates": rings})
    quota.spend("points", sum(len(ring) for polygon in polygons for ring in polygon))
    turned = [[flipped(ring, flip_y) for ring in polygon] for polygon in polygons]
    return Mesh.from_geometry({"type": "MultiPolygon", "coordinates": turned})


def flipped(points: FloatArray, flip_y: float | None) -> FloatArray:
    """Points (n, 2) with y turned over at half of `flip_y`, in decimals; turned twice they are the same again."""
    if flip_y is None:
        return points
    return np.stack((points[:, 0], subtracted(flip_y, points[:, 1])), axis=1)
