"""Retraction along shortest paths inside the fine solid, for limbs cut off by the coarse mesh; tips move first.

Paths run over a graph of points on the boundary and inside the fine solid. The core, the points well inside the coarse
mesh, stays; all other vertices move along their paths to the core, so nothing leaves the fine solid.

See docs/ablation.md: flow: geodesic.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ..geometry.arrays import TINY, BoolArray, FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.predicates import BoxTree, crossing_pairs
from ..geometry.signed_distance import SignedDistance
from ..geometry.vectors import rotated_left
from .base import Obstacle
from .loop_matching import Matching, loop_tree, windings
from .samples import Spacing, coarse_samples, fine_samples

SCATTERED_POINTS = 2000
"""Number of points spread evenly over the bounding box of the fine mesh."""

PLASTIC = 1.324717957244746
"""The root of x³ = x + 1: multiples of its powers -1 and -2, modulo 1, fill a square evenly (Roberts 2018)."""

JITTER = 1e-9
"""Noise on the points for the triangulation, in extents of the fine mesh: without it collinear rows are slow."""

INSETS = (1.0, 4.0)
"""Depths of the rows of points below the coarse edges, in margins of the edge."""

CORE_DEPTH = 0.5
"""Depth below the coarse boundary of the core, in margins of the nearest edge."""

TRIMMED_ENDS = 1e-7
"""Fraction of a graph edge trimmed at both ends, which may lie on the boundary, when it is tested against it."""

SHORTEST_GRAPH_EDGE = 1e-10
"""Added to the lengths of graph edges, in extents of the fine mesh: a sparse graph drops edges of length 0."""

FRONT_LAG = 1e-3
"""Lag of vertices behind the front, as a fraction of their path beyond it: limbs shrink to bundles, not to points."""


@dataclass(frozen=True, eq=False)
class SolidGraph:
    """Points in the fine solid and on its boundary, joined where the segment between them stays inside."""

    points: FloatArray
    """(N, 2) positions."""
    component: IntArray
    """(N,) fine component."""
    node_of_vertex: IntArray
    """(n,) node of each fine vertex."""
    edges: IntArray
    """(K, 2) joined nodes."""
    depth: FloatArray
    """(N,) depth below the boundary of the coarse component, in margins of its nearest edge; negative outside."""


@dataclass(frozen=True, eq=False)
class Retraction:
    """The steps of a retraction."""

    steps: list[FloatArray]
    """Positions (n, 2), without the fine mesh itself."""
    pieces: Obstacle | None
    """The obstacle if the coarse mesh cuts the fine solid into pieces."""


def solid_graph(matching: Matching, margins: FloatArray, spacing: Spacing) -> SolidGraph:
    """The graph of a pair of meshes; margins: (m,) per coarse edge, lengths."""
    fine, coarse = matching.fine, matching.coarse
    boundary = fine_samples(fine, spacing)
    at = fine.vertices[boundary.edge]
    on_boundary = at + boundary.parameter[:, None] * (fine.vertices[fine.successor[boundary.edge]] - at)
    inner = np.concatenate([_scattered(fine), *_below(coarse, margins, spacing)])
    owner = _component_of(inner, fine)
    inner, owner = inner[owner >= 0], owner[owner >= 0]
    points = np.concatenate([on_boundary, inner])
    component = np.concatenate([fine.component_of_loop[fine.loop_of_vertex[boundary.edge]], owner])

    # samples are stored edge by edge, the vertex first
    first = np.nonzero(boundary.parameter == 0.0)[0]
    node_of_vertex = np.empty(len(fine.vertices), np.int64)
    node_of_vertex[boundary.edge[first]] = first
    following = np.arange(1, len(boundary.edge) + 1)
    last = np.append(first[1:], len(boundary.edge)) - 1
    following[last] = node_of_vertex[fine.successor[boundary.edge[last]]]
    along = np.stack([np.arange(len(boundary.edge)), following], axis=1)
    edges = np.concatenate([along, _inside_edges(points, fine)])
    return SolidGraph(points, component, node_of_vertex, edges, _depth(points, component, matching, margins))


def retract(matching: Matching, graph: SolidGraph, longest_step: float, *, whole: bool) -> Retraction | Obstacle:
    """Move all vertices to the core; whole: to all its pieces, else only to the largest one of each component."""
    fine = matching.fine
    core = graph.depth > CORE_DEPTH
    pieces = _pieces(matching, graph, core)
    note = _cut(graph, core, pieces)
    if not whole:
        core = _largest_pieces(graph, core, pieces)
    edges = graph.edges
    lengths = np.hypot(*(graph.points[edges[:, 0]] - graph.points[edges[:, 1]]).T) + SHORTEST_GRAPH_EDGE * fine.extent
    size = len(graph.points)
    network = scipy.sparse.csr_matrix((lengths, (edges[:, 0], edges[:, 1])), shape=(size, size))
    if not core.any():
        return Obstacle("The fine and the coarse mesh do not overlap", remedy="move the coarse mesh over the fine one")
    distance, step_to, _ = scipy.sparse.csgraph.dijkstra(
        network, directed=False, indices=np.nonzero(core)[0], min_only=True, return_predecessors=True
    )
    node = graph.node_of_vertex.copy()
    total = distance[node]
    if not np.isfinite(total).all():
        vertex = int(np.nonzero(~np.isfinite(total))[0][0])
        x, y = fine.vertices[vertex].tolist()
        loop = fine.loop_of_vertex[vertex]
        return Obstacle(f"The part of fine loop {loop} at vertex {vertex} does not overlap the coarse mesh", (x, y))
    longest = float(total.max())
    count = int(np.ceil(longest / longest_step))
    steps = []
    for step in range(1, count + 1):
        front = longest * (1.0 - step / count)
        wanted = np.where(total > front, front + FRONT_LAG * (total - front), total)
        steps.append(_walk(graph.points, distance, step_to, node, wanted))
    return Retraction(steps, note)


def _walk(
    points: FloatArray, distance: FloatArray, step_to: IntArray, node: IntArray, wanted: FloatArray
) -> FloatArray:
    """Positions on the paths at the wanted distances from the core; advances ``node`` to the last nodes before them."""
    while True:
        ahead = step_to[node]
        passed = (ahead >= 0) & (distance[np.maximum(ahead, 0)] > wanted)
        if not passed.any():
            break
        node[passed] = ahead[passed]
    ahead = np.where(ahead >= 0, ahead, node)
    gap = distance[node] - distance[ahead]
    share = np.divide(distance[node] - wanted, gap, out=np.zeros_like(gap), where=gap > 0.0)
    return np.asarray(points[node] + share[:, None] * (points[ahead] - points[node]), np.float64)


def _scattered(mesh: Mesh) -> FloatArray:
    """(SCATTERED_POINTS, 2) evenly spread points, without the cocircular quadruples of a grid."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    steps = np.arange(1, SCATTERED_POINTS + 1)[:, None] / np.array([PLASTIC, PLASTIC**2])
    return np.asarray(low + (steps % 1.0) * (high - low), np.float64)


