"""Symmetries of the plane: mirrors and rotations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, hypot, isfinite, pi, sin

import numpy as np

from ...errors import invalid_setting
from ...parameters import check_count
from ..arrays import FloatArray
from ..group import Symmetry, rounded
from ..mesh import Mesh

SETTLING_STEPS = 4
"""Maximum number of double images until a point is its own."""


@dataclass(frozen=True)
class Mirror:
    """A mirror on the line through a point along a direction; the default is the y-axis.

    On a vertical or horizontal line the image is 2 c - x in one coordinate and equal in the other, so pairs are exact:
    each is the image of the other bit by bit, and where 2 c is a multiple of the spacing of doubles at the larger
    coordinate, c lies exactly in the middle. On other lines one of each pair is the rounded image of the other.
    """

    point: Sequence[float] | None = (0.0, 0.0)
    """A point (x, y) on the line; None: the middle of the drawing's bounding box."""
    direction: Sequence[float] = (0.0, 1.0)
    """A vector (x, y) along the line, of any length above 0."""

    def __post_init__(self) -> None:
        if self.point is not None:
            object.__setattr__(self, "point", _pair(self, "point", self.point))
        object.__setattr__(self, "direction", _pair(self, "direction", self.direction))
        if not any(self.direction):
            raise invalid_setting("Mirror: direction must not be (0, 0); (0, 1) is a vertical line.")

    @property
    def order(self) -> int:
        """2."""
        return 2

    @property
    def reverses(self) -> bool:
        """True."""
        return True

    def image(self, points: FloatArray, element: int = 1) -> FloatArray:
        """The mirrored points (..., 2)."""
        out = np.array(points, np.float64)
        if element % 2:
            axis = self._across()
            if axis is not None:
                out[..., axis] = 2.0 * self._point[axis] - out[..., axis]
            else:
                out -= 2.0 * self._away(out)
        return out

    def settled(self, points: FloatArray) -> FloatArray:
        """See `Symmetry.settled`."""
        return _settled(self, points) if self._across() is not None else points

    def fixed(self, points: FloatArray) -> FloatArray:
        """The closest points (..., 2) on the line."""
        out = np.array(points, np.float64)
        axis = self._across()
        if axis is not None:
            out[..., axis] = self._point[axis]
            return out
        return out - self._away(out)

    def _away(self, points: FloatArray) -> FloatArray:
        """From the line to points (..., 2); element by element, since a product of matrices rounds by its size."""
        u, v = self._normal().tolist()
        distance = u * (points[..., 0] - self._point[0]) + v * (points[..., 1] - self._point[1])
        return np.stack([u * distance, v * distance], axis=-1)

    def placed(self, mesh: Mesh) -> Mirror:
        """The mirror with its point, that of a mesh if it has none."""
        if self.point is not None:
            return self
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        x, y = rounded(0.5 * (low + high), mesh.diagonal)
        return Mirror((float(x), float(y)), self.direction)

    def about_origin(self) -> Mirror:
        """The mirror on the parallel line through the origin."""
        return Mirror((0.0, 0.0), self.direction)

    @property
    def _point(self) -> Sequence[float]:
        if self.point is None:
            raise invalid_setting("Mirror: without a point it has a place only as a setting, for a drawing.")
        return self.point

    def _across(self) -> int | None:
        """The coordinate that changes, if only one does."""
        return 0 if self.direction[0] == 0.0 else 1 if self.direction[1] == 0.0 else None

    def _normal(self) -> FloatArray:
        x, y = self.direction
        return np.array([-y, x]) / hypot(x, y)

    def __str__(self) -> str:
        axis = self._across()
        if self.point is None:
            return f"a mirror on the line through the middle along ({self.direction[0]:.6g}, {self.direction[1]:.6g})"
        if axis is not None:
            return f"a mirror on the {('vertical', 'horizontal')[axis]} line {'xy'[axis]} = {self._point[axis]:.6g}"
        (x, y), (u, v) = self._point, self.direction
        return f"a mirror on the line through ({x:.6g}, {y:.6g}) along ({u:.6g}, {v:.6g})"


@dataclass(frozen=True)
class Rotation:
    """Rotations by multiples of 360° / order around a centre; multiples of 90° are exact."""

    centre: Sequence[float] | None = (0.0, 0.0)
    """The fixed point (x, y); None: the centroid of the drawing."""
    order: int = 2
    """Number of positions in one turn, at least 2."""

    def __post_init__(self) -> None:
        if self.centre is not None:
            object.__setattr__(self, "centre", _pair(self, "centre", self.centre))
        check_count(self, "order", least=2)

    @property
    def reverses(self) -> bool:
        """False."""
        return False

    def image(self, points: FloatArray, element: int = 1) -> FloatArray:
        """The turned points (..., 2)."""
        out = np.array(points, np.float64)
        element %= self.order
        if 2 * element == self.order:
            return 2.0 * np.array(self._centre) - out
        if element:
            turn, rest = 2.0 * pi * element / self.order, 4 * element % self.order
            c, s = cos(turn), sin(turn)
            if rest == 0:
                c, s = float(round(c)), float(round(s))
            x, y = out[..., 0] - self._centre[0], out[..., 1] - self._centre[1]
            out[..., 0], out[..., 1] = self._centre[0] + (c * x - s * y), self._centre[1] + (s * x + c * y)
        return out

    def settled(self, points: FloatArray) -> FloatArray:
        """See `Symmetry.settled`."""
        return _settled(self, points) if self.order == 2 else points

    def fixed(self, points: FloatArray) -> FloatArray:
        """The centre, for each of the points (..., 2)."""
        return np.broadcast_to(np.array(self._centre), np.shape(points)).copy()

    def placed(self, mesh: Mesh) -> Rotation:
        """The rotations with their centre, that of a mesh if they have none."""
        if self.centre is not None:
            return self
        here = mesh.vertices - mesh.vertices[0]
        there = here[mesh.successor]
        twice = here[:, 0] * there[:, 1] - here[:, 1] * there[:, 0]
        centroid = mesh.vertices[0] + (twice[:, None] * (here + there)).sum(axis=0) / (3.0 * twice.sum())
        x, y = rounded(centroid, mesh.diagonal)
        return Rotation((float(x), float(y)), self.order)

    def about_origin(self) -> Rotation:
        """The rotations around the origin."""
        return Rotation((0.0, 0.0), self.order)

    @property
    def _centre(self) -> Sequence[float]:
        if self.centre is None:
            raise invalid_setting("Rotation: without a centre it has a place only as a setting, for a drawing.")
        return self.centre

    def __str__(self) -> str:
        if self.centre is None:
            return f"rotations of order {self.order} around the centroid"
        return f"rotations of order {self.order} around ({self._centre[0]:.6g}, {self._centre[1]:.6g})"


def _settled(symmetry: Symmetry, points: FloatArray) -> FloatArray:
    for _ in range(SETTLING_STEPS):
        again = symmetry.image(symmetry.image(points))
        if np.array_equal(again, points):
            break
        points = again
    return points


def _pair(owner: object, name: str, value: object) -> tuple[float, float]:
    """Two finite numbers. Raises NestedCagesError."""
    try:
        x, y = (float(number) for number in value)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        x = y = float("nan")
    if not (isfinite(x) and isfinite(y)):
        raise invalid_setting(f"{type(owner).__name__}: {name} must be two finite numbers (x, y), not {value!r}.")
    return x, y
