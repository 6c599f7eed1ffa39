"""The curves of a Grease Pencil drawing as Blender evaluates them, and shapes that cover a stroke with its width."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..blender.mesh_data import stored
from ..errors import FloatArray, UserError

# Stored values of the type of a curve; others are polylines.
SMOOTH, BEZIER, NURBS = 0, 2, 3
# Stored values of the mode of NURBS knots.
UNIFORM, ENDPOINT = 0, 1
# Segments between two points of a curve, and order of NURBS, where none are stored.
SEGMENTS, ORDER = 12, 4
# Corners of the round end of a stroke, at least and at most. They circumscribe the circle, so that the stroke lies
# inside its area; a small circle has as few as leave this fraction of the drawing's size.
LEAST_ROUND, ROUND, ROUNDNESS = 8, 24, 1e-4


class Curves:
    """The attributes of the strokes of a drawing that has some, and of their points."""

    def __init__(self, drawing: Any) -> None:
        self._attributes = drawing.attributes
        self._ends = stored(drawing.curve_offsets, "value", 1, np.int32).ravel()
        self.cyclic = self.each("cyclic", False, np.bool_)
        self._kinds, self._segments = (
            self.each("curve_type", SMOOTH, np.int32),
            self.each("resolution", SEGMENTS, np.int32),
        )
        self._orders, self._modes = self.each("nurbs_order", ORDER, np.int32), self.each("knots_mode", 0, np.int32)
        points = self._vectors("position")
        radii, opacities = (self._of_points(name, value) for name, value in (("radius", 0.01), ("opacity", 1.0)))
        corners = self._of_points("miter_angle", 0.0)
        self._values = np.column_stack([points, radii, opacities, corners])
        self._weights = self._of_points("nurbs_weight", 1.0)
        self._left, self._right = self._vectors("handle_left"), self._vectors("handle_right")

    def each(self, name: str, missing: float, kind: type[Any] = np.float32) -> NDArray[Any]:
        """An attribute (s,) of all strokes; missing: its value where it is not stored."""
        found = self._attributes.get(name)
        count = len(self._ends) - 1
        return np.full(count, missing, kind) if found is None else stored(found.data, "value", 1, kind).ravel()

    def evaluated(self, number: int) -> tuple[FloatArray, ...]:
        """Points (k, 3), radii (k,), opacities (k,) and angles of sharp corners (k,) along a stroke."""
        part = slice(self._ends[number], self._ends[number + 1])
        values, cyclic, kind = self._values[part], bool(self.cyclic[number]), self._kinds[number]
        segments = max(int(self._segments[number]), 1)
        if kind == SMOOTH and len(values) > 1:
            values = _smooth(values, cyclic, segments)
        elif kind == BEZIER and len(values) > 1:
            values = _bezier(values, self._left[part], self._right[part], cyclic, segments)
        elif kind == NURBS:
            values = _nurbs(values, self._weights[part], self._orders[number], self._modes[number], cyclic, segments)
        return values[:, :3], *values[:, 3:].T

    def _of_points(self, name: str, missing: float) -> FloatArray:
        found = self._attributes.get(name)
        if found is None:
            return np.full(self._ends[-1], missing)
        return stored(found.data, "value", 1).ravel().astype(np.float64)

    def _vectors(self, name: str) -> FloatArray:
        found = self._attributes.get(name)
        if found is None:
            return np.zeros((self._ends[-1], 3))
        return stored(found.data, "vector", 3).astype(np.float64)


def _smooth(values: FloatArray, cyclic: bool, segments: int) -> FloatArray:
    """Values (k, c) along the uniform Catmull-Rom spline through values (n, c)."""
    ends = (values[-1:], values[:2]) if cyclic else (values[:1], values[-1:])
    padded = np.concatenate([ends[0], values, ends[1]])
    before, start, end, after = (padded[i : len(padded) - 3 + i, None] for i in range(4))
    t = np.arange(segments)[None, :, None] / segments
    slope, bend, twist = end - before, 2 * before - 5 * start + 4 * end - after, 3 * (start - end) + after - before
    smooth = (start + 0.5 * t * (slope + t * (bend + t * twist))).reshape(-1, values.shape[1])
    return smooth if cyclic else np.concatenate([smooth, values[-1:]])


def _bezier(values: FloatArray, left: FloatArray, right: FloatArray, cyclic: bool, segments: int) -> FloatArray:
    """Values (k, c), points first, along Bézier curves through values (n, c) with handles (n, 3)."""
    start, end = values[:, None], np.roll(values, -1, axis=0)[:, None]
    after, before = right[:, None], np.roll(left, -1, axis=0)[:, None]
    t = np.arange(segments)[None, :, None] / segments
    found = (1.0 - t) * start + t * end
    found[..., :3] = (
        (1 - t) ** 3 * start[..., :3] + t**3 * end[..., :3] + 3 * t * (1 - t) * ((1 - t) * after + t * before)
    )
    inner = np.asarray((found if cyclic else found[:-1]).reshape(-1, values.shape[1]), np.float64)
    return inner if cyclic else np.concatenate([inner, values[-1:]])


def _nurbs(values: FloatArray, weights: FloatArray, order: int, mode: int, cyclic: bool, segments: int) -> FloatArray:
    """Values (k, c) along the NURBS curve of values (n, c) with weights (n,). Raises: UserError for rare knots."""
    from scipy.interpolate import BSpline

    count, degree = len(values), order - 1
    if count < order or degree < 1:
        return values
    if mode not in {UNIFORM, ENDPOINT} or (mode == ENDPOINT and cyclic):
        raise UserError("A NURBS stroke has knots for Bézier spans: set its type to Poly (Edit Mode, Stroke)")
    knots = np.arange(count + order + degree * cyclic, dtype=np.float64)
    if mode == ENDPOINT:
        knots = np.clip(knots, degree, count)
    number = segments * count if cyclic else segments * (count - degree) + 1
    t = np.linspace(knots[degree], knots[count + degree * cyclic], number, endpoint=not cyclic)
    weighed = np.column_stack([values * weights[:, None], weights])
    if cyclic:
        weighed = np.concatenate([weighed, weighed[:degree]])
    found: Any = BSpline(knots, weighed, degree)(t)
    return np.asarray(found[:, :-1] / found[:, -1:], np.float64)


def covering(stroke: FloatArray, radii: FloatArray, corners: FloatArray, extent: float) -> list[FloatArray]:
    """Loops (k, 2) of shapes that together cover a stroke (k, 2): a disc around each point, a quad between.

    corners: (k,) angles from which on corners are sharp, 0 = round; extent: size of the drawing.
    """
    widest = float(radii.max())
    enough = np.pi / np.sqrt(2.0 * ROUNDNESS * max(extent / widest, 1.0))
    number = int(np.clip(np.ceil(enough), LEAST_ROUND, ROUND))
    angles = 2.0 * np.pi * (np.arange(number) + 0.5) / number
    circle = np.column_stack([np.cos(angles), np.sin(angles)]) / np.cos(np.pi / number)
    around = radii[:, None, None] * circle + stroke[:, None, :]
    shapes: list[FloatArray] = [disc for disc, radius in zip(around, radii, strict=True) if radius > 0.0]
    for (start, end), (narrow, wide) in zip(pairwise(stroke), pairwise(radii), strict=True):
        along = end - start
        length = float(np.hypot(*along))
        if length > abs(wide - narrow) and (narrow > 0.0 or wide > 0.0):  # else one disc covers the other
            shapes.append(_between(start, end, float(narrow), float(wide), along / length, length))
    for at in np.flatnonzero(corners[1:-1] > 0.0) + 1:
        shapes += _sharp(stroke[at - 1 : at + 2], radii[at - 1 : at + 2], float(corners[at]))
    return shapes


def _sharp(points: FloatArray, radii: FloatArray, least: float) -> list[FloatArray]:
    """The quads (4, 2) between the tip of a corner of three points and both ends, unless its angle is too small."""
    steps = np.diff(points, axis=0)
    lengths = np.hypot(*steps.T)
    if not lengths.all() or not radii[1] > 0.0:
        return []
    (ax, ay), (bx, by) = ahead = steps / lengths[:, None]
    angle = np.pi - abs(np.arctan2(ax * by - ay * bx, ax * bx + ay * by))
    if angle < least:
        return []
    out = np.sign(ax * by - ay * bx) * np.column_stack([ahead[:, 1], -ahead[:, 0]])
    tip = points[1] + radii[1] * out.sum(axis=0) / (2.0 * np.sin(0.5 * angle) ** 2)
    return [
        np.array([points[1], tip, points[end] + radii[end] * side, points[end]])
        for end, side in ((0, out[0]), (2, out[1]))
    ]


def _between(
    start: FloatArray, end: FloatArray, first: float, second: float, along: FloatArray, length: float
) -> FloatArray:
    """The quad (4, 2) between the points where the common tangents touch two circles."""
    sine = (first - second) / length
    across, ahead = np.sqrt(1.0 - sine * sine) * np.array([-along[1], along[0]]), sine * along
    left, right = ahead + across, ahead - across
    return np.array([start + first * right, end + second * right, end + second * left, start + first * left])
