"""An obstacle that the cage stays clear of."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..errors import Fault, NestingError
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import BoxTree, near_pairs
from ..geometry.convex_hull import convex_hull
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh, MeshLike
from ..geometry.precision import ROUND_OFF
from ..geometry.predicates import crossing_pairs, winding_number
from ..geometry.smallest_gap import smallest_gap
from ..geometry.vectors import cross
from ..parameters import check_not_negative
from ..solver.banded import Rows
from .base import Bound, Constraint, Terms, Units

if TYPE_CHECKING:
    from ..decimation.outline import Lines
    from ..decimation.sampling import NormalFrame

OBSTACLE_MARGIN = 1e-7
"""Fraction added to a distance, for rounding; without a distance the same part of the drawing's diagonal."""

WAYS, MOST_STARTS = 48, 16
"""Directions of the ways out of a bay, and vertices of the obstacle that they start from, at most."""

WAY_ROOM = 0.25
"""Distance that lines keep from a way out, as a fraction of its own from the drawing: walls of the cage pass by."""


@dataclass(frozen=True, eq=False)
class Outside(Constraint):
    """The cage's solid and that of a second shape have nothing in common, and their outlines keep a distance."""

    obstacle: MeshLike
    distance: float = 0.0
    """In the input's units."""
    must: bool = field(default=True, kw_only=True)
    wall: tuple[FloatArray, float] | None = field(default=None, kw_only=True, repr=False)
    """A segment (2, 2) out of the bay that the obstacle lies in, and a distance from it: lines that do not cross it
    leave the obstacle outside."""

    def __post_init__(self) -> None:
        check_not_negative(self, "distance")
        object.__setattr__(self, "obstacle", Mesh.of(self.obstacle).validated())

    @property
    def shape(self) -> Mesh:
        """The obstacle."""
        assert isinstance(self.obstacle, Mesh)
        return self.obstacle

    def of(self, about: Mesh, side: int) -> Outside:
        """The obstacle. Raises NestingError where the drawing itself meets it."""
        if side < 0:
            return self
        fault = self.fault(about, about)
        if fault is not None:
            raise NestingError(fault.said(f"The drawing is not clear of the obstacle: {fault}"))
        return replace(self, wall=_way_out(self.shape, about))

    def free(self, lines: Lines, frame: NormalFrame) -> FloatArray:
        """Lines end at the obstacle, and at its way out."""
        start, end = frame.into(self.shape.vertices), frame.into(self.shape.edge_ends)
        inside, room = winding_number(lines.point, start, end) != 0, np.full(len(start), self.distance)
        if self.wall is not None:
            wall = frame.into(self.wall[0])
            start, end, room = np.vstack((start, wall[:1])), np.vstack((end, wall[1:])), np.append(room, self.wall[1])
        edge, to = (end - start)[None], start[None] - lines.point[:, None]
        along = np.broadcast_to(lines.direction[:, None], to.shape)
        sine = cross(along, edge)
        with np.errstate(divide="ignore", invalid="ignore"):
            reach, place = cross(to, edge) / sine, cross(to, along) / sine
        hit, room = (sine != 0.0) & (place >= 0.0) & (place <= 1.0), room / frame.scale
        free = [np.where(hit & (way * reach >= 0.0), way * reach - room, np.inf).min(axis=1) for way in (1.0, -1.0)]
        return np.where(inside, -1.0, np.stack(free))

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        """Pairs of a vertex of one of the two and an edge of the other."""
        least = max(self.distance / units.scale * (1.0 + OBSTACLE_MARGIN), OBSTACLE_MARGIN)
        shape = self.shape
        return BoundOutside(units.points(shape.vertices), shape.successor, coarse.successor, least)

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        """Exact for crossings and for what lies in each other; the distance to round-off."""
        shape, gap = self.shape, 0.0
        ours, theirs = (cage.vertices, cage.edge_ends), (shape.vertices, shape.edge_ends)
        met = len(crossing_pairs(cage.edge_tree, shape.edge_tree)[0]) > 0 or _overlap(ours, theirs)
        if not met:
            gap = smallest_gap(cage.edge_tree, shape.edge_tree)
            if gap >= self.distance * (1.0 - ROUND_OFF):
                return None
        x, y = shape.vertices[0].tolist()
        what = "meets" if met else f"comes as near as {gap:.6g} to"
        return Fault(
            f"The cage {what} the obstacle at ({x:.6g}, {y:.6g}); {self.distance:.6g} is asked for: use more vertices, "
            "or move the obstacle to where a straight way leads out of the drawing.",
            "obstacle.met",
            clearance=gap,
            wanted=self.distance,
            place=(x, y),
        )


