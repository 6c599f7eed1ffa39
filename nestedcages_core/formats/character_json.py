"""Characters for game engines: bones, cage, triangles and weights as plain JSON."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from ..character import Character
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from .engine_json import flipped

FORMAT = "nested-cages character"

LEAST_WEIGHT = 1e-6
"""Weights below this are not written, and the rest of a row is scaled to a sum of 1."""


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
        "cage": _points_and_weights(character.cage, character.bone_weights, flip_y),
        "shape": {
            **_points_and_weights(character.shape, character.cage_weights, flip_y),
            "triangles": character.triangles[:, ::turn].tolist(),
        },
    }
    if character.frames:
        document["frames"] = [
            {"time": time, "shape": flipped(shape, flip_y).tolist(), "cage": flipped(cage, flip_y).tolist()}
            for time, shape, cage in character.frames
        ]
    return json.dumps(document, indent=indent, allow_nan=False)


def _points_and_weights(mesh: Mesh, weights: FloatArray, flip_y: float | None) -> dict[str, Any]:
    """Points, edges and the weights that matter."""
    kept = np.where(weights >= LEAST_WEIGHT, weights, 0.0)
    kept /= kept.sum(axis=1, keepdims=True)
    rows = [[[int(k), float(row[k])] for k in np.flatnonzero(row)] for row in kept]
    return {"points": flipped(mesh.vertices, flip_y).tolist(), "edges": mesh.edges.tolist(), "weights": rows}
