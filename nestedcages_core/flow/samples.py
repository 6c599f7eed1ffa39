"""Where the flow looks: points along both meshes, and the margin that each coarse edge asks for."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import near_pairs, position_in_group
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh

SLIT_SHARE = 0.25
"""Largest margin as a share of the distance between coarse edges that are no neighbours: leaves half of a slit free."""

SIZE_SHARE = 0.1
"""Largest margin as a share of 2 · area / perimeter of the coarse loop, the inradius of a regular polygon."""

FEWEST_WEIGHT = 0.05
"""Least weight of a sample as a share of the spacing, so that clusters of tiny edges are not ignored."""

VERTEX_WEIGHT = 2.0
"""Weight of coarse vertices relative to the other coarse samples: they are where fine edges get caught."""


class Spacing(NamedTuple):
    """How densely the boundaries are sampled."""

    length: float
    """Largest distance between samples; infinite for vertices alone."""
    unit: float
    """Length that a sample stands for at the most; it scales the weights."""
    fine_limit: int
    """Most samples on one fine edge."""
    coarse_limit: int
    """Most samples on one coarse edge."""


class EdgeSamples(NamedTuple):
    """S points along the edges of a mesh."""

    edge: IntArray
    """(S,) start vertex of the edge."""
    parameter: FloatArray
    """(S,) position along the edge in [0, 1); 0 is the vertex."""
    weight: FloatArray
    """(S,) length of boundary that the sample stands for."""


def fine_samples(mesh: Mesh, spacing: Spacing) -> EdgeSamples:
    """Samples of the fine mesh: all vertices, and even points on edges longer than the spacing."""
    return _even_samples(mesh, spacing, spacing.fine_limit)


def coarse_samples(mesh: Mesh, spacing: Spacing) -> EdgeSamples:
    """Samples of the coarse mesh; its vertices weigh more."""
    samples = _even_samples(mesh, spacing, spacing.coarse_limit)
    weight = np.where(samples.parameter == 0.0, VERTEX_WEIGHT * samples.weight, samples.weight)
    return samples._replace(weight=weight)


def _even_samples(mesh: Mesh, spacing: Spacing, limit: int) -> EdgeSamples:
    lengths = mesh.edge_lengths
    counts = np.clip(np.ceil(lengths / spacing.length), 1, limit).astype(np.int64)
    edge = np.repeat(np.arange(len(counts)), counts)
    place = position_in_group(counts)
    weight = np.clip(lengths / counts, FEWEST_WEIGHT * spacing.unit, spacing.unit)
    return EdgeSamples(edge, place / counts[edge], weight[edge])


def local_margins(coarse: Mesh, margin: float) -> FloatArray:
    """(m,) margin that each coarse edge can ask for: a length, at most ``margin``, less in slits and in small loops."""
    starts, ends = coarse.vertices, coarse.vertices[coarse.successor]
    perimeters = np.bincount(coarse.loop_of_vertex, coarse.edge_lengths)
    sizes = 2.0 * np.abs(coarse.loop_areas) / perimeters
    result = np.minimum(margin, SIZE_SHARE * sizes)[coarse.loop_of_vertex]

    point, edge = near_pairs(starts, starts, ends, margin / SLIT_SHARE)
    successor, predecessor = coarse.successor, coarse.predecessor
    neighbours = (edge, successor[edge], predecessor[edge], successor[successor[edge]])
    apart = np.logical_and.reduce([point != neighbour for neighbour in neighbours])
    point, edge = point[apart], edge[apart]
    share = SLIT_SHARE * point_edge(starts[point], starts[edge], ends[edge]).distance
    for place in (edge, point, predecessor[point]):
        np.minimum.at(result, place, share)
    return result
