"""Edges along certain directions: those of the axes, or of a transit map."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ..errors import Fault, NestingError, invalid_setting
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.precision import INPUT_ROUND_OFF, NEGLIGIBLE, ROUND_OFF
from ..geometry.vectors import cross, dot, norm, rotated_left
from .base import Bound, Constraint, Units

if TYPE_CHECKING:
    from ..decimation.outline import Lines, Outline
    from ..decimation.sampling import NormalFrame
    from ..solver.elimination import Elimination

TRANSIT = (0.0, 45.0, 90.0, 135.0)
"""The directions of transit maps, in degrees."""

LEAST_TURN = 5.0
"""Least angle in degrees between two directions: at smaller ones corners move far when edges move a little."""

BESIDE = 1e-3
"""Distance along a loop, in edges, between a vertex and the lines through it."""

FORWARD = 8.0
"""Distance of the contacts of such lines from the vertex, in shifts, so that others may meet them before it."""

ROUNDING, SINGLE_ROUNDING = 2.0**-50, 2.0**-22
"""Distance of the ends of an edge from a line, relative to the largest coordinate: along an axis and obliquely, which
few numbers are; a few roundings of float64 and of float32, which Blender stores."""


@dataclass(frozen=True)
class AxisAligned(Constraint):
    """All edges of the cage are along one of several directions."""

    degrees: tuple[float, ...] = (0.0, 90.0)
    """Angles from the x axis: by default those of both axes; (0, 45, 90, 135) as in transit maps."""
    must: bool = field(default=True, kw_only=True)

    def __post_init__(self) -> None:
        try:
            degrees = tuple(sorted({float(angle) % 180.0 for angle in self.degrees}))
        except (TypeError, ValueError):
            degrees = ()
        turns = np.diff([*degrees, degrees[0] + 180.0]) if degrees else np.zeros(1)
        if len(degrees) < 2 or not turns.min() >= LEAST_TURN:
            raise invalid_setting(
                f"AxisAligned: degrees must be at least two angles that differ by {LEAST_TURN:g} or more, not "
                f"{self.degrees!r}."
            )
        object.__setattr__(self, "degrees", degrees)

    @property
    def tangents(self) -> FloatArray:
        """(2K, 2) unit vectors of the directions, both ways; exact along the axes."""
        angle = np.radians(self.degrees)
        ahead = np.stack((np.cos(angle), np.sin(angle)), axis=1)
        ahead[np.abs(ahead) < INPUT_ROUND_OFF] = 0.0
        return np.concatenate((ahead, -ahead))

    def candidates(self, outline: Outline, at: IntArray, lines: Lines, frame: NormalFrame, shift: float) -> Lines:
        """Lines along the directions that touch the stretches from each place on, instead of others.

        Each twice, before and behind its contact: at the reflex corners of stairs one ends where the next one begins.
        """
        from ..decimation.outline import Lines
        from ..decimation.tangents import STRETCHES, supporting_lines

        turned = frame.into(frame.centre + frame.scale * self.tangents)
        parts = []
        for stretch in (0, *(stretch for stretch in STRETCHES if stretch < len(at))):
            last = np.roll(at, -stretch)
            last = np.where(last < at, last + outline.size, last)
            parts += [supporting_lines(outline, at, last, np.broadcast_to(way, (len(at), 2))) for way in turned]
        lines = Lines.joined(parts).ordered(outline)
        both = []
        for way, touches in zip((-1.0, 1.0), _touching(outline, lines, 0.0), strict=True):
            some = lines.take(touches)
            point = some.point + way * FORWARD * shift * some.direction
            both.append(some.but(point=point, place=np.mod(some.place + way * BESIDE, outline.size)))
        lines = Lines.joined(both)
        return lines.take(np.lexsort((outline.turned(lines.place, lines.direction), lines.place)))

    def reach(self, outline: Outline, lines: Lines, shift: float) -> FloatArray:
        """Lines that touch the loop only before a vertex end there, and those that touch it only behind begin there."""
        from ..decimation.turns import SLACK

        before, behind = _touching(outline, lines, shift)
        way = lines.place - _contact(lines)
        last = max(FORWARD * shift - SLACK, ROUND_OFF)
        return np.stack((np.where((way < 0.0) & ~behind, last, np.inf), np.where((way > 0.0) & ~before, last, np.inf)))

    def snapped(self, coarse: Mesh, steps: FloatArray, side: int) -> FloatArray:
        """Steps with their edges exactly along the directions. Raises NestingError where those of the mesh are not."""
        bound = self._bound(coarse)
        if bound is not None:
            elimination = bound.eliminated(None, coarse.loop_order.walked(side).successor)
            return np.stack([_through_farthest(elimination, step) for step in steps])
        if not self.must:
            return steps
        raise NestingError(
            f"No start was found whose edges are along {self._in_words}; use more vertices, or allow more directions.",
            code="edges.not_aligned",
        )

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        """Each edge keeps its direction."""
        return self._bound(coarse) or Bound()

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        """Exact along the axes, but for the rounding of images under a rotation; else as single precision allows."""
        edge, largest = cage.edge_ends - cage.vertices, float(np.abs(cage.vertices).max())
        tangent = _nearest_tangent(edge, self.tangents)
        off = np.abs(cross(tangent, edge))
        off[off <= largest * np.where((tangent == 0.0).any(axis=1), ROUNDING, SINGLE_ROUNDING)] = 0.0
        k = int(np.argmax(off))
        if off[k] == 0.0:
            return None
        x, y = cage.vertices[k].tolist()
        return Fault(
            f"The edge at ({x:.6g}, {y:.6g}) is not along {self._in_words}, and {int((off > 0.0).sum())} of "
            f"{len(edge)} edges are not: use more vertices, or allow more directions.",
            "edges.not_aligned",
            place=(x, y),
        )

    @property
    def _in_words(self) -> str:
        return "an axis" if self.degrees == (0.0, 90.0) else f"{', '.join(f'{angle:g}' for angle in self.degrees)}°"

    def _bound(self, coarse: Mesh) -> BoundDirections | None:
        """The bound of a mesh whose edges are along the directions, to the accuracy of lines; else None."""
        edge = coarse.edge_ends - coarse.vertices
        tangent = _nearest_tangent(edge, self.tangents)
        off = np.abs(cross(tangent, edge))
        if not (off <= np.maximum(NEGLIGIBLE * norm(edge), ROUND_OFF * coarse.diagonal)).all():
            return None
        return BoundDirections(tangent, coarse.successor)


@dataclass(frozen=True, eq=False)
class BoundDirections(Bound):
    """Edges keep their directions, by elimination."""

    tangent: FloatArray
    """(m, 2) unit vector of each edge."""
    following: IntArray
    """(m,) its end."""

    def eliminated(self, images: Elimination | None, successor: IntArray) -> Elimination:
        """An offset of each line, and slides within them."""
        from ..solver.elimination import Elimination

        # walked backwards, the edge from a vertex is that of its successor
        tangent = np.where((successor == self.following)[:, None], self.tangent, -self.tangent[successor])
        return Elimination.of_lines(tangent, np.ones(len(tangent), bool), successor, images)

    def allowed(self, vertex: IntArray, start: FloatArray, end: FloatArray) -> BoolArray:
        """Edges along their directions."""
        tangent, edge = self.tangent[vertex], end - start
        return np.asarray((np.abs(cross(tangent, edge)) <= ROUND_OFF * norm(edge)) & (dot(tangent, edge) > 0.0))


def _through_farthest(elimination: Elimination, cage: FloatArray) -> FloatArray:
    """(m, 2) a cage (m, 2) with each line through that of its vertices that is farthest out."""
    assert elimination.tangent is not None
    reading = np.concatenate(elimination.readings(cage))
    block = elimination.block.ravel()
    inwards = dot(rotated_left(elimination.tangent)[block], reading)
    unknowns = np.empty((len(elimination.tangent), 2))
    order = np.argsort(-inwards, kind="stable")
    unknowns[block[order]] = reading[order]  # the last value written stays
    return elimination.motion(unknowns)


def _contact(lines: Lines) -> FloatArray:
    """(K,) the places of the contacts of lines, vertices or middles between them."""
    return np.asarray(np.round(2.0 * lines.place) / 2.0)


def _touching(outline: Outline, lines: Lines, shift: float) -> tuple[BoolArray, BoolArray]:
    """(K,) whether the outline before, and behind, the contact of each line lies to its left.

    shift: of the lines from the outline. Lines that touch it elsewhere, next to both sides of it, do.
    """
    contact = _contact(lines)
    ahead, vertex = np.ceil(contact).astype(np.int64), np.floor(contact).astype(np.int64) % outline.size
    before, behind = (
        np.mod(cross_angle, 2.0 * np.pi)
        for cross_angle in (
            _turn(outline.edges[ahead - 1], lines.direction) + ROUND_OFF,
            _turn(lines.direction, outline.edges[vertex]) + ROUND_OFF,
        )
    )
    height = cross(lines.direction, outline.vertices[vertex] - lines.point)
    elsewhere = np.abs(height - shift) > 0.5 * shift + ROUND_OFF * outline.length
    convex = before + behind < np.pi + 4.0 * ROUND_OFF
    one, other = before < np.pi, behind < np.pi
    left = one & other & ~convex  # the line touches a reflex corner from within
    return elsewhere | (one & ~left), elsewhere | (other & ~left)


def _turn(one: FloatArray, other: FloatArray) -> FloatArray:
    """(K,) angles from directions (K, 2) to others."""
    return np.asarray(np.arctan2(cross(one, other), dot(one, other)))


def _nearest_tangent(edge: FloatArray, tangents: FloatArray) -> FloatArray:
    """(m, 2) the unit vector of some (K, 2) that is closest to each edge (m, 2)."""
    closest: FloatArray = tangents[np.argmax(edge @ tangents.T, axis=1)]
    return closest
