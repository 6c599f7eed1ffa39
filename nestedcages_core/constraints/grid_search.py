"""A cage of least area whose vertices lie on a grid.

Every vertex gets a layer of nearby grid points. Whether an edge keeps its distance depends only on its two ends, and
the area is a sum over edges, so the best choice of one point per layer is a shortest cycle, found by dynamic
programming. This is repeated with layers around the choice until nothing improves. A line separates edges that are near
each other, so that loops stay simple. The result is certified elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from ..energies.base import EdgeCost
from ..errors import NestedCagesError
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.broad_phase import expanded, near_pairs, position_in_group
from ..geometry.distance import point_edge
from ..geometry.lattice import Grid
from ..geometry.mesh import Mesh
from ..geometry.precision import MOST_ROUNDS, NEGLIGIBLE, ROUND_OFF
from ..geometry.shortest_cycle import shortest_cycle
from ..geometry.signed_distance import SignedDistance
from ..geometry.vectors import cross, norm, rotated_right
from ..progress import Tick, no_tick
from .free_edges import FreeEdges, Near

Allowed: TypeAlias = Callable[[IntArray, FloatArray, FloatArray], BoolArray]
"""(K,) whether the edges from vertices (K,) may run from starts (K, 2) to ends (K, 2)."""

REACHES = (1, 2, 3, 4)
"""Reach of first layers around a vertex and its path outwards, in grid steps; larger ones where no cage is found."""

AROUND = ((2, 2), (3, 1))
"""Reaches around a choice to improve, of vertices by turns: the next where the one before finds nothing better."""

FEW, AROUND_FEW = 8, ((2, 2), (3, 3))
"""Vertices up to which all reach farther at once, which takes little time then."""

MAX_PUSH = 6.0
"""Largest displacement of a vertex, in grid steps, that first layers allow for."""

MAX_LAYER = 72
"""Maximum number of points of a layer; the closest ones are kept."""


def put_on_grid(
    cage: Mesh,
    fine: Mesh,
    grid: Grid,
    allowed: Allowed | None,
    *,
    clearance: float,
    side: int,
    edge_cost: EdgeCost | None = None,
    tick: Tick = no_tick,
) -> tuple[FloatArray | None, BoolArray]:
    """(m, 2) grid points for the vertices of a cage around a fine mesh, or inside it; None if none were found. And (m,)
    the vertices at which edges have no place then.

    allowed: tells which edges may be; None: all. clearance: smallest distance to keep from the fine mesh, above 0, as
    in the coordinates of the meshes. edge_cost: what is minimised; None: the area. tick: called with a fraction after
    each improvement, which ends where it raises a NestedCagesError. Raises NestingError if no points were found within
    `MOST_TESTS`.
    """
    search = _CoordinateDescent(cage, fine, grid, allowed, clearance, side, edge_cost)
    found: IntArray | None = None
    reach = np.zeros(len(cage.vertices), np.int64)
    while found is None:
        found, stuck = search.chosen(search.first_layers(np.take(REACHES, reach)))
        nowhere = stuck.copy()
        stuck &= reach < len(REACHES) - 1
        if found is None and not stuck.any():
            return None, nowhere
        reach += stuck
    reaches = list(AROUND if len(cage.vertices) > FEW else AROUND_FEW)
    for number in range(MOST_ROUNDS):
        try:
            tick(1.0 - 1.0 / (1.0 + number))
            better, _ = search.chosen(search.layers_around(found, reaches[0]))
        except NestedCagesError:  # of the work, or the time, that it may take
            break
        if better is not None and search.cost(better) < search.cost(found):
            found = better
        elif not (reaches := reaches[1:]):
            break
    return grid.points(found), nowhere


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
    allowed: Allowed | None
    clearance: float
    side: int
    """1 for a cage around the fine mesh, -1 for one inside it."""
    edge_cost: EdgeCost | None
    free: FreeEdges = field(init=False)

    def __post_init__(self) -> None:
        self.distance = SignedDistance.of(self.fine)
        self.origin = self.grid.places(self.cage.vertices.mean(axis=0))
        self.known: dict[tuple[bytes, bytes], FloatArray] = {}
        self.free = FreeEdges(self.cage, self.fine, self.clearance, f"No cage on the grid of {self.grid.spacing:.6g}")

    def cost(self, places: IntArray) -> float:
        """Of a choice (m, 2)."""
        ends = places[self.cage.successor]
        if self.edge_cost is None:
            return float(self._costs(0, places, ends).sum())
        return float(sum(self._costs(k, places[k : k + 1], ends[k : k + 1])[0] for k in range(len(places))))

    def _costs(self, edge: int, one: IntArray, other: IntArray) -> FloatArray:
        """(K,) of an edge between places (K, 2): its share of the energy, in squared steps, and of the length."""
        along = NEGLIGIBLE * norm((other - one).astype(np.float64))
        if self.edge_cost is not None:
            share = self.edge_cost(edge, self.grid.points(one), self.grid.points(other)) / self.grid.spacing**2
            return np.asarray(share + along)
        a, b = (one - self.origin).astype(np.float64), (other - self.origin).astype(np.float64)
        return np.asarray(0.5 * self.side * cross(a, b) + along)

    def first_layers(self, reach: IntArray) -> _Layers:
        """Points within a reach (m,) of each vertex and its path outwards when its edges are shifted by a step."""
        cage, step = self.cage, self.grid.spacing
        along = cage.edge_ends - cage.vertices
        n = self.side * rotated_right(along) / norm(along)[:, None]
        corner = n + n[cage.predecessor]
        push = 2.0 * corner / np.maximum((corner**2).sum(axis=1), 1e-12)[:, None]
        push *= np.minimum(1.0, MAX_PUSH / np.maximum(norm(push), 1e-12))[:, None] * step
        samples = 1 + np.ceil(2.0 * norm(push) / step).astype(np.int64)
        vertex = np.arange(len(samples)).repeat(samples)
        share = position_in_group(samples) / np.maximum(samples - 1, 1)[vertex]
        base, square = self.grid.places(cage.vertices), _square(max(reach))
        away = self.grid.places(cage.vertices[vertex] + share[:, None] * push[vertex]) - base[vertex]
        held = np.abs(square).max(axis=1) <= reach[vertex][:, None]
        half = int(MAX_PUSH) + 1 + max(REACHES)
        shape = len(base), 2 * half + 1, 2 * half + 1
        code = (vertex[:, None] * shape[1] + away[:, :1] + square[:, 0] + half) * shape[2] + away[:, 1:] + square[:, 1]
        vertex, x, y = np.unravel_index(np.unique(code[held] + half), shape)
        near = base[vertex] + np.column_stack([x, y]) - half
        far = point_edge(self.grid.points(near), cage.vertices[vertex], (cage.vertices + push)[vertex]).distance
        near = near[np.lexsort((far, vertex))]
        layers = np.split(near, np.flatnonzero(np.diff(vertex)) + 1)
        return self._allowed(_Layers(cage.vertices, [layer[:MAX_LAYER] for layer in layers]))

    def layers_around(self, choice: IntArray, reaches: tuple[int, int]) -> _Layers:
        """Points around those of a choice (m, 2), of vertices by turns."""
        squares = [_square(reach) for reach in reaches]
        places = [place + squares[k % 2] for k, place in enumerate(choice)]
        return self._allowed(_Layers(self.grid.points(choice), places))

    def _allowed(self, layers: _Layers) -> _Layers:
        """The layers without points that are too close to the fine mesh or beyond a line between two edges."""
        sizes = [len(layer) for layer in layers.places]
        together = np.concatenate(layers.places)
        points = self.grid.points(together)
        owner = np.repeat(np.arange(len(sizes)), sizes)
        good = self.side * self.distance.at(points).distance >= self.clearance
        begins = np.cumsum([0, *sizes])
        away = norm(points - layers.centres[owner])
        far = np.array([part.max(initial=0.0) for part in np.split(away, begins[1:-1])])
        vertex, place, normal = _walls(self.cage, layers.centres, 2.0 * float(away.max()))
        beyond = ((layers.centres[vertex] - place) * normal).sum(axis=1) + far[vertex]
        cuts = beyond >= -2.0 * ROUND_OFF * self.grid.spacing
        vertex, place, normal = vertex[cuts], place[cuts], normal[cuts]
        wall, k = expanded(begins[vertex], np.array(sizes)[vertex])
        inside = ((points[k] - place[wall]) * normal[wall]).sum(axis=1) < -ROUND_OFF * self.grid.spacing
        good[k[~inside]] = False
        return _Layers(
            layers.centres,
            [layer[kept] for layer, kept in zip(layers.places, np.split(good, begins[1:-1]), strict=True)],
        )

    def chosen(self, layers: _Layers) -> tuple[IntArray | None, BoolArray]:
        """(m, 2) the choice of least cost whose edges all keep their distance, and (m,) where larger layers may help.

        None if there is none. Raises NestingError after `MOST_TESTS`.
        """
        stuck = np.array([len(layer) == 0 for layer in layers.places])
        if stuck.any():
            return None, stuck
        costs = self._edge_costs(layers)
        stuck = np.array([not np.isfinite(each).any() for each in costs])
        if stuck.any():
            return None, stuck | stuck[self.cage.predecessor]
        places = np.zeros((len(layers.places), 2), np.int64)
        for loop in self.cage.loops:
            picked = shortest_cycle([costs[vertex] for vertex in loop])
            if picked is None:
                stuck[loop] = True
                continue
            for vertex, k in zip(loop, picked, strict=True):
                places[vertex] = layers.places[vertex][k]
        return (None if stuck.any() else places), stuck

    def _edge_costs(self, layers: _Layers) -> list[FloatArray]:
        """For each edge (K, K') its costs from each point of its layer to each of the next; infinite where it is too
        close."""
        following = [layers.places[vertex] for vertex in self.cage.successor]
        keys = [(one.tobytes(), other.tobytes()) for one, other in zip(layers.places, following, strict=True)]
        if any(key not in self.known for key in keys):
            both = zip(layers.places, layers.centres, strict=True)
            far = np.array([norm(self.grid.points(layer) - centre).max() for layer, centre in both])
            near = self.free.near(layers.centres, far)
            for edge, key in enumerate(keys):
                if key not in self.known:
                    self.known[key] = self._costs_between(edge, layers.places[edge], following[edge], near[edge])
        return [self.known[key] for key in keys]

    def _costs_between(self, edge: int, here: IntArray, there: IntArray, near: Near) -> FloatArray:
        """The same for one edge, from places (K, 2) to others (K', 2)."""
        shape = len(here), len(there)
        i, j = np.indices(shape).reshape(2, -1)
        one, other = here[i], there[j]
        kept = np.flatnonzero((one != other).any(axis=1))
        p, q = self.grid.points(here)[i], self.grid.points(there)[j]
        if self.allowed is not None:
            kept = kept[self.allowed(np.full(len(kept), edge), p[kept], q[kept])]
        kept = kept[self.free.are_free(p[kept], q[kept], near)]
        costs = np.full(len(one), np.inf)
        costs[kept] = self._costs(edge, one[kept], other[kept])
        return costs.reshape(shape)


def _square(reach: int) -> IntArray:
    """(K, 2) steps of up to ``reach`` in both directions."""
    side = np.arange(-reach, reach + 1)
    steps: IntArray = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    return steps


def _walls(cage: Mesh, vertices: FloatArray, radius: float) -> tuple[IntArray, FloatArray, FloatArray]:
    """Vertices (W,), and lines that they do not cross, by points (W, 2) and normals (W, 2) to the other side.

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
    normal, edge, other = near.normal[closest], edge[closest], other[closest]
    middle = vertices[point[closest]] - 0.5 * near.distance[closest, None] * normal
    kept = np.concatenate([edge, cage.successor[edge], other, cage.successor[other]])
    return kept, np.tile(middle, (4, 1)), np.concatenate([-normal, -normal, normal, normal])
