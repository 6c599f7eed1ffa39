"""The weighted excess."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.vectors import cross, rotated_left, rotated_right
from .base import Blocks, CageEnergy

EDGE_SAMPLES = (np.arange(8) + 0.5) / 8
"""Places along an edge, as fractions of it, whose weights are averaged."""

MAX_BACKWARDS = 0.2
"""Fraction of a loop up to which the closest points of an edge's ends may be in reverse order."""


@dataclass(frozen=True, eq=False)
class WeightedArea(CageEnergy):
    """Σ w A over the edges a → b, with the area A between each edge and the fine mesh and a weight w.

    A is the area of the polygon from a to b, to the closest point f_b of the fine mesh, along that to f_a and back to
    a: ½ (a × b + b × f_b - a × f_a) and a constant. With equal weights the sum is the area of the cage without that of
    the fine mesh. Weights and points f are those of the cage at the beginning of the tightening.
    """

    weight_at: Callable[[FloatArray], FloatArray]
    """Weights (P,) at points (P, 2)."""
    fine: FineOutline
    successor: IntArray
    """(m,) of the cage."""
    weight: FloatArray
    """(m,) weight of the edge that starts at each vertex."""
    anchor: FloatArray
    """(m, 2) f."""
    constant: float
    side: int
    """1 around the fine mesh, -1 inside it."""

    @classmethod
    def of(
        cls,
        cage: FloatArray,
        successor: IntArray,
        fine: Mesh,
        weight_at: Callable[[FloatArray], FloatArray],
        *,
        side: int = 1,
    ) -> WeightedArea:
        """The energy at a cage (m, 2); side: -1 for one inside the fine mesh."""
        return cls(weight_at, FineOutline(fine), successor, np.ones(len(cage)), cage, 0.0, side).after(cage)

    def after(self, cage: FloatArray) -> WeightedArea:
        """The energy with weights and anchors of another cage (m, 2)."""
        points = cage[:, None] + EDGE_SAMPLES[:, None] * (cage[self.successor] - cage)[:, None]
        weight = self.side * self.weight_at(points.reshape(-1, 2)).reshape(points.shape[:2]).mean(axis=1)
        anchor, swept = self.fine.swept(cage, self.successor)
        return replace(self, weight=weight, anchor=anchor, constant=-float(weight @ swept))

    def value(self, vertices: FloatArray, successor: IntArray) -> float:
        """A length²."""
        following, anchor = vertices[successor], self.anchor
        twice = cross(vertices, following) + cross(following, anchor[successor]) - cross(vertices, anchor)
        return 0.5 * float(self.weight @ twice) + self.constant

    def on_edge(self, vertex: int, start: FloatArray, end: FloatArray) -> FloatArray:
        """(K,) weighted areas between the edge and its stretch of the fine mesh, up to a constant."""
        here, there = self.anchor[vertex], self.anchor[self.successor[vertex]]
        twice = cross(start, end) + cross(end, np.broadcast_to(there, end.shape))
        return np.asarray(0.5 * self.weight[vertex] * (twice - cross(start, np.broadcast_to(here, start.shape))))

    def gradient(self, vertices: FloatArray, successor: IntArray) -> FloatArray:
        """(m, 2)."""
        half = 0.5 * self.weight[:, None]
        gradient: FloatArray = half * rotated_right(vertices[successor] - self.anchor)
        gradient[successor] += half * rotated_right(self.anchor[successor] - vertices)
        return gradient

    def hessian(self, vertices: FloatArray, successor: IntArray) -> Blocks:
        """Constant: the block ½ w (0 1; -1 0) for each edge a → b."""
        blocks = 0.5 * self.weight[:, None, None] * rotated_left(np.eye(2))
        return Blocks(np.arange(len(successor)), successor, blocks)


def weighted(
    coarse: Mesh, outline: Mesh, weight_at: Callable[[FloatArray], FloatArray], side: int, *, hulls: bool
) -> CageEnergy:
    """The weighted area of cages with the edges of a coarse mesh; hulls: of convex cages, as line cycles weigh it.

    For these one weight per edge leads away: edges from where weights are high to where they are low cost too much.
    """
    energy = WeightedArea.of(coarse.vertices, coarse.successor, outline, weight_at, side=side)
    if not hulls:
        return energy
    from .corner_area import CornerArea

    return CornerArea.of(coarse, outline, weight_at, energy.after(coarse.vertices))


class FineOutline:
    """The fine mesh, for closest points and for the areas that stretches between them sweep around the origin."""

    def __init__(self, fine: Mesh) -> None:
        self.fine = fine
        self.edges = fine.edge_search
        self.length, self.area = np.empty(len(fine.vertices)), np.empty(len(fine.vertices))
        self.lengths, self.areas = np.empty(len(fine.loops)), np.empty(len(fine.loops))
        steps = 0.5 * cross(fine.vertices, fine.edge_ends)
        for k, loop in enumerate(fine.loops):
            for of_vertex, of_loop, step in (
                (self.length, self.lengths, fine.edge_lengths),
                (self.area, self.areas, steps),
            ):
                sums = np.cumsum(step[loop])
                of_vertex[loop], of_loop[k] = sums - step[loop], sums[-1]

    def swept(self, cage: FloatArray, successor: IntArray) -> tuple[FloatArray, FloatArray]:
        """Closest points (m, 2) of the cage's vertices, and the area (m,) from that of each to that of the next."""
        close = self.edges.closest(cage)
        start, point = self.edges.starts[close.edge], close.between(self.edges.starts, self.edges.ends)
        loop = self.fine.loop_of_vertex[close.edge]
        place = self.length[close.edge] + close.parameter * self.fine.edge_lengths[close.edge]
        area = self.area[close.edge] + 0.5 * cross(start, point)
        # the way from one to the next, which may begin before the first vertex of a loop and end after it
        whole = self.lengths[loop]
        way = (place[successor] - place) / whole
        turns = -np.floor(way + MAX_BACKWARDS)
        swept = area[successor] - area + turns * self.areas[loop]
        other = loop != loop[successor]
        swept[other] = 0.5 * cross(point, point[successor])[other]
        return point, swept
