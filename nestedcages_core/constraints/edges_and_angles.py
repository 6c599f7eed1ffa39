"""A least length of the cage's edges, and a least angle between them: as numbers, and as rows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from math import radians

import numpy as np

from ..errors import Fault, invalid_setting, note
from ..geometry.arrays import TINY, BoolArray, FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.precision import NEGLIGIBLE, ROUND_OFF
from ..geometry.vectors import cross, dot, norm, rotated_left
from ..solver.banded import Rows
from .base import Bound, Constraint, Terms, Units

LENGTH_MARGIN, ANGLE_MARGIN = 1e-9, 1e-7
"""Fractions added to a least length and a least angle, for rounding."""

FILLED = 0.8
"""Fraction of an outline's length up to which edges of least length can be placed freely along it."""

OF_A_BOX = 4
"""Vertices that each loop may have in any case: those of a box."""

NO_FOLDS = 15.0
"""Least angle in degrees if edges have a least length: without it, edges without space would fold into spikes."""


@dataclass(frozen=True)
class LeastAngle(Constraint):
    """No angle between neighbouring edges is sharper than this, inside or outside."""

    degrees: float
    """Above 0 and below 60, which no triangle exceeds."""
    must: bool = field(default=True, kw_only=True)

    def __post_init__(self) -> None:
        if not isinstance(self.degrees, int | float | np.number) or not 0.0 < float(self.degrees) < 60.0:
            raise invalid_setting(f"min_angle must be above 0 and below 60 degrees, not {self.degrees!r}.")

    @property
    def turn_limits(self) -> tuple[float, float]:
        """The angle."""
        return 0.0, self.degrees

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        """Rows of three vertices."""
        return BoundAngle.of(coarse, self.degrees)

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        """The sharpest angle, to round-off."""
        ahead, back = cage.edge_ends - cage.vertices, cage.vertices[cage.predecessor] - cage.vertices
        angles = np.degrees(np.arctan2(np.abs(cross(ahead, back)), dot(ahead, back)))
        k = int(np.argmin(angles))
        wanted, given = self.degrees, float(angles[k])
        if given >= wanted:
            return None
        if not self.must:
            return note("note.angle", wanted=wanted, given=given)
        (x, y), but = cage.vertices[k].tolist(), "ask for less, or for another number of vertices"
        sentence = f"The angle at ({x:.6g}, {y:.6g}) has {given:.4g}°; at least {wanted:.4g}° is asked for: {but}."
        return Fault(sentence, "angle.sharp", wanted=wanted, given=given, place=(x, y))


@dataclass(frozen=True)
class LeastEdge(Constraint):
    """No edge is shorter than a length."""

    length: float
    must: bool = field(default=True, kw_only=True)

    def __post_init__(self) -> None:
        if not isinstance(self.length, int | float | np.number) or not 0.0 < float(self.length) < np.inf:
            raise invalid_setting(f"min_edge must be a finite length above 0, not {self.length!r}.")

    def of(self, about: Mesh, side: int) -> LeastEdge:
        """The same, unless it is so much longer than the drawing that areas would overflow."""
        if NEGLIGIBLE * self.length > about.diagonal:
            sentence = (
                f"min_edge={self.length:.6g} is much longer than the diagonal of the drawing, {about.diagonal:.6g}."
            )
            raise invalid_setting(sentence, name="min_edge", value=self.length)
        return self

    def count(self, outline: Mesh, count: int) -> int:
        """At most as many vertices as edges of this length fit along the outline."""
        lengths = [float(outline.edge_lengths[loop].sum()) for loop in outline.loops]
        return min(count, sum(max(OF_A_BOX, int(FILLED * length / self.length)) for length in lengths))

    @property
    def turn_limits(self) -> tuple[float, float]:
        """The length."""
        return self.length, 0.0

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        """Rows of two vertices, and those of angles against folds."""
        least = (1.0 + LENGTH_MARGIN) * self.length / units.scale
        return BoundEdge(coarse.successor, least, BoundAngle.of(coarse, NO_FOLDS))

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        """Exact, also where the rounded length is the wanted one."""
        lengths, wanted = cage.edge_lengths, self.length
        short = [k for k in np.flatnonzero(lengths < (1.0 + ROUND_OFF) * wanted) if _is_shorter(cage, k, wanted)]
        if not short:
            return None
        k = min(short, key=lambda k: float(lengths[k]))
        given = float(lengths[k])
        if not self.must:  # a length that is told as the wanted one is no news
            return None if given >= (1.0 - NEGLIGIBLE) * wanted else note("note.edge", wanted=wanted, given=given)
        (x, y), but = cage.vertices[k].tolist(), "ask for less, or for fewer vertices"
        sentence = f"The edge at ({x:.6g}, {y:.6g}) is {given:.6g} long; at least {wanted:.6g} is asked for: {but}."
        return Fault(sentence, "edge.short", wanted=wanted, given=given, place=(x, y))


