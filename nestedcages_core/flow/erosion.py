"""A tiny certified move inwards, for a coarse mesh that contains the fine one but touches it, slits and all."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import FloatArray
from ..geometry.distance import SMALLEST_LENGTH
from ..geometry.mesh import Mesh
from ..geometry.vectors import cross, rotated_left
from .containment import Containment
from .samples import local_margins

EDGE_SHARE = 0.1
"""Largest move of a vertex as a share of its shorter edge."""

LONGEST_MITRE = 2.0
"""Largest move of a vertex as a multiple of the move of its edges: sharp corners move less than their mitre."""

SPIKE = 1e-9
"""|n + n'|² of the normals of neighbouring edges below which a corner has no mitre and moves along its axis."""

ROUNDS = 40
"""Halvings of the move where it meets the coarse mesh: down to about 1e-12 of the first."""


def erode(mesh: Mesh, containment: Containment, distance: float) -> FloatArray | None:
    """Positions (n, 2) about ``distance`` or less inside the mesh's own boundary, certified inside; or None."""
    successor, predecessor = mesh.successor, mesh.predecessor
    inwards = _inward_mitres(mesh)
    shorter = np.minimum(mesh.edge_lengths, mesh.edge_lengths[predecessor])
    room = local_margins(mesh, distance)
    move = np.minimum(np.minimum(room, room[predecessor]), EDGE_SHARE * shorter)
    for _ in range(ROUNDS):
        vertices = mesh.vertices + move[:, None] * inwards
        met = containment.crossing_starts(vertices)
        if len(met) == 0:
            return vertices if containment.obstacle(vertices) is None else None
        met = np.unique(met)
        nearby = np.unique(np.concatenate([predecessor[met], met, successor[met], successor[successor[met]]]))
        move[nearby] *= 0.5
    return None


def _inward_mitres(mesh: Mesh) -> FloatArray:
    """(n, 2) motion of each vertex when its edges move inwards by one, cut short at sharp corners."""
    direction = mesh.vertices[mesh.successor] - mesh.vertices
    tangent = direction / np.maximum(mesh.edge_lengths, SMALLEST_LENGTH)[:, None]
    normal = rotated_left(tangent)
    before = mesh.predecessor
    both = normal + normal[before]
    squared = (both * both).sum(axis=1)
    mitre = 2.0 * both / np.maximum(squared, SPIKE)[:, None]
    length = np.hypot(*mitre.T)
    mitre *= (np.minimum(length, LONGEST_MITRE) / np.maximum(length, SMALLEST_LENGTH))[:, None]
    axis = tangent - tangent[before]
    convex = cross(tangent[before], tangent) > 0.0
    return np.where((squared > SPIKE)[:, None], mitre, np.where(convex, 1.0, -1.0)[:, None] * axis)
