"""Characters for game engines: bones, cage, triangles and weights as plain JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..character import Bone, Character, Pose
from ..character.bones import ends_of
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from .engine_json import checked_document, flipped
from .limits import Limits, invalid
from .rings import ring_of, shown

FORMAT = "nested-cages character"

LEAST_WEIGHT = 1e-6
"""Weights below this are not written, and the rest of a row is scaled to a sum of 1."""

ROW_SUM = 1e-6
"""Largest difference of a row's sum from 1 in a file."""


def character_to_engine_json(character: Character, *, flip_y: float | None = None, indent: int | None = None) -> str:
    """A character as JSON, complete at rest; angles of bones are all that an engine adds.

    {"format", "version",
    "bones": [{"name", "parent": number or null, "head": [x, y], "tail": [x, y]}], parents first,
    "cage": {"points", "edges": [[i, j], …], "weights": [[[bone, weight], …] for each point]},
    "shape": {"points", "edges", "triangles": [[i, j, k], …], "weights": [[[cage point, weight], …] for each point]},
    "frames": [{"time": seconds, "shape": [[x, y], …], "cage": [[x, y], …]}]}, the places of all points, if it has any.

    To pose: turn the bones around their heads, parents first; blend the bones of each cage point as dual quaternions;
    each point of the shape is the weighted sum of cage points. flip_y: write y as `flip_y - y`; angles then turn over.
    """
    turn = 1 if flip_y is None else -1

    def place(point: tuple[float, float]) -> list[float]:
        row: list[float] = flipped(np.array([point]), flip_y)[0].tolist()
        return row

    bones = [
        {"name": b.name, "parent": b.parent, "head": place(b.head), "tail": place(b.tail)} for b in character.bones
    ]
    document: dict[str, Any] = {
        "format": FORMAT,
        "version": 1,
        "bones": bones,
        "cage": _part(character.cage, character.bone_weights, flip_y),
        "shape": {
            **_part(character.shape, character.cage_weights, flip_y),
            "triangles": character.triangles[:, ::turn].tolist(),
        },
    }
    if character.frames:
        document["frames"] = [
            {"time": time, "shape": flipped(shape, flip_y).tolist(), "cage": flipped(cage, flip_y).tolist()}
            for time, shape, cage in character.frames
        ]
    return json.dumps(document, indent=indent, allow_nan=False)


def character_from_engine_json(
    text: str | bytes, *, flip_y: float | None = None, limits: Limits | None = None
) -> Character:
    """A character written by `character_to_engine_json` with the same `flip_y`.

    Raises NestedCagesError for another format or version, and for anything that is missing or invalid.
    """
    document = checked_document(text, FORMAT, "a character", limits or Limits())
    try:
        bones = tuple(_bone(entry, flip_y) for entry in document["bones"])
        ends_of(bones)
        cage, bone_weights = _read(document["cage"], len(bones), flip_y)
        shape, cage_weights = _read(document["shape"], len(cage.vertices), flip_y)
        triangles = np.array(document["shape"]["triangles"], dtype=np.int64).reshape(-1, 3)
        if len(triangles) and not 0 <= triangles.min() <= triangles.max() < len(shape.vertices):
            raise ValueError("a triangle has a corner that is no point of the shape")
        frames = tuple(
            _pose(frame, (len(shape.vertices), len(cage.vertices)), flip_y) for frame in document.get("frames", ())
        )
    except (KeyError, TypeError, ValueError, IndexError, OverflowError) as error:
        raise invalid(f"The character cannot be read: {error!r} is missing or invalid.") from error
    triangles = triangles[:, :: 1 if flip_y is None else -1]
    return Character(shape, cage, bones, bone_weights, cage_weights, triangles, frames)


def _pose(frame: Mapping[str, Any], counts: tuple[int, int], flip_y: float | None) -> Pose:
    """A frame of a file."""
    shape, cage = (ring_of(frame[name], "the points of a frame") for name in ("shape", "cage"))
    if (len(shape), len(cage)) != counts:
        raise ValueError(f"a frame of {len(shape)} and {len(cage)} points")
    return Pose(float(frame["time"]), flipped(shape, flip_y), flipped(cage, flip_y))


def _part(mesh: Mesh, weights: FloatArray, flip_y: float | None) -> dict[str, Any]:
    """Points, edges and the weights that matter."""
    kept = np.where(weights >= LEAST_WEIGHT, weights, 0.0)
    kept /= kept.sum(axis=1, keepdims=True)
    rows = [[[int(k), float(row[k])] for k in np.flatnonzero(row)] for row in kept]
    return {"points": flipped(mesh.vertices, flip_y).tolist(), "edges": mesh.edges.tolist(), "weights": rows}


def _read(part: Any, columns: int, flip_y: float | None) -> tuple[Mesh, FloatArray]:
    """A mesh and its weights (n, columns)."""
    points = flipped(ring_of(part["points"], "the points"), flip_y)
    mesh = Mesh(points, part["edges"])
    weights = np.zeros((len(points), columns))
    if len(part["weights"]) != len(points):
        raise ValueError(f"there are {len(part['weights'])} rows of weights for {len(points)} points")
    for row, entries in zip(weights, part["weights"], strict=True):
        for column, weight in entries:
            if type(column) is not int or not 0 <= column < columns:
                raise ValueError(f"a weight belongs to {shown(column)}, which is not there")
            row[column] = weight
    if not np.isfinite(weights).all() or (np.abs(weights.sum(axis=1) - 1.0) > ROW_SUM).any():
        raise ValueError("weights that do not sum to 1")
    return mesh, weights


def _bone(entry: Mapping[str, Any], flip_y: float | None) -> Bone:
    """A bone of a file."""
    head, tail = flipped(np.array([entry["head"], entry["tail"]], dtype=np.float64), flip_y).tolist()
    parent = entry["parent"]
    if parent is not None and type(parent) is not int:
        raise ValueError(f"the parent {shown(parent)}")
    return Bone((head[0], head[1]), (tail[0], tail[1]), parent, str(entry["name"]))
