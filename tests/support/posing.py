"""Puppets as scripts read them, posed."""

import json

import numpy as np


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
