"""A least length of the cage's edges."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from math import hypot

import numpy as np

from ..decimation.base import MIN_PER_LOOP
from ..errors import Fault, invalid_setting, note
from ..geometry.arrays import TINY, BoolArray, FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.precision import NEGLIGIBLE, ROUND_OFF
from ..geometry.vectors import norm
from ..solver.banded import Rows
from .angles import BoundAngle
from .base import Bound, Constraint, Terms, Units

LENGTH_MARGIN = 1e-9
"""Fraction added to a least length, for rounding."""

FILLED = 0.8
"""Fraction of the edges of least length that fit along an outline up to which edges can be placed freely."""

NO_FOLDS = 15.0
"""Least angle in degrees if edges have a least length: without it, edges without space would fold into spikes."""


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
            raise invalid_setting(
                f"min_edge={self.length:.6g} is more than {1.0 / NEGLIGIBLE:.0g} times as long as the diagonal of the "
                f"drawing, {about.diagonal:.6g}; ask for less.",
                name="min_edge",
                value=self.length,
            )
        return self

    def count(self, outline: Mesh, count: int) -> int:
        """At most as many vertices as edges of this length fit along the outline."""
        loops = [outline.vertices[loop] for loop in outline.loops]
        return min(count, sum(max(MIN_PER_LOOP, int(FILLED * _divided(loop, self.length))) for loop in loops))

    @property
    def turn_limits(self) -> tuple[float, float]:
        """The length."""
        return self.length, 0.0

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        """Rows of two vertices, and those of angles against folds."""
        least = (1.0 + LENGTH_MARGIN) * self.length / units.scale
        return BoundEdge(coarse.successor, coarse.predecessor, least, BoundAngle.of(coarse, NO_FOLDS))

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        """Exact, also where the rounded length is the wanted one."""
        lengths = cage.edge_lengths
        k = int(np.argmin(lengths))
        if lengths[k] >= (1.0 + ROUND_OFF) * self.length:
            return None
        near = np.flatnonzero(lengths < (1.0 + ROUND_OFF) * self.length)
        if all(_is_as_long(cage.vertices[i], cage.edge_ends[i], self.length) for i in near):
            return None
        wanted, given = self.length, float(lengths[k])
        if not self.must:  # a length that is told as the wanted one is no news
            return None if given >= (1.0 - NEGLIGIBLE) * wanted else note("note.edge", wanted=wanted, given=given)
        x, y = cage.vertices[k].tolist()
        return Fault(
            f"The edge at ({x:.6g}, {y:.6g}) has a length of {given:.6g}; at least {wanted:.6g} is asked for: ask for "
            "less, or for fewer vertices.",
            "edge.short",
            wanted=wanted,
            given=given,
            place=(x, y),
        )


@dataclass(frozen=True, eq=False)
class BoundEdge(Bound):
    """The least length in the units of the solvers."""

    successor: IntArray
    predecessor: IntArray
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

    def short(self, cage: FloatArray) -> FloatArray:
        """What an edge lacks, at both ends."""
        lack = np.maximum(self.least - norm(cage[self.successor] - cage), 0.0)
        return np.asarray(np.maximum(np.maximum(lack, lack[self.predecessor]), self.folds.short(cage)))


def _is_as_long(start: FloatArray, end: FloatArray, length: float) -> bool:
    """Whether an edge has at least a length, exactly."""
    x, y = (Fraction(float(b)) - Fraction(float(a)) for a, b in zip(start, end, strict=True))
    return x * x + y * y >= Fraction(length) ** 2


def _divided(loop: FloatArray, length: float) -> int:
    """Number of steps of a given length that fit along a loop (k, 2), as with a pair of dividers."""
    x, y = loop[0].tolist()
    steps = 0
    for u, v in [*loop[1:].tolist(), loop[0].tolist()]:
        distance = hypot(u - x, v - y)
        fitting = int(distance / length)
        if fitting:
            share = fitting * length / distance
            x, y = x + share * (u - x), y + share * (v - y)
            steps += fitting
    return steps
