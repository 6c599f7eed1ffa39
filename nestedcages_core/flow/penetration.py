"""The energy of the flow: the penetration of the two meshes, sampled on both boundaries.

    E(F) = ½ Σ w z²,   z = max(0, d_C(f) + μ) at samples f of the fine mesh,
                       z = max(0, μ - d_F(c)) at samples c of the coarse mesh,

with the signed distances d (negative inside), the margin μ of the coarse edge and the boundary length w of a sample.
Each coarse loop has its own signed distance and acts only on the fine loops of its component: the distance to the union
would push a hole caught on a coarse corner the wrong way. A coarse sample acts on the closest point of the fine mesh,
so it also moves edges without a sample nearby.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import position_in_group, split_by
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh
from ..geometry.precision import INPUT_ROUND_OFF, PART_OF_GAP
from ..geometry.signed_distance import SignedDistance
from ..geometry.vectors import inner
from .matching import Matching


class Penetration(NamedTuple):
    """The K samples on the wrong side or within the margin, and their sum."""

    energy: float
    """E, a length cubed."""
    overlap: float
    """Depth of the worst sample, negative if all are on the right side; -inf if all keep their margin."""
    edge: IntArray
    """(K,) start vertex of the fine edge to move."""
    parameter: FloatArray
    """(K,) position on that edge, in [0, 1]."""
    weight: FloatArray
    """(K,) boundary length."""
    direction: FloatArray
    """(K, 2) unit vector out of the coarse solid, against which the edge moves."""
    depth: FloatArray
    """(K,) z > 0, the distance to move."""


class PenetrationEnergy:
    """E as a function of the positions of the fine mesh, with fixed samples."""

    def __init__(
        self, fine: Mesh, coarse: Mesh, matching: Matching, margin: float, spacing: Spacing, *, from_coarse: bool = True
    ) -> None:
        """margin: wanted distance between the meshes, a length. from_coarse: with samples of the coarse mesh."""
        self.fine, self.coarse = fine, coarse
        self.margins = local_margins(coarse, margin)
        """(m,) that of each coarse edge."""
        self.samples = even_samples(fine, spacing)
        around = matching.component[fine.component_of_loop[fine.loop_of_vertex[self.samples.edge]]]
        subjects = split_by(around, int(coarse.component_of_loop.max()) + 1)
        signs = coarse.loop_signs.tolist()
        self._fields = [
            (_field(coarse.vertices[loop], sign), loop, subjects[component])
            for loop, sign, component in zip(coarse.loops, signs, coarse.component_of_loop, strict=True)
        ]
        on_coarse = even_samples(coarse, spacing)
        at = coarse.vertices[on_coarse.edge]
        self._points: FloatArray = at + on_coarse.parameter[:, None] * (coarse.edge_ends[on_coarse.edge] - at)
        self._on_coarse = on_coarse
        of_loop = split_by(coarse.loop_of_vertex[on_coarse.edge], len(coarse.loops))
        facing = _facing_loops(fine, coarse, matching) if from_coarse else []
        self._facing = [(fine_loop, of_loop[coarse_loop]) for fine_loop, coarse_loop in facing]

    def at(self, vertices: FloatArray) -> Penetration:
        """The penetration of the fine mesh with vertices (n, 2)."""
        edge, parameter, weight = self.samples
        points = vertices.take(edge, axis=0)
        points = points + parameter[:, None] * (vertices.take(self.fine.successor[edge], axis=0) - points)
        found = []
        for field, loop, subject in self._fields:
            near = field.at(points.take(subject, axis=0))
            margin = self.margins[loop].take(near.edge)
            depth = near.distance + margin
            found.append((edge[subject], parameter[subject], weight[subject], near.gradient, depth, margin))
        for fine_loop, which in self._facing:
            loop = self.fine.loops[fine_loop]
            field = _field(vertices.take(loop, axis=0), int(self.fine.loop_signs[fine_loop]))
            near = field.at(self._points.take(which, axis=0))
            margin = self.margins.take(self._on_coarse.edge.take(which))
            depth = margin - near.distance
            moved = loop.take(near.edge)
            found.append((moved, near.parameter, self._on_coarse.weight[which], near.gradient, depth, margin))
        edge, parameter, weight, direction, depth, margin = (np.concatenate(part) for part in zip(*found, strict=True))
        k = (depth > 0.0).nonzero()[0]
        overlap = float((depth - margin).take(k).max(initial=-np.inf))
        edge, parameter, weight, direction, depth = edge[k], parameter[k], weight[k], direction[k], depth[k]
        return Penetration(0.5 * inner(weight, depth * depth), overlap, edge, parameter, weight, direction, depth)


def _field(ring: FloatArray, sign: int) -> SignedDistance:
    """Signed distance to the solid side of one oriented loop (k, 2); sign +1 for an outer loop, -1 for a hole."""
    ends = np.concatenate([ring[1:], ring[:1]])
    return SignedDistance(ring, ends, outside=0 if sign > 0 else -1, tolerance=INPUT_ROUND_OFF)


def _facing_loops(fine: Mesh, coarse: Mesh, matching: Matching) -> list[tuple[int, int]]:
    """Loop pairs (fine, coarse) that penalise penetration: matched loops, and holes next to other components."""
    pairs = [(k, int(loop)) for k, loop in enumerate(matching.partner) if loop >= 0]
    outers = np.flatnonzero(fine.loop_signs > 0)
    for hole in np.flatnonzero(coarse.loop_signs < 0).tolist():
        owners = fine.component_of_loop[matching.partner == hole]
        own = outers[matching.component == coarse.component_of_loop[hole]]
        ring = coarse.vertices[coarse.loops[hole]]
        for k in own[~np.isin(fine.component_of_loop[own], owners)].tolist():
            # not where most of the hole lies in a covered hole of that component
            if 2 * np.count_nonzero(_field(fine.vertices[fine.loops[k]], 1).at(ring).distance < 0.0) <= len(ring):
                pairs.append((k, hole))
    return pairs


class Spacing(NamedTuple):
    """Sampling density of the boundaries."""

    length: float
    """Largest distance between samples; infinite for vertices only."""
    unit: float
    """Largest boundary length of a sample; scales the weights."""


class EdgeSamples(NamedTuple):
    """S points along the edges of a mesh."""

    edge: IntArray
    """(S,) start vertex of the edge."""
    parameter: FloatArray
    """(S,) position along the edge in [0, 1); 0 is the vertex."""
    weight: FloatArray
    """(S,) boundary length of the sample."""


def even_samples(mesh: Mesh, spacing: Spacing) -> EdgeSamples:
    """All vertices of a mesh, and even points on edges longer than the spacing."""
    lengths = mesh.edge_lengths
    counts = np.maximum(np.ceil(lengths / spacing.length), 1).astype(np.int64)
    edge = np.repeat(np.arange(len(counts)), counts)
    place = position_in_group(counts)
    weight = np.minimum(lengths / counts, spacing.unit)
    return EdgeSamples(edge, place / counts[edge], weight[edge])


def local_margins(coarse: Mesh, margin: float) -> FloatArray:
    """(m,) margin of each coarse edge, a length: at most ``margin``, less in slits."""
    search, successor, predecessor = coarse.edge_search, coarse.successor, coarse.predecessor
    point, edge = search.near(coarse.vertices, margin / PART_OF_GAP)
    neighbours = (edge, successor[edge], predecessor[edge], successor[successor[edge]])
    apart = np.logical_and.reduce([point != neighbour for neighbour in neighbours])
    point, edge = point[apart], edge[apart]
    share = PART_OF_GAP * point_edge(coarse.vertices[point], *search.segments(edge)).distance
    result: FloatArray = np.full(len(successor), margin)
    for place in (edge, point, predecessor[point]):
        np.minimum.at(result, place, share)
    return result
