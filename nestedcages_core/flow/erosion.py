"""Erosion: a small certified offset inwards, for a coarse mesh that touches the fine one but does not cross it.

See docs/ablation.md: flow: erosion.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import FloatArray
from ..geometry.distance import SMALLEST_LENGTH
from ..geometry.mesh import Mesh
from ..geometry.vectors import cross, dot, rotated_left
from .containment import Containment
from .samples import local_margins

LARGEST_OFFSET_PER_EDGE = 0.1
"""Largest offset of a vertex, as a fraction of its shorter edge."""

EROSION_MITRE_LIMIT = 2.0
"""Largest motion of a vertex, as a multiple of the offset of its edges."""

SPIKE = 1e-9
"""|n + n'|² of the normals of neighbouring edges below which a corner has no mitre and moves along its edges."""

MAX_OFFSET_HALVINGS = 40
"""Cap on the halvings of offsets that meet the coarse mesh: down to 1e-12 of the first."""


def erode(mesh: Mesh, containment: Containment, distance: float) -> FloatArray | None:
    """Positions (n, 2) at most about ``distance`` inside the mesh, certified inside; None on failure."""
    successor, predecessor = mesh.successor, mesh.predecessor
    inwards = _inward_mitres(mesh)
    shorter = np.minimum(mesh.edge_lengths, mesh.edge_lengths[predecessor])
    room = local_margins(mesh, distance)
    offset = np.minimum(np.minimum(room, room[predecessor]), LARGEST_OFFSET_PER_EDGE * shorter)
    for _ in range(MAX_OFFSET_HALVINGS):
        vertices = mesh.vertices + offset[:, None] * inwards
        met = containment.crossing_starts(vertices)
        if len(met) == 0:
            return vertices if containment.obstacle(vertices) is None else None
        met = np.unique(met)
        nearby = np.unique(np.concatenate([predecessor[met], met, successor[met], successor[successor[met]]]))
        offset[nearby] *= 0.5
    return None


def _inward_mitres(mesh: Mesh) -> FloatArray:
    """(n, 2) motion of each vertex for an inward offset of its edges by 1, limited at sharp corners."""
    direction = mesh.vertices[mesh.successor] - mesh.vertices
    tangent = direction / np.maximum(mesh.edge_lengths, SMALLEST_LENGTH)[:, None]
    normal = rotated_left(tangent)
    before = mesh.predecessor
    both = normal + normal[before]
    squared = dot(both, both)
    mitre = 2.0 * both / np.maximum(squared, SPIKE)[:, None]
    length = np.hypot(*mitre.T)
    mitre *= (np.minimum(length, EROSION_MITRE_LIMIT) / np.maximum(length, SMALLEST_LENGTH))[:, None]
    axis = tangent - tangent[before]
    convex = cross(tangent[before], tangent) > 0.0
    return np.where((squared > SPIKE)[:, None], mitre, np.where(convex, 1.0, -1.0)[:, None] * axis)
