"""A rectangle that the cage stays in."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ..errors import Fault, NestingError, invalid_setting
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..solver.banded import Rows
from .base import Bound, Constraint, Terms, Units

if TYPE_CHECKING:
    from ..decimation.outline import Lines
    from ..decimation.sampling import NormalFrame

SIDES = ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0))
"""Coordinate and sign of the inner normal of each side."""

ROUNDINGS = 4.0
"""Width of the margin inside of the box, in roundings of its largest coordinate: cages return from other units."""


@dataclass(frozen=True)
class Box(Constraint):
    """No vertex of the cage lies outside of a rectangle along the axes."""

    low: tuple[float, float]
    """The corner of least x and y; infinite: no limit."""
    high: tuple[float, float]
    must: bool = field(default=True, kw_only=True)

    def __post_init__(self) -> None:
        for name in ("low", "high"):
            try:
                corner = tuple(np.asarray(getattr(self, name), np.float64).tolist())
            except (TypeError, ValueError):
                corner = ()
            if len(corner) != 2 or not all(isinstance(value, float) and value == value for value in corner):
                raise invalid_setting(f"Box: {name} must be a corner (x, y), not {getattr(self, name)!r}.")
            object.__setattr__(self, name, corner)
        if not all(low < high for low, high in zip(self.low, self.high, strict=True)):
            raise invalid_setting(f"Box: {self.low} must lie below and left of {self.high}.")

    def of(self, about: Mesh, side: int) -> Box:
        """The box. Raises NestingError where it has no room for a cage around the drawing."""
        outside = np.minimum(self._rooms(about.vertices).min(axis=0), np.inf)
        k = int(np.argmin(outside))
        if side > 0 and outside[k] <= 0.0:
            x, y = about.vertices[k].tolist()
            raise NestingError(
                f"There is no cage in the box: the drawing reaches its border at ({x:.6g}, {y:.6g}); make it larger.",
                code="box.left",
                place=(x, y),
                distance=-float(outside[k]),
            )
        return self

    def free(self, lines: Lines, frame: NormalFrame) -> FloatArray:
        """Lines end at the sides."""
        point = frame.out_of(lines.point)
        ahead = (frame.out_of(lines.point + lines.direction) - point).T
        free = np.full((2, len(lines)), np.inf)
        for (axis, sign), room in zip(SIDES, self._rooms(point), strict=True):
            for way, slope in ((0, sign * ahead[axis]), (1, -sign * ahead[axis])):
                reach = np.divide(-room, slope, out=np.full(len(room), np.inf), where=slope < 0.0)
                free[way] = np.minimum(free[way], np.where(room > 0.0, reach, -1.0))
        return free

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        """The sides, with a margin for rounding."""
        corners = np.array([self.low, self.high])
        finite = np.abs(corners[np.isfinite(corners)])
        margin = ROUNDINGS * np.finfo(float).eps * float(finite.max(initial=0.0)) / units.scale
        low, high = units.points(corners)
        return BoundBox(low + margin, high - margin)

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        """Exact: coordinates are compared."""
        room = self._rooms(cage.vertices).min(axis=0)
        k = int(np.argmin(room))
        if room[k] >= 0.0:
            return None
        x, y = cage.vertices[k].tolist()
        return Fault(
            f"The cage leaves the box by {-room[k]:.3g} at ({x:.6g}, {y:.6g}); make the box larger there, or use more "
            "vertices.",
            "box.left",
            place=(x, y),
            distance=-float(room[k]),
        )

    def _rooms(self, points: FloatArray) -> FloatArray:
        """(4, P) distance of points (P, 2) from each side, negative outside."""
        return BoundBox(np.array(self.low), np.array(self.high)).rooms(points)


@dataclass(frozen=True, eq=False)
class BoundBox(Bound):
    """The box in the units of the solvers."""

    low: FloatArray
    high: FloatArray

    def rooms(self, points: FloatArray) -> FloatArray:
        """(4, P) distance of points (P, 2) from each side, negative outside."""
        corner = {1.0: self.low, -1.0: self.high}
        return np.stack([sign * (points[:, axis] - corner[sign][axis]) for axis, sign in SIDES])

    def rows(self, cage: FloatArray, radius: float) -> Iterator[Terms]:
        """One vertex each."""
        for (axis, sign), room in zip(SIDES, self.rooms(cage), strict=True):
            near = np.flatnonzero(room < 1.5 * radius)
            direction = np.zeros((2, len(near)))
            direction[axis] = sign
            yield Terms(Rows(near[None], np.ones((1, len(near))), direction), room[near])

    def allowed(self, vertex: IntArray, start: FloatArray, end: FloatArray) -> BoolArray:
        """Edges within."""
        return np.asarray(np.minimum(self.rooms(start), self.rooms(end)).min(axis=0, initial=np.inf) >= 0.0)

    def short(self, cage: FloatArray) -> FloatArray:
        """How far each vertex lies outside."""
        lack: FloatArray = np.maximum(-self.rooms(cage).min(axis=0), 0.0)
        return lack
