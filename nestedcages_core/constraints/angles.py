"""Angles between neighbouring edges of a cage, inside or outside, whichever is smaller: as numbers and as rows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import radians

import numpy as np

from ..geometry.arrays import TINY, FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.vectors import cross, dot, norm, rotated_left
from ..solver.banded import Rows
from .base import Bound, Terms

ANGLE_MARGIN = 1e-7
"""Fraction added to a least angle, for rounding."""


def angles_of(mesh: Mesh) -> FloatArray:
    """(n,) angle at each vertex, in degrees."""
    ahead, back = mesh.edge_ends - mesh.vertices, mesh.vertices[mesh.predecessor] - mesh.vertices
    angle: FloatArray = np.degrees(np.arctan2(np.abs(cross(ahead, back)), dot(ahead, back)))
    return angle


@dataclass(frozen=True, eq=False)
class BoundAngle(Bound):
    """No angle is smaller than this. A room is an angle times the shorter of its edges, so that it is a length."""

    before: IntArray
    """(m,) the neighbours of each vertex."""
    after: IntArray
    least: float
    """In radians."""

    @classmethod
    def of(cls, coarse: Mesh, degrees: float) -> BoundAngle:
        """For cages with the edges of a coarse mesh."""
        return cls(coarse.predecessor, coarse.successor, radians(degrees) * (1.0 + ANGLE_MARGIN))

    def rows(self, cage: FloatArray, radius: float) -> Iterator[Terms]:
        """Three vertices each: an angle from p to q turns by rotated_left(p) / p² and rotated_left(q) / q²."""
        p, q = cage[self.before] - cage, cage[self.after] - cage
        room = self._rooms(p, q)
        near = np.flatnonzero(room < 6.0 * radius)  # both edges turn by motions of √2 radii of both ends
        p, q = p[near], q[near]
        arm = np.sign(cross(p, q)) * np.minimum(norm(p), norm(q))
        of_p = -(arm / np.maximum(dot(p, p), TINY))[:, None] * rotated_left(p)
        of_q = (arm / np.maximum(dot(q, q), TINY))[:, None] * rotated_left(q)
        vertex = np.stack((near, self.before[near], self.after[near]))
        direction = np.stack((-(of_p + of_q).T, of_p.T, of_q.T))
        yield Terms(Rows(vertex, np.ones(vertex.shape), direction), room[near])

    def short(self, cage: FloatArray) -> FloatArray:
        """What an angle lacks, at its three vertices."""
        lack = np.maximum(-self._rooms(cage[self.before] - cage, cage[self.after] - cage), 0.0)
        return np.asarray(np.maximum(lack, np.maximum(lack[self.after], lack[self.before])))

    def _rooms(self, p: FloatArray, q: FloatArray) -> FloatArray:
        """(m,) of the angles from p to q (m, 2)."""
        angle = np.arctan2(np.abs(cross(p, q)), dot(p, q))
        return np.asarray((angle - self.least) * np.minimum(norm(p), norm(q)))
