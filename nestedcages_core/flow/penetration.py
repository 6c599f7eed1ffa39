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

from ..geometry.arrays import TINY, FloatArray, IntArray
from ..geometry.broad_phase import near_pairs, position_in_group, split_by
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh
from ..geometry.precision import INPUT_ROUND_OFF, PART_OF_GAP
from ..geometry.signed_distance import SignedDistance
from ..geometry.vectors import inner, norm
from .loop_matching import Matching, outer_loops

MARGIN_PER_INRADIUS = 0.1
"""Largest margin, as a fraction of 2 · area / perimeter of the coarse loop, the inradius of a regular polygon."""


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

    def __init__(self, matching: Matching, margin: float, spacing: Spacing, *, from_coarse: bool = True) -> None:
        """margin: wanted distance between the meshes, a length. from_coarse: with samples of the coarse mesh."""
        self.matching = matching
        fine, coarse = matching.fine, matching.coarse
        self.margins = local_margins(coarse, margin)
        self.samples = even_samples(fine, spacing)
        self._target = fine.successor[self.samples.edge]
        self._between_vertices = bool(self.samples.parameter.any())
        around = matching.component[fine.component_of_loop[fine.loop_of_vertex[self.samples.edge]]]
        subjects = split_by(around, int(coarse.component_of_loop.max()) + 1)
        self._push_fine = [
            _FinePush(matching, self.samples, loop, subjects[component])
            for loop, component in enumerate(coarse.component_of_loop.tolist())
        ]
        self._push_coarse: list[_CoarsePush] = []
        if not from_coarse:
            return
        on_coarse = even_samples(coarse, spacing)
        at = coarse.vertices[on_coarse.edge]
        points = at + on_coarse.parameter[:, None] * (coarse.vertices[coarse.successor[on_coarse.edge]] - at)
        loop_of_point = coarse.loop_of_vertex[on_coarse.edge]
        of_loop = split_by(loop_of_point, len(coarse.loops))
        self._push_coarse = [
            _CoarsePush(matching, on_coarse, points, of_loop[coarse_loop], fine_loop)
            for fine_loop, coarse_loop in _facing_loops(matching)
        ]

    def at(self, vertices: FloatArray) -> Penetration:
        """The penetration of the fine mesh with vertices (n, 2)."""
        samples = self.samples
        points = vertices.take(samples.edge, axis=0)
        if self._between_vertices:
            points = points + samples.parameter[:, None] * (vertices.take(self._target, axis=0) - points)
        found = [push.find(points, self.margins) for push in self._push_fine]
        found += [push.find(vertices, self.margins) for push in self._push_coarse]
        edge, parameter, weight, depth, margin = (np.concatenate([part[k] for part in found]) for k in range(5))
        direction = np.concatenate([part.direction for part in found])
        return Penetration(
            energy=0.5 * inner(weight, depth * depth),
            overlap=float((depth - margin).max(initial=-np.inf)),
            edge=edge,
            parameter=parameter,
            weight=weight,
            direction=direction,
            depth=depth,
        )


class _Pushed(NamedTuple):
    edge: IntArray
    parameter: FloatArray
    weight: FloatArray
    depth: FloatArray
    margin: FloatArray
    direction: FloatArray


class _FinePush:
    """One coarse loop pushes samples of the fine mesh."""

    def __init__(self, matching: Matching, samples: EdgeSamples, loop: int, subject: IntArray) -> None:
        """subject: the samples that it pushes."""
        coarse = matching.coarse
        self.samples = samples
        self.start = coarse.loops[loop]
        self.field = _field(coarse.vertices[self.start], int(coarse.loop_signs[loop]))
        self.subject = subject
        # distances are 1-Lipschitz, so points deep inside need not be measured again until they have moved far
        self._known: FloatArray = np.full(len(self.subject), np.inf)
        self._known_at: FloatArray = np.zeros((len(self.subject), 2))

    def find(self, points: FloatArray, margins: FloatArray) -> _Pushed:
        here = points.take(self.subject, axis=0)
        motion = here - self._known_at
        around = margins.take(self.start)
        near = self._known + np.hypot(motion[:, 0], motion[:, 1]) + around.max() > 0.0
        k = near.nonzero()[0]
        measured = here.take(k, axis=0)
        sample = self.field.at(measured)
        self._known[k] = sample.distance
        self._known_at[k] = measured
        margin = around.take(sample.edge)
        depth = sample.distance + margin
        pushed = (depth > 0.0).nonzero()[0]
        who = self.subject.take(k.take(pushed))
        return _Pushed(
            self.samples.edge.take(who),
            self.samples.parameter.take(who),
            self.samples.weight.take(who),
            depth.take(pushed),
            margin.take(pushed),
            sample.gradient.take(pushed, axis=0),
        )


