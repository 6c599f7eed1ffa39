"""Frames, convex pieces and characters as they are written for game engines, read back."""

import json
from typing import Any, NamedTuple

import numpy as np

from nestedcages_core import Bone, Character, Mesh, from_engine_json


class Pose(NamedTuple):
    """A frame of an animation."""

    time: float
    shape: np.ndarray
    cage: np.ndarray


def frames_of(text: str, *, flip_y: float | None = None) -> list[tuple[float, Mesh]]:
    """Time and outline of each frame."""
    document = json.loads(text)
    assert document["format"] == "nested-cages frames" and document["version"] == 1
    outlines = [{"format": "nested-cages outline", "version": 1, **frame} for frame in document["frames"]]
    return [(each["time"], from_engine_json(json.dumps(each), flip_y=flip_y)) for each in outlines]


def pieces_of(text: str, *, flip_y: float | None = None) -> list[np.ndarray]:
    """The convex pieces (k, 2), counter-clockwise."""
    document = json.loads(text)
    points = _points(document["points"], flip_y)
    return [points[piece][:: 1 if flip_y is None else -1] for piece in document["pieces"]]


def character_of(text: str, *, flip_y: float | None = None) -> Character:
    """The character."""
    document = json.loads(text)
    assert document["format"] == "nested-cages character" and document["version"] == 1
    ends = [_points([bone["head"], bone["tail"]], flip_y).tolist() for bone in document["bones"]]
    bones = tuple(
        Bone(tuple(head), tuple(tail), bone["parent"], bone["name"])
        for (head, tail), bone in zip(ends, document["bones"], strict=True)
    )
    cage, shape = (Mesh(_points(part["points"], flip_y), part["edges"]) for part in _parts(document))
    weights = [
        _weights(part, width) for part, width in zip(_parts(document), (len(bones), len(cage.vertices)), strict=True)
    ]
    triangles = np.array(document["shape"]["triangles"])[:, :: 1 if flip_y is None else -1]
    frames = tuple(
        Pose(frame["time"], _points(frame["shape"], flip_y), _points(frame["cage"], flip_y))
        for frame in document.get("frames", ())
    )
    return Character(shape, cage, bones, *weights, triangles, frames)


def _parts(document: dict[str, Any]) -> list[dict[str, Any]]:
    return [document["cage"], document["shape"]]


def _points(rows: list[list[float]], flip_y: float | None) -> np.ndarray:
    points = np.array(rows)
    return points if flip_y is None else np.stack([points[:, 0], flip_y - points[:, 1]], axis=1)


def _weights(part: dict[str, Any], columns: int) -> np.ndarray:
    """(n, columns)."""
    weights = np.zeros((len(part["points"]), columns))
    for row, entries in zip(weights, part["weights"], strict=True):
        for column, weight in entries:
            row[column] = weight
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-6)
    return weights


def posed_meshes(text: str, turned: dict[str, float]) -> dict[str, np.ndarray]:
    """Points (n, 2) of each mesh of a puppet as scripts read it, bones turned by degrees: linear blend skinning."""
    document = json.loads(text)
    assert document["format"] == "nested-cages puppet" and document["version"] == 1
    motions: list[np.ndarray] = []
    for bone in document["bones"]:
        angle, (x, y) = np.deg2rad(turned.get(bone["name"], 0.0)), bone["head"]
        c, s = np.cos(angle), np.sin(angle)
        own = np.array([[c, -s, x - c * x + s * y], [s, c, y - s * x - c * y], [0.0, 0.0, 1.0]])
        motions.append(own if bone["parent"] is None else motions[bone["parent"]] @ own)
    found = {}
    for mesh in document["meshes"]:
        points = np.column_stack([mesh["points"], np.ones(len(mesh["points"]))])
        weights = np.zeros((len(points), len(motions)))
        for row, entries in zip(weights, mesh["weights"], strict=True):
            for column, weight in entries:
                row[column] = weight
        found[mesh["name"]] = np.einsum("nb,bij,nj->ni", weights, np.array(motions), points)[:, :2]
    return found
