"""A cage of least area whose vertices lie on a grid.

Every vertex gets a layer of nearby grid points. Whether an edge keeps its distance depends only on its two ends, and
the area is a sum over edges, so the best choice of one point per layer is a shortest cycle, found by dynamic
programming. This is repeated with layers around the choice until nothing improves. A line separates edges that are near
each other, so that loops stay simple. The result is certified elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from ..energies.base import EdgeCost
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.broad_phase import CHUNK_PAIRS, near_pairs, split_by
from ..geometry.distance import point_edge
from ..geometry.lattice import Grid
from ..geometry.mesh import Mesh
from ..geometry.precision import MOST_ROUNDS, NEGLIGIBLE, ROUND_OFF
from ..geometry.predicates import winding_number
from ..geometry.shortest_cycle import shortest_cycle
from ..geometry.signed_distance import SignedDistance
from ..geometry.vectors import cross, norm, rotated_right
from ..tasks import Stage

FIRST_REACHES = (1, 2, 4)
"""Reach of first layers around a vertex and its path outwards, in grid steps; larger ones where no cage is found."""

LATER_REACHES = (2, 3)
"""The same around a choice to improve: the next one is used where the previous one finds nothing better."""

MAX_PUSH = 6.0
"""Largest displacement of a vertex, in grid steps, that first layers allow for."""

MAX_LAYER = 72
"""Maximum number of points of a layer; the closest ones are kept."""


def put_on_grid(
    cage: Mesh,
    fine: Mesh,
    grid: Grid,
    *,
    clearance: float,
    side: int,
    edge_cost: EdgeCost | None = None,
    rounds: int = MOST_ROUNDS,
) -> Stage[float, FloatArray | None]:
    """(m, 2) grid points for the vertices of a cage around a fine mesh, or inside it; None if none were found.

    clearance: smallest distance to keep from the fine mesh, above 0, as in the coordinates of the meshes. edge_cost:
    what is minimised; None: the area. rounds: of improvements, at most. A generator: yields a fraction after each.
    """
    search = _CoordinateDescent(cage, fine, grid, clearance, side, edge_cost)
    found: IntArray | None = None
    for reach in FIRST_REACHES:
        found = search.chosen(search.first_layers(reach))
        yield 0.25
        if found is not None:
            break
    if found is None:
        return None
    reaches = list(LATER_REACHES)
    for number in range(rounds):
        better = search.chosen(search.layers_around(found, reaches[0]))
        yield 1.0 - 0.75 / (2.0 + number)
        if better is not None and search.cost(better) < search.cost(found):
            found = better
        elif not (reaches := reaches[1:]):
            break
    return grid.points(found)


@dataclass(frozen=True, eq=False)
class _Layers:
    """The candidate points."""

    centres: FloatArray
    """(m, 2) a cage whose edges are apart from each other."""
    places: list[IntArray]
    """For each vertex (K, 2)."""


@dataclass(eq=False)
class _CoordinateDescent:
    cage: Mesh
    fine: Mesh
    grid: Grid
    clearance: float
    side: int
    """1 for a cage around the fine mesh, -1 for one inside it."""
    edge_cost: EdgeCost | None = None
    origin: IntArray = field(init=False)
    """(2,) origin of areas."""

    def __post_init__(self) -> None:
        self.distance = SignedDistance.of(self.fine)
        self.origin = self.grid.places(self.cage.vertices.mean(axis=0))
        self.known: dict[tuple[bytes, bytes], FloatArray] = {}

    def cost(self, places: IntArray) -> float:
        """Of a choice (m, 2)."""
        ends = places[self.cage.successor]
        if self.edge_cost is None:
            return float(self._costs(0, places, ends).sum())
        return float(sum(self._costs(k, places[k : k + 1], ends[k : k + 1])[0] for k in range(len(places))))

    def _costs(self, vertex: int, one: IntArray, other: IntArray) -> FloatArray:
        """(K,) of an edge between places (K, 2): its share of the energy, in squared steps, and of the length."""
        if self.edge_cost is not None:
            p, q = self.grid.points(one), self.grid.points(other)
            shares = self.edge_cost(vertex, p, q) / self.grid.spacing**2
            return np.asarray(shares + NEGLIGIBLE * norm((other - one).astype(np.float64)))
        a, b = (one - self.origin).astype(np.float64), (other - self.origin).astype(np.float64)
        return np.asarray(0.5 * self.side * cross(a, b) + NEGLIGIBLE * norm(b - a))

    def first_layers(self, reach: int) -> _Layers:
        """Points near each vertex and its path outwards when its edges are shifted by a step."""
        cage, step = self.cage, self.grid.spacing
        along = cage.edge_ends - cage.vertices
        n = self.side * rotated_right(along) / norm(along)[:, None]
        both = n + n[cage.predecessor]
        push = 2.0 * both / np.maximum((both**2).sum(axis=1), 1e-12)[:, None]
        push *= np.minimum(1.0, MAX_PUSH / np.maximum(norm(push), 1e-12))[:, None] * step
        square = _square(reach)
        layers = []
        for start, way in zip(cage.vertices, push, strict=True):
            samples = 1 + int(np.ceil(2.0 * norm(way) / step))
            middles = start + np.linspace(0.0, 1.0, samples)[:, None] * way
            near = np.unique((self.grid.places(middles)[:, None] + square).reshape(-1, 2), axis=0)
            far = point_edge(self.grid.points(near), start, start + way).distance
            layers.append(near[np.argsort(far, kind="stable")[:MAX_LAYER]])
        return self._allowed(_Layers(cage.vertices, layers))

    def layers_around(self, choice: IntArray, reach: int) -> _Layers:
        """Points around those of a choice (m, 2)."""
        square = _square(reach)
        return self._allowed(_Layers(self.grid.points(choice), [place + square for place in choice]))

    def _allowed(self, layers: _Layers) -> _Layers:
        """The layers without points that are too close to the fine mesh or beyond a line between two edges."""
        sizes = [len(layer) for layer in layers.places]
        together = np.concatenate(layers.places)
        points = self.grid.points(together)
        good = self.side * self.distance.at(points).distance >= self.clearance
        owner = np.repeat(np.arange(len(sizes)), sizes)
        reach = float(norm(points - layers.centres[owner]).max())
        for vertex, place, normal in _walls(self.cage, layers.centres, 2.0 * reach):
            mine = np.flatnonzero(owner == vertex)
            good[mine] &= (points[mine] - place) @ normal < -ROUND_OFF * self.grid.spacing
        return _Layers(layers.centres, [together[(owner == k) & good] for k in range(len(sizes))])

    def chosen(self, layers: _Layers) -> IntArray | None:
        """(m, 2) the choice of least cost whose edges all keep their distance; None if there is none."""
        if min(len(layer) for layer in layers.places) == 0:
            return None
        costs: list[FloatArray] = [np.zeros(0)] * len(layers.places)
        near = self._near(layers)
        for vertex, (corners, edges) in enumerate(near):
            costs[vertex] = self._edge_costs(layers, vertex, corners, edges)
            if not np.isfinite(costs[vertex]).any():
                return None
        places = np.zeros((len(layers.places), 2), np.int64)
        for loop in self.cage.loops:
            picked = shortest_cycle([costs[vertex] for vertex in loop])
            if picked is None:
                return None
            for vertex, k in zip(loop, picked, strict=True):
                places[vertex] = layers.places[vertex][k]
        return places

    def _near(self, layers: _Layers) -> Iterator[tuple[IntArray, IntArray]]:
        """For each edge of the cage the fine vertices, and the fine edges by their starts, that its ends may meet."""
        fine, starts = self.fine, layers.centres
        ends = starts[self.cage.successor]
        far = np.array(
            [float(norm(self.grid.points(layer) - at).max()) for layer, at in zip(layers.places, starts, strict=True)]
        )
        far = np.maximum(far, far[self.cage.successor])
        radius = float(far.max()) + 2.0 * self.clearance
        corner, edge = near_pairs(fine.vertices, starts, ends, radius)
        point, line = near_pairs(starts, fine.vertices, fine.edge_ends, radius)
        by_edge = [corner[pairs] for pairs in split_by(edge, len(starts))]
        by_point = [line[pairs] for pairs in split_by(point, len(starts))]
        for vertex in range(len(starts)):
            corners = by_edge[vertex]
            distance = point_edge(fine.vertices[corners], starts[vertex], ends[vertex]).distance
            close = distance <= far[vertex] + 2.0 * self.clearance
            corners = corners[close][np.argsort(distance[close], kind="stable")]
            edges = (corners, fine.predecessor[corners], by_point[vertex], by_point[self.cage.successor[vertex]])
            yield corners, np.unique(np.concatenate(edges))

    def _edge_costs(self, layers: _Layers, vertex: int, corners: IntArray, edges: IntArray) -> FloatArray:
        """(K, K') costs of an edge from each point of its layer to each of the next; infinite where it is too close."""
        one, other = layers.places[vertex], layers.places[self.cage.successor[vertex]]
        key = one.tobytes(), other.tobytes()
        if key in self.known:
            return self.known[key]
        i, j = (each.ravel() for each in np.indices((len(one), len(other))))
        p, q = self.grid.points(one), self.grid.points(other)
        apart = (one[i] != other[j]).any(axis=1)
        i, j = i[apart], j[apart]
        for keep in (self._clear_of_corners, self._clear_of_edges):
            left = corners if keep == self._clear_of_corners else edges
            while len(left) and len(i):
                part, left = np.split(left, [max(1, CHUNK_PAIRS // len(i))])
                kept = keep(p[i], q[j], part)
                i, j = i[kept], j[kept]
        for loop in self._passed(corners):
            line = layers.centres[vertex], layers.centres[self.cage.successor[vertex]]
            kept = self._stays_beside(p[i], q[j], *line, self.fine.vertices[self.fine.loops[loop][0]])
            i, j = i[kept], j[kept]
        costs = np.full((len(one), len(other)), np.inf)
        costs[i, j] = self._costs(vertex, one[i], other[j])
        self.known[key] = costs
        return costs

    def _clear_of_corners(self, p: FloatArray, q: FloatArray, corners: IntArray) -> BoolArray:
        """(K,) whether segments p-q (K, 2) keep their distance from fine vertices."""
        x = self.fine.vertices[corners]
        distance = point_edge(x[None], p[:, None], q[:, None]).distance
        return np.asarray((distance >= self.clearance).all(axis=1))

    def _clear_of_edges(self, p: FloatArray, q: FloatArray, edges: IntArray) -> BoolArray:
        """(K,) whether segments p-q (K, 2) do not cross fine edges."""
        a, b = self.fine.vertices[edges][None], self.fine.edge_ends[edges][None]
        p, q = p[:, None], q[:, None]
        beside = cross(q - p, a - p) * cross(q - p, b - p) > 0.0
        beside |= cross(b - a, p - a) * cross(b - a, q - a) > 0.0
        return np.asarray(beside.all(axis=1))

    def _passed(self, corners: IntArray) -> IntArray:
        """Fine loops that lie as a whole next to an edge: it could pass them by, from one side to the other."""
        loops, counts = np.unique(self.fine.loop_of_vertex[corners], return_counts=True)
        whole: IntArray = loops[counts == self.fine.loop_order.sizes[loops]]
        return whole

    def _stays_beside(self, p: FloatArray, q: FloatArray, a: FloatArray, b: FloatArray, x: FloatArray) -> BoolArray:
        """(K,) whether the point x stays on its side of an edge that goes from a-b to p-q (K, 2)."""
        count = len(p)
        corners = np.stack([np.broadcast_to(a, p.shape), np.broadcast_to(b, p.shape), q, p], axis=1)
        # one quadrilateral after the other, each around its own copy of the point, far enough from the others
        step = np.zeros((count, 2))
        step[:, 0] = (
            4.0 * np.arange(count) * max(float(np.ptp(np.concatenate([corners.reshape(-1, 2), x[None]]))), 1e-300)
        )
        moved = corners + step[:, None]
        winding = winding_number(x + step, moved.reshape(-1, 2), np.roll(moved, -1, axis=1).reshape(-1, 2))
        return np.asarray(winding == 0)


def _square(reach: int) -> IntArray:
    """(K, 2) steps of up to ``reach`` in both directions."""
    side = np.arange(-reach, reach + 1)
    steps: IntArray = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    return steps


def _walls(cage: Mesh, vertices: FloatArray, radius: float) -> Iterator[tuple[int, FloatArray, FloatArray]]:
    """Vertices, and lines that they do not cross, each by a point and its normal to the other side.

    A line halves the shortest path between two edges closer than ``radius`` that share no vertex, and parts them.
    """
    ends = vertices[cage.successor]
    point, other = near_pairs(vertices, vertices, ends, radius)
    point, other = np.concatenate([point, point]), np.concatenate([other, other])
    edge = point.copy()
    edge[len(edge) // 2 :] = cage.predecessor[point[len(edge) // 2 :]]
    apart = (edge != other) & (cage.successor[edge] != other) & (cage.successor[other] != edge)
    point, edge, other = point[apart], edge[apart], other[apart]
    near = point_edge(vertices[point], vertices[other], ends[other])
    pair = np.minimum(edge, other) * len(vertices) + np.maximum(edge, other)
    order = np.lexsort((near.distance, pair))
    closest = order[np.diff(pair[order], prepend=-1) != 0]
    for k in closest.tolist():
        middle, normal = vertices[point[k]] - 0.5 * near.distance[k] * near.normal[k], near.normal[k]
        for start, away in ((edge[k], -normal), (other[k], normal)):
            yield int(start), middle, away
            yield int(cage.successor[start]), middle, away