def _below(coarse: Mesh, margins: FloatArray, spacing: Spacing) -> list[FloatArray]:
    """Rows of points below the coarse edges."""
    samples = coarse_samples(coarse, spacing)
    start = coarse.vertices[samples.edge]
    direction = coarse.vertices[coarse.successor[samples.edge]] - start
    inwards = rotated_left(direction) / np.maximum(np.hypot(*direction.T), TINY)[:, None]
    on_edge = start + samples.parameter[:, None] * direction
    return [on_edge + depth * margins[samples.edge][:, None] * inwards for depth in INSETS]


def _component_of(points: FloatArray, fine: Mesh) -> IntArray:
    """(P,) fine component whose solid holds each point, -1 outside."""
    around = windings(points, fine, fine.vertices)
    by_component = np.zeros((len(points), int(fine.component_of_loop.max()) + 1), np.int64)
    np.add.at(by_component.T, fine.component_of_loop, around.T)
    return np.where((by_component > 0).any(axis=1), by_component.argmax(axis=1), -1)


def _inside_edges(points: FloatArray, fine: Mesh) -> IntArray:
    """(K, 2) edges of the Delaunay triangulation of the points that lie inside the solid."""
    noise = np.random.default_rng(0).uniform(-JITTER, JITTER, points.shape)
    triangles = scipy.spatial.Delaunay(points + fine.extent * noise).simplices
    edges = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0).astype(np.int64)
    a, b = points[edges[:, 0]], points[edges[:, 1]]
    inside = _component_of(0.5 * (a + b), fine) >= 0
    edges, a, b = edges[inside], a[inside], b[inside]
    tree, _ = loop_tree(fine, fine.vertices)
    hit, _ = crossing_pairs(BoxTree(a + TRIMMED_ENDS * (b - a), b + TRIMMED_ENDS * (a - b)), tree)
    clear = np.ones(len(edges), bool)
    clear[hit] = False
    return np.asarray(edges[clear], np.int64)