@dataclass(frozen=True, eq=False)
class BoundEdge(Bound):
    """The least length in the units of the solvers."""

    successor: IntArray
    least: float
    folds: BoundAngle

    def rows(self, cage: FloatArray, radius: float) -> Iterator[Terms]:
        """A length is convex: steps that keep its tangent keep it."""
        edge = cage[self.successor] - cage
        length = norm(edge)
        near = np.flatnonzero(length - self.least < 3.0 * radius)  # both ends move by at most √2 radii
        direction = edge[near] / np.maximum(length[near], TINY)[:, None]
        weight = np.tile([[-1.0], [1.0]], len(near))
        yield Terms(Rows(np.stack((near, self.successor[near])), weight, direction.T), (length - self.least)[near])
        yield from self.folds.rows(cage, radius)

    def allowed(self, vertex: IntArray, start: FloatArray, end: FloatArray) -> BoolArray:
        """Edges as long as asked for."""
        return np.asarray(norm(end - start) >= (1.0 - LENGTH_MARGIN) * self.least)


@dataclass(frozen=True, eq=False)
class BoundAngle(Bound):
    """The least angle, in radians. A room is an angle times the shorter of its edges, so that it is a length."""

    before: IntArray
    """(m,) the neighbours of each vertex."""
    after: IntArray
    least: float

    @classmethod
    def of(cls, coarse: Mesh, degrees: float) -> BoundAngle:
        """For cages with the edges of a coarse mesh."""
        return cls(coarse.predecessor, coarse.successor, radians(degrees) * (1.0 + ANGLE_MARGIN))

    def rows(self, cage: FloatArray, radius: float) -> Iterator[Terms]:
        """Three vertices each: an angle from p to q turns by rotated_left(p) / p² and rotated_left(q) / q²."""
        p, q = cage[self.before] - cage, cage[self.after] - cage
        angle = np.arctan2(np.abs(cross(p, q)), dot(p, q))
        room = (angle - self.least) * np.minimum(norm(p), norm(q))
        near = np.flatnonzero(room < 6.0 * radius)  # both edges turn by motions of √2 radii of both ends
        p, q = p[near], q[near]
        arm = np.sign(cross(p, q)) * np.minimum(norm(p), norm(q))
        of_p = -(arm / np.maximum(dot(p, p), TINY))[:, None] * rotated_left(p)
        of_q = (arm / np.maximum(dot(q, q), TINY))[:, None] * rotated_left(q)
        vertex = np.stack((near, self.before[near], self.after[near]))
        direction = np.stack((-(of_p + of_q).T, of_p.T, of_q.T))
        yield Terms(Rows(vertex, np.ones(vertex.shape), direction), room[near])


def _is_shorter(cage: Mesh, k: int, length: float) -> bool:
    """Whether the edge from vertex k is shorter than a length, exactly."""
    x, y = (Fraction(float(b)) - Fraction(float(a)) for a, b in zip(cage.vertices[k], cage.edge_ends[k], strict=True))
    return x * x + y * y < Fraction(length) ** 2