class _CoarsePush:
    """Samples of the coarse mesh push one fine loop until they are outside its solid."""

    def __init__(
        self, matching: Matching, samples: EdgeSamples, points: FloatArray, which: IntArray, fine_loop: int
    ) -> None:
        self.points = points[which]
        self.weight = samples.weight[which]
        self.coarse_edge = samples.edge[which]
        self.start = matching.fine.loops[fine_loop]
        self.sign = int(matching.fine.loop_signs[fine_loop])
        # distances change by no more than the loop moves, so points on the right side are not measured until it has
        self._beyond: FloatArray = np.full(len(self.points), -np.inf)
        """Lower bound on the distance from the wrong side when the loop was last looked at."""
        self._loop: FloatArray = matching.fine.vertices.take(self.start, axis=0)

    def find(self, vertices: FloatArray, margins: FloatArray) -> _Pushed:
        loop = vertices.take(self.start, axis=0)
        margin = margins.take(self.coarse_edge)
        self._beyond -= float(norm(loop - self._loop).max())
        self._loop = loop
        near = (margin > self._beyond).nonzero()[0]
        sample = _field(loop, self.sign).at(self.points.take(near, axis=0))
        self._beyond[near] = sample.distance
        depth = margin.take(near) - sample.distance
        k = (depth > 0.0).nonzero()[0]
        who = near.take(k)
        return _Pushed(
            self.start.take(sample.edge.take(k)),
            sample.parameter.take(k),
            self.weight.take(who),
            depth.take(k),
            margin.take(who),
            sample.gradient.take(k, axis=0),
        )


def _field(loop: FloatArray, sign: int) -> SignedDistance:
    """Signed distance to the solid side of one oriented loop (k, 2); sign +1 for an outer loop, -1 for a hole."""
    ends = np.concatenate([loop[1:], loop[:1]])
    return SignedDistance(loop, ends, outside=0 if sign > 0 else -1, tolerance=INPUT_ROUND_OFF)


def _facing_loops(matching: Matching) -> list[tuple[int, int]]:
    """Loop pairs (fine, coarse) that penalise penetration: matched loops, and holes next to other components."""
    fine, coarse = matching.fine, matching.coarse
    pairs = [(k, int(loop)) for k, loop in enumerate(matching.partner) if loop >= 0]
    outers = outer_loops(fine)
    for loop in np.nonzero(coarse.loop_signs < 0)[0].tolist():
        owners = fine.component_of_loop[matching.partner == loop]
        own = outers[matching.component == coarse.component_of_loop[loop]]
        for k in own[~np.isin(fine.component_of_loop[own], owners)].tolist():
            if not _around(matching, k, loop):
                pairs.append((k, loop))
    return pairs


def _around(matching: Matching, fine_loop: int, coarse_loop: int) -> bool:
    """Whether most of a coarse loop lies inside an outer fine loop: in one of its covered holes, not next to it."""
    field = _field(matching.fine.vertices[matching.fine.loops[fine_loop]], 1)
    inside = field.at(matching.coarse.vertices[matching.coarse.loops[coarse_loop]]).distance < 0.0
    return bool(2 * np.count_nonzero(inside) > len(inside))


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
    """(m,) margin of each coarse edge, a length: at most ``margin``, less in slits and in small loops."""
    starts, ends = coarse.vertices, coarse.vertices[coarse.successor]
    perimeters = np.bincount(coarse.loop_of_vertex, coarse.edge_lengths)
    sizes = 2.0 * np.abs(coarse.loop_areas) / np.maximum(perimeters, TINY)  # far smaller loops than others underflow
    result = np.minimum(margin, MARGIN_PER_INRADIUS * sizes)[coarse.loop_of_vertex]

    point, edge = near_pairs(starts, starts, ends, margin / PART_OF_GAP)
    successor, predecessor = coarse.successor, coarse.predecessor
    neighbours = (edge, successor[edge], predecessor[edge], successor[successor[edge]])
    apart = np.logical_and.reduce([point != neighbour for neighbour in neighbours])
    point, edge = point[apart], edge[apart]
    share = PART_OF_GAP * point_edge(starts[point], starts[edge], ends[edge]).distance
    for place in (edge, point, predecessor[point]):
        np.minimum.at(result, place, share)
    return np.asarray(result, np.float64)
