"""Point-edge pairs of fine mesh and cage, in lists that stay valid while nothing moves far.

All positions are in one array x = (C; F) of shape (m + n, 2): the m cage vertices first, then the n fine vertices.
Pairs come in three families, in this order: F-C (fine vertex, cage edge), C-F (cage vertex, fine edge) and C-C (cage
vertex, cage edge that does not end in it). There are no F-F pairs: the fine mesh may cross itself as it moves, since
its final shape does not.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.broad_phase import BoxTree
from ..geometry.distance import PointEdge, point_edge
from ..geometry.loops import Loops
from ..geometry.mesh import Mesh
from ..geometry.predicates import crossing_pairs
from ..solver.banded import BandOrder
from ..solver.quadratic_program import InteriorPoint, QPSolution, QuadraticProgram

if TYPE_CHECKING:
    from ..constraints.base import Bound
    from ..solver.elimination import Elimination


@dataclass(frozen=True, eq=False)
class Bodies:
    """What stays constant during contact: connectivity, and boundary lengths."""

    coarse: Mesh
    """The cage at rest, before it is pushed."""
    cage: Loops
    """Its loops; those of a cage inside the fine mesh are walked backwards."""
    fine: Loops
    """Those of the fine mesh, walked alike."""
    fine_weight: FloatArray
    """(n,) boundary length of each fine vertex: half of its two edges, in the fine mesh itself."""
    cage_edge_length: float
    """Mean length of the coarse edges, the unit of motions of the cage."""
    elimination: Elimination | None = None
    """The unknowns of a cage with equalities, such as a symmetric one; None: all vertices are free."""
    bounds: tuple[Bound, ...] = ()
    """What the cage keeps next to its distances."""
    clearances: FloatArray | None = None
    """(n,) distance to keep from each fine vertex and its edge, where that is more than the clearance; None: none."""

    @classmethod
    def of(
        cls,
        coarse: Mesh,
        fine: Mesh,
        *,
        side: int = 1,
        bounds: tuple[Bound, ...] = (),
        clearances: FloatArray | None = None,
    ) -> Bodies:
        """side: 1 for a cage around the fine mesh, -1 for one inside it."""
        lengths, cage = fine.edge_lengths, coarse.loop_order.walked(side)
        elimination: Elimination | None = None
        for bound in bounds:
            elimination = bound.eliminated(elimination, cage.successor)
        return cls(
            coarse,
            cage,
            fine.loop_order.walked(side),
            0.5 * (lengths + lengths[fine.predecessor]),
            float(coarse.edge_lengths.mean()),
            elimination,
            bounds,
            clearances,
        )

    def short(self, cage: FloatArray) -> FloatArray | None:
        """(m,) the most that a cage (m, 2) lacks of its bounds at each vertex; None without bounds."""
        if not self.bounds:
            return None
        from ..constraints.base import short_of

        return short_of(self.bounds, cage)

    @cached_property
    def of_vertex(self) -> FloatArray | None:
        """(m + n,) the clearances, as indices into x = (C; F)."""
        return None if self.clearances is None else np.concatenate([np.zeros(self.m), self.clearances])

    @property
    def m(self) -> int:
        """Number of cage vertices."""
        return len(self.coarse.vertices)

    @property
    def n(self) -> int:
        """Number of fine vertices."""
        return len(self.fine.numbers)

    def first_contact(self, x: FloatArray) -> int | None:
        """Index into x = (C; F) of a vertex whose edge meets the cage; None if nothing meets it; exact.

        From a contained start and by collision-free motion, containment cannot be lost in any other way. (Gurditta &
        Jacobson 2022, section 3.2, use the parity of ray crossings, which fails for rays through a vertex.)
        """
        cage, fine = self.trees(x)
        edge, _ = crossing_pairs(fine, cage)
        if len(edge):
            return self.m + int(edge[0])
        one, other = crossing_pairs(cage)
        apart = (self.cage.successor[one] != other) & (self.cage.successor[other] != one)
        return int(one[apart][0]) if apart.any() else None

    def trees(self, x: FloatArray) -> tuple[BoxTree, BoxTree]:
        """The edges of cage and fine mesh at x = (C; F), each by its start."""
        ends = x.take(self.successor, axis=0)
        return BoxTree(x[: self.m], ends[: self.m]), BoxTree(x[self.m :], ends[self.m :])

    def solved(self, solver: InteriorPoint, program: QuadraticProgram, absolute: float, order: BandOrder) -> QPSolution:
        """The solution of a program over the cage vertices that keeps its equalities; order: see :attr:`order`."""
        if self.elimination is None:
            return solver.solve(program, absolute, order)
        return self.elimination.solve(solver, program, absolute, order)

    def scaled(self, motion: FloatArray, fraction: FloatArray) -> FloatArray:
        """A motion of the cage, (m, 2), or of all, (m + n, 2), of which each vertex takes at most a fraction; the cage
        keeps its equalities."""
        scaled: FloatArray = fraction[:, None] * motion
        if self.elimination is not None:
            scaled[: self.m] = self.elimination.scaled(motion[: self.m], fraction[: self.m])
        return scaled

    def longest(self, motion: FloatArray) -> FloatArray:
        """(m, 2) a motion of the cage that keeps its equalities, as long as those of a motion (m, 2)."""
        return motion if self.elimination is None else self.elimination.longest(motion)

    @cached_property
    def order(self) -> BandOrder:
        """An order of the cage vertices, or of their unknowns, that keeps neighbours close together."""
        if self.elimination is not None:
            return self.elimination.order
        return BandOrder.along(self.cage)

    @cached_property
    def successor(self) -> IntArray:
        """(m + n,) next vertex, as indices into x = (C; F)."""
        return np.concatenate([self.cage.successor, self.fine.successor + self.m])

    @cached_property
    def predecessor(self) -> IntArray:
        """(m + n,) previous vertex, as indices into x = (C; F)."""
        return np.concatenate([self.cage.predecessor, self.fine.predecessor + self.m])


class Pairs(NamedTuple):
    """K point-edge pairs as indices into x = (C; F), family by family."""

    point: IntArray
    start: IntArray
    end: IntArray
    fine_cage: slice
    cage_fine: slice
    cage_cage: slice

    def __len__(self) -> int:
        return len(self.point)

    @property
    def corners(self) -> IntArray:
        """(K, 3) the vertices of each pair: point, start and end of the edge."""
        return np.stack([self.point, self.start, self.end], axis=1)

    def measure(self, x: FloatArray) -> PointEdge:
        """Distances of all pairs at x (m + n, 2)."""
        return point_edge(x.take(self.point, axis=0), x.take(self.start, axis=0), x.take(self.end, axis=0))

    def approach(self, reach: FloatArray) -> FloatArray:
        """(K,) how much closer each pair can come if no vertex moves farther than ``reach`` (m + n,)."""
        closer: FloatArray = reach.take(self.point) + np.maximum(reach.take(self.start), reach.take(self.end))
        return closer

    def take(self, keep: BoolArray | IntArray) -> Pairs:
        """The pairs where ``keep`` (K,) is true, or at these indices in increasing order."""
        kept = np.flatnonzero(keep) if keep.dtype == bool else keep
        first, second = (int(end) for end in kept.searchsorted((self.fine_cage.stop, self.cage_fine.stop)))
        return Pairs(
            self.point.take(kept), self.start.take(kept), self.end.take(kept),
            slice(0, first), slice(first, second), slice(second, len(kept)),
        )  # fmt: skip


def find_pairs(bodies: Bodies, x: FloatArray, radius: float) -> Pairs:
    """All pairs closer than ``radius`` at the positions x = (C; F), family C-C up to twice that; F-C by cage edge.

    Both sides of a pair C-C may move: with twice the radius a `CandidateList` lasts as long as for the others.
    """
    m, successor = bodies.m, bodies.successor
    cage, fine = bodies.trees(x)
    fine_vertex, cage_edge = cage.near(fine.starts, radius)
    cage_vertex, fine_edge = fine.near(cage.starts, radius)
    own_vertex, own_edge = cage.near(cage.starts, 2.0 * radius)
    foreign = (own_vertex != own_edge) & (own_vertex != successor[own_edge])
    start = np.concatenate([cage_edge, fine_edge + m, own_edge[foreign]])
    first, second = len(fine_vertex), len(fine_vertex) + len(cage_vertex)
    return Pairs(
        np.concatenate([fine_vertex + m, cage_vertex, own_vertex[foreign]]),
        start,
        successor.take(start),
        slice(0, first),
        slice(first, second),
        slice(second, len(start)),
    )


class CandidateList:
    """The pairs closer than a reach, found with a skin so that the list stays complete for a while (a Verlet list).

    A pair comes closer by at most the sum of the two largest motions since the list was built. The list is rebuilt when
    that exceeds the skin. No skin is thinner than ``thinnest_skin``, a length.
    """

    def __init__(self, bodies: Bodies, thinnest_skin: float = 0.0) -> None:
        self.bodies, self.thinnest_skin = bodies, thinnest_skin
        self.builds = 0
        self._radius = 0.0
        self._x = self._moved = self._distance = np.zeros(0)
        self._pairs: Pairs | None = None

    def within(self, x: FloatArray, reach: float, skin: float) -> Pairs:
        """A superset of the pairs closer than ``reach`` at x; if rebuilt, the list covers ``skin`` on top."""
        if self._pairs is not None:
            moved = x - self._x
            self._moved = np.sqrt(moved[:, 0] * moved[:, 0] + moved[:, 1] * moved[:, 1])
            if self._covers(reach):
                return self._pairs
        self._radius = reach + max(skin, self.thinnest_skin)
        self._x, self._moved = x.copy(), np.zeros(len(x))
        self._pairs = find_pairs(self.bodies, x, self._radius)
        self._distance = self._pairs.measure(x).distance
        self.builds += 1
        return self._pairs

    def meeting(self, x: FloatArray, distance: float, motion: FloatArray, reach: float, skin: float) -> Pairs:
        """The pairs of :meth:`within` that may come closer than ``distance`` when no vertex moves farther than
        ``motion`` (m + n,)."""
        pairs = self.within(x, reach, skin)
        return pairs.take(np.flatnonzero(self._distance - distance <= pairs.approach(self._moved + motion)))

    def _covers(self, reach: float) -> bool:
        """Whether the skin is wider than any pair of cage and fine mesh has come closer since the list was built."""
        m = self.bodies.m
        return self._radius - reach >= float(self._moved[:m].max()) + float(self._moved[m:].max())


@dataclass(frozen=True)
class WantedDistances:
    """Distances to keep; both lengths."""

    clearance: float
    """Between cage and fine mesh."""
    own: float
    """Between parts of the cage."""
    apart: float = field(default=0.0, kw_only=True)
    """Between loops of the cage, if that is more."""
    loop: IntArray | None = field(default=None, kw_only=True)
    """(m,) the loop of each vertex of the cage, where it matters."""
    of_vertex: FloatArray | None = field(default=None, kw_only=True)
    """(m + n,) between the cage and each fine vertex and its edge, where that is more; 0 for vertices of the cage."""

    @property
    def largest(self) -> float:
        """The largest of them."""
        return max(self.largest_clearance, self.own, self.apart)

    @property
    def largest_clearance(self) -> float:
        """The largest between cage and fine mesh."""
        return self.clearance if self.of_vertex is None else max(self.clearance, float(self.of_vertex.max()))

    def of(self, pairs: Pairs) -> FloatArray:
        """(K,) wanted distance of each pair."""
        wanted = np.full(len(pairs), self.clearance)
        if self.of_vertex is not None:
            for family, vertex in ((pairs.fine_cage, pairs.point), (pairs.cage_fine, pairs.start)):
                wanted[family] = np.maximum(self.clearance, self.of_vertex[vertex[family]])
        own = pairs.cage_cage
        wanted[own] = self.own
        if self.loop is not None:
            between = self.loop[pairs.point[own]] != self.loop[pairs.start[own]]
            wanted[own] = np.where(between, max(self.own, self.apart), self.own)
        return wanted