def _depth(points: FloatArray, component: IntArray, matching: Matching, margins: FloatArray) -> FloatArray:
    coarse = matching.coarse
    depth = np.empty(len(points))
    inside = matching.component[component]
    for k in np.unique(inside):
        start = np.concatenate([coarse.loops[loop] for loop in matching.coarse_loops_of(int(k))])
        here = inside == k
        sample = SignedDistance(coarse.vertices[start], coarse.vertices[coarse.successor[start]]).at(points[here])
        depth[here] = -sample.distance / np.maximum(margins[start[sample.edge]], TINY)
    return depth


def _pieces(matching: Matching, graph: SolidGraph, core: BoolArray) -> IntArray:
    """(N,) piece of the core that each node belongs to; -1 outside the core."""
    coarse = matching.coarse
    edges = graph.edges[core[graph.edges].all(axis=1)]
    hit, _ = crossing_pairs(
        BoxTree(graph.points[edges[:, 0]], graph.points[edges[:, 1]]), loop_tree(coarse, coarse.vertices)[0]
    )
    clear = np.ones(len(edges), bool)
    clear[hit] = False
    edges = edges[clear]
    size = len(graph.points)
    network = scipy.sparse.csr_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(size, size))
    _, piece = scipy.sparse.csgraph.connected_components(network, directed=False)
    return np.asarray(np.where(core, piece, -1), np.int64)


def _largest_pieces(graph: SolidGraph, core: BoolArray, pieces: IntArray) -> BoolArray:
    """The core reduced to the piece with most nodes in each component."""
    kept = np.zeros(len(core), bool)
    for k in np.unique(graph.component[core]):
        numbers, counts = np.unique(pieces[core & (graph.component == k)], return_counts=True)
        kept |= core & (graph.component == k) & (pieces == numbers[counts.argmax()])
    return kept


def _cut(graph: SolidGraph, core: BoolArray, pieces: IntArray) -> Obstacle | None:
    """The obstacle if the coarse mesh cuts a component into pieces, at its second largest piece."""
    for k in np.unique(graph.component[core]):
        here = core & (graph.component == k)
        numbers, counts = np.unique(pieces[here], return_counts=True)
        if len(numbers) > 1:
            second = numbers[np.argsort(counts)[-2]]
            x, y = graph.points[here & (pieces == second)].mean(axis=0).tolist()
            cause = f"The coarse mesh cuts component {k} of the fine mesh into {len(numbers)} pieces, one of them"
            return Obstacle(cause, (x, y), "make the coarse mesh follow the fine one there, or let it be generated")
    return None
