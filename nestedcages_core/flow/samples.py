"""Sample points along both meshes, and the margin of each coarse edge."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import TINY, FloatArray, IntArray
from ..geometry.broad_phase import near_pairs, position_in_group
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh

MARGIN_PER_GAP = 0.25
"""Largest margin, as a fraction of the distance to coarse edges other than neighbours: half of a slit stays free."""

MARGIN_PER_INRADIUS = 0.1
"""Largest margin, as a fraction of 2 · area / perimeter of the coarse loop, the inradius of a regular polygon."""


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

    point, edge = near_pairs(starts, starts, ends, margin / MARGIN_PER_GAP)
    successor, predecessor = coarse.successor, coarse.predecessor
    neighbours = (edge, successor[edge], predecessor[edge], successor[successor[edge]])
    apart = np.logical_and.reduce([point != neighbour for neighbour in neighbours])
    point, edge = point[apart], edge[apart]
    share = MARGIN_PER_GAP * point_edge(starts[point], starts[edge], ends[edge]).distance
    for place in (edge, point, predecessor[point]):
        np.minimum.at(result, place, share)
    return np.asarray(result, np.float64)
