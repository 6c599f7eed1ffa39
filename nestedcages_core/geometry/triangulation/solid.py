"""The triangulation of a mesh, with extra points: a graded spacing along the edges and inside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy

from ...errors import invalid_setting
from ...parameters import check_fraction, check_not_negative
from ..arrays import FloatArray, IntArray
from ..mesh import Mesh
from ..signed_distance import SignedDistance
from .constrained import constrained_delaunay
from .triangulation import Triangulation

SPACING_NEIGHBOURS = 6
"""Nearest boundary points that limit the spacing at a point inside; more change little."""

MIN_DEPTH = 0.5
"""Smallest distance of inner points from the boundary, in local spacings."""

MAX_CELL_HALVINGS = 24
"""Maximum number of halvings of the bounding box: the smallest spacing is 6e-8 of it."""

SPACING_SAMPLES = 257
"""Samples of the wanted spacing on an edge, to integrate it."""


def triangulate(mesh: Mesh, sampling: Sampling | None = None) -> Triangulation:
    """The constrained Delaunay triangulation of the solid that a mesh bounds, holes left open.

    Its first vertices are those of the mesh, in their order; without a sampling there are no others. Raises
    InvalidMeshError if the loops are not valid, as may happen for a mesh made by `moved`.
    """
    samples = sample(mesh.validated(), sampling)
    triangles = constrained_delaunay(samples.points, samples.segments)
    return Triangulation(samples.points, triangles, samples.edge, mesh.successor[samples.edge], samples.parameter)


@dataclass(frozen=True)
class Sampling:
    """How dense the points of a triangulation are."""

    spacing: float
    """Distance between points far from any corner; unit: the input's."""
    at_corners: float = 1.0
    """Spacing at a corner of the mesh, as a share of `spacing` or of the corner's shorter edge, if that is less."""
    growth: float = 0.5
    """How fast the spacing grows with the distance from corners and boundary."""

    def __post_init__(self) -> None:
        if not 0.0 < self.spacing < np.inf:
            raise invalid_setting(f"The spacing of a triangulation must be a positive length, not {self.spacing!r}.")
        check_fraction(self, "at_corners")
        check_not_negative(self, "growth")


class SamplePoints(NamedTuple):
    """Points of a triangulation: first the mesh's own vertices, then others on its edges, then those inside."""

    points: FloatArray
    """(N, 2)."""
    edge: IntArray
    """(B,) start vertex of the edge that each point of the boundary lies on."""
    parameter: FloatArray
    """(B,) place on that edge."""
    segments: IntArray
    """(B, 2) consecutive points of the boundary, the solid on their left."""


def sample(mesh: Mesh, sampling: Sampling | None) -> SamplePoints:
    """The points; without a sampling the mesh's own vertices."""
    n = len(mesh.vertices)
    if sampling is None:
        return SamplePoints(mesh.vertices, np.arange(n), np.zeros(n), np.stack((np.arange(n), mesh.successor), axis=1))
    edge, parameter = _edge_samples(mesh, sampling)
    starts, ends = mesh.vertices[edge], mesh.vertices[mesh.successor[edge]]
    boundary = np.concatenate((mesh.vertices, starts + parameter[:, None] * (ends - starts)))
    edge, parameter = np.concatenate((np.arange(n), edge)), np.concatenate((np.zeros(n), parameter))
    order = np.lexsort((parameter, edge))  # along each edge
    ahead = np.empty(len(order), dtype=np.int64)
    ahead[order[:-1]] = order[1:]
    last = order[np.append(np.flatnonzero(np.diff(edge[order])), len(order) - 1)]
    ahead[last] = mesh.successor[edge[last]]
    segments = np.stack((np.arange(len(order)), ahead), axis=1)
    return SamplePoints(
        np.concatenate((boundary, _inside(mesh, boundary, segments, sampling))), edge, parameter, segments
    )


def _edge_samples(mesh: Mesh, sampling: Sampling) -> tuple[IntArray, FloatArray]:
    """Points inside the edges, (K,) edges and (K,) parameters, so that pieces are as long as wanted where they are."""
    lengths = mesh.edge_lengths
    shorter = np.minimum(lengths, lengths[mesh.predecessor])
    at_vertex = sampling.at_corners * np.minimum(shorter, sampling.spacing)
    edges, parameters = [np.zeros(0, dtype=np.int64)], [np.zeros(0)]
    place = np.linspace(0.0, 1.0, SPACING_SAMPLES)
    middle = 0.5 * (place[1:] + place[:-1])
    for v in np.flatnonzero((lengths > sampling.spacing) | (sampling.at_corners < 1.0)):
        from_start = at_vertex[v] + sampling.growth * lengths[v] * middle
        from_end = at_vertex[mesh.successor[v]] + sampling.growth * lengths[v] * (1.0 - middle)
        wanted = np.minimum(np.minimum(from_start, from_end), sampling.spacing)
        pieces = np.concatenate(([0.0], np.cumsum(lengths[v] / (SPACING_SAMPLES - 1) / wanted)))
        count = max(round(pieces[-1]), 1)
        edges.append(np.full(count - 1, v))
        parameters.append(np.interp(np.arange(1, count) * (pieces[-1] / count), pieces, place))
    return np.concatenate(edges), np.concatenate(parameters)


def _inside(mesh: Mesh, boundary: FloatArray, segments: IntArray, sampling: Sampling) -> FloatArray:
    """(K, 2) centres of the cells of a quadtree that is as fine as the spacing asks for."""
    pieces = boundary[segments[:, 1]] - boundary[segments[:, 0]]
    long = np.hypot(pieces[:, 0], pieces[:, 1])
    around = long.copy()
    around[segments[:, 1]] = np.minimum(around[segments[:, 1]], long)
    tree = scipy.spatial.cKDTree(boundary)
    distance = SignedDistance.of(mesh)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    # the root is a power of two times the spacing, so that uniform parts get exactly that spacing
    width = float((high - low).max())
    depth = max(int(np.ceil(np.log2(width / sampling.spacing))), 0)
    size = sampling.spacing * 2.0**depth
    cells = (0.5 * (low + high))[None]
    leaves = [np.zeros((0, 2))]
    quarter = np.array([[-0.25, -0.25], [0.25, -0.25], [-0.25, 0.25], [0.25, 0.25]])
    for _ in range(MAX_CELL_HALVINGS):
        reach, near = tree.query(cells, k=range(1, min(SPACING_NEIGHBOURS, len(boundary)) + 1))
        wanted = np.minimum((around[near] + sampling.growth * reach).min(axis=1), sampling.spacing)
        signed = distance.at(cells).distance
        # a cell whose centre is farther outside than its own radius has no part inside
        touched = signed < np.sqrt(0.5) * size
        done = (size <= wanted * (1.0 + 1e-9)) & touched
        leaves.append(cells[done & (signed < -MIN_DEPTH * wanted)])
        cells = cells[touched & ~done]
        if not len(cells):
            break
        cells = (cells[:, None] + size * quarter).reshape(-1, 2)
        size *= 0.5
    return np.concatenate(leaves)