@dataclass(frozen=True, eq=False)
class BoundOutside(Bound):
    """The obstacle in the units of the solvers."""

    points: FloatArray
    """(k, 2) its vertices."""
    following: IntArray
    """(k,) successor of each."""
    successor: IntArray
    """(m,) of the vertices of the cage."""
    least: float

    @cached_property
    def ends(self) -> FloatArray:
        """(k, 2) ends of its edges."""
        return self.points[self.following]

    def rows(self, cage: FloatArray, radius: float) -> Iterator[Terms]:
        """Distances to first order: n · (D_p - (1 - t) D_a - t D_b)."""
        reach, ends = self.least + 3.0 * radius, cage[self.successor]
        vertex, of = near_pairs(cage, self.points, self.ends, reach)
        pair = point_edge(cage[vertex], self.points[of], self.ends[of])
        yield Terms(Rows(vertex[None], np.ones((1, len(vertex))), pair.normal.T), pair.distance - self.least)
        point, edge = near_pairs(self.points, cage, ends, reach)
        pair = point_edge(self.points[point], cage[edge], ends[edge])
        weight = np.stack((pair.parameter - 1.0, -pair.parameter))
        yield Terms(Rows(np.stack((edge, self.successor[edge])), weight, pair.normal.T), pair.distance - self.least)

    def short(self, cage: FloatArray) -> FloatArray:
        """What the nearest pairs lack; a cage around the obstacle, or in it, lacks everything."""
        return super().short(cage) + _overlap((cage, cage[self.successor]), (self.points, self.ends))


def _way_out(obstacle: Mesh, about: Mesh) -> tuple[FloatArray, float] | None:
    """The straight way out for an obstacle that lies in the convex hull of a drawing; None without, or where none is.

    Of the ways from its vertices in several directions, it is the one that is farthest from the drawing.
    """
    hull = about.vertices[convex_hull(about.vertices)]
    starts = obstacle.vertices[winding_number(obstacle.vertices, hull, np.roll(hull, -1, axis=0)) != 0][:MOST_STARTS]
    angle = 2.0 * np.pi * np.arange(WAYS) / WAYS
    ahead = (about.diagonal + obstacle.diagonal) * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    start, end = np.repeat(starts, WAYS, axis=0), (starts[:, None] + ahead).reshape(-1, 2)
    clear = np.ones(len(start), bool)
    clear[crossing_pairs(BoxTree(start, end), about.edge_tree)[0]] = False
    if not clear.any():
        return None
    start, end = start[clear], end[clear]
    room = point_edge(about.vertices[None], start[:, None], end[:, None]).distance.min(axis=1)
    k = int(room.argmax())
    return np.stack((start[k], end[k])), WAY_ROOM * float(room[k])


def _overlap(ours: tuple[FloatArray, FloatArray], theirs: tuple[FloatArray, FloatArray]) -> bool:
    """Whether a vertex of one of two solids lies in the other; by the starts and ends of their edges."""
    return bool((winding_number(theirs[0], *ours) != 0).any() or (winding_number(ours[0], *theirs) != 0).any())
