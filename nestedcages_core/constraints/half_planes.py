"""Half-planes that the cage stays in: a model for constraints that limit each vertex alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..errors import Fault, NestingError
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..solver.banded import Rows
from .base import Bound, Constraint, Terms, Units

if TYPE_CHECKING:
    from ..decimation.outline import Lines
    from ..decimation.sampling import NormalFrame

ROUNDINGS = 4.0
"""Width of the margin inside each half-plane, in roundings of the largest offset: cages return from other units."""


class HalfPlanes(Constraint):
    """No vertex of the cage lies outside of some half-planes; derived classes say which."""

    def planes(self) -> tuple[FloatArray, FloatArray]:
        """Unit normals (K, 2) and offsets (K,), in the input's units: normal · x ≥ offset inside."""
        raise NotImplementedError

    def of(self, about: Mesh, side: int) -> Constraint:
        """The half-planes. Raises NestingError where a drawing to be enclosed has no room in them."""
        if side > 0 and self._rooms(about.vertices).min(initial=np.inf) <= 0.0:
            raise NestingError(self._left(about, "There is no cage in the box: the drawing reaches beyond its border"))
        return self

    def free(self, lines: Lines, frame: NormalFrame) -> FloatArray:
        """Lines end where they leave a half-plane."""
        point = frame.out_of(lines.point)
        ahead = frame.out_of(lines.point + lines.direction) - point
        free = np.full((2, len(lines)), np.inf)
        for normal, room in zip(self.planes()[0], self._rooms(point), strict=True):
            for way, slope in enumerate((ahead @ normal, -(ahead @ normal))):
                reach = np.divide(-room, slope, out=np.full(len(room), np.inf), where=slope < 0.0)
                free[way] = np.minimum(free[way], np.where(room > 0.0, reach, -1.0))
        return free

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        """The half-planes, with a margin for rounding."""
        normals, offsets = self.planes()
        margin = ROUNDINGS * np.finfo(float).eps * float(np.abs(offsets).max(initial=0.0)) / units.scale
        return BoundHalfPlanes(normals, (normals * units.points(offsets[:, None] * normals)).sum(axis=1) + margin)

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        """Whether all vertices are inside; exact along the axes."""
        inside = self._rooms(cage.vertices).min(initial=np.inf) >= 0.0
        return None if inside else self._left(cage, "The cage leaves the box")

    def _rooms(self, points: FloatArray) -> FloatArray:
        """(K, P) how far points (P, 2) lie inside each half-plane."""
        return BoundHalfPlanes(*self.planes()).rooms(points)

    def _left(self, mesh: Mesh, what: str) -> Fault:
        """The vertex of a mesh that is farthest outside."""
        room = self._rooms(mesh.vertices).min(axis=0)
        k = int(np.argmin(room))
        (x, y), distance = mesh.vertices[k].tolist(), -float(room[k])
        where = f"by {distance:.3g} at ({x:.6g}, {y:.6g}); make the box larger there, or use more vertices."
        return Fault(f"{what} {where}", "box.left", place=(x, y), distance=distance)


@dataclass(frozen=True, eq=False)
class BoundHalfPlanes(Bound):
    """Half-planes in the units of the solvers."""

    normals: FloatArray
    offsets: FloatArray

    def rooms(self, points: FloatArray) -> FloatArray:
        """(K, P) how far points (P, 2) lie inside each half-plane."""
        rooms: FloatArray = self.normals @ points.T - self.offsets[:, None]
        return rooms

    def rows(self, cage: FloatArray, radius: float) -> Iterator[Terms]:
        """One vertex each."""
        for normal, room in zip(self.normals, self.rooms(cage), strict=True):
            near = np.flatnonzero(room < 1.5 * radius)
            yield Terms(Rows(near[None], np.ones((1, len(near))), np.tile(normal[:, None], len(near))), room[near])

    def allowed(self, vertex: IntArray, start: FloatArray, end: FloatArray) -> BoolArray:
        """Edges inside."""
        rooms = np.minimum(self.rooms(start), self.rooms(end))
        return np.asarray(rooms.min(axis=0, initial=np.inf) >= 0.0)
