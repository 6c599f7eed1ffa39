"""Poses in which a limb passes over the body: the outline of its cage crosses itself, but what is in it stays in its
own place. The field of the cage is a sheet of triangles that the pose moves; an edge of the drawing is inside the cage
if the way along it, from triangle to triangle, never leaves the sheet.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from bpy.types import Context, Object
from numpy.typing import NDArray

from .. import keys
from ..errors import FloatArray
from ..scene import filling
from ..scene.plane import size, space_to_space, transform

# Relative error of places in a triangle, and of a drawing's places at rest as a fraction of its size.
ROUND_OFF, SAME_PLACE = 1e-5, 1e-3
# Points that are looked for in all triangles at once.
BLOCK = 256


@dataclass(frozen=True, eq=False)
class Sheet:
    """The field `shows` of a cage, and what follows it. rest: (N, 2); weights: (N, m) of the cage's corners; triangles:
    (T, 3); beyond: (T, 3) the triangle across from each corner, -1 for none; edges: (E, 2) of the inner object; places:
    (n, 2) of its vertices at rest, and at: (n,) the triangle that each lies in.
    """

    cage: Object
    inner: Object
    shows: Object
    rest: FloatArray
    weights: FloatArray
    triangles: NDArray[np.int64]
    beyond: NDArray[np.int64]
    edges: NDArray[np.int64]
    places: FloatArray
    at: NDArray[np.int64]

    @classmethod
    def of(cls, cage: Object, inner: Object, shows: Object) -> Sheet:
        """The sheet of a cage at rest, and an inner object that follows it. Raises: UserError."""
        data, outline = filling.mesh_of(shows), filling.shape_of(inner)
        rest = filling.points_of(data)[:, :2]
        triangles = filling.stored(data.polygons, "vertices", 3, np.int32).astype(np.int64)
        known: Any = data.attributes
        stored = [known.get(f"{keys.WEIGHT}{number}") for number in range(len(cage.data.vertices))]
        columns = [filling.stored(each.data, "value", 1).ravel() for each in stored if each is not None]
        weights = np.column_stack(columns).astype(float) if columns else np.eye(len(rest))
        flat = np.column_stack([outline.vertices, np.zeros(len(outline.vertices))])
        places = transform(space_to_space(shows, inner), flat)[:, :2]
        at = _found(places, rest[triangles])
        return cls(
            cage, inner, shows, rest, weights, triangles, _beyond(triangles), np.asarray(outline.edges), places, at
        )

    def holds(self, context: Context) -> bool:
        """Whether what is in the cage stays in its own place of it on this frame."""
        depsgraph = context.evaluated_depsgraph_get()
        now = [filling.points_of(filling.mesh_of(obj.evaluated_get(depsgraph))) for obj in (self.cage, self.inner)]
        if len(now[0]) != self.weights.shape[1] or len(now[1]) != len(self.places) or (self.at < 0).any():
            return False
        spaces = [space_to_space(self.shows, obj) for obj in (self.cage, self.inner)]
        corners, inner = (transform(space, points)[:, :2] for space, points in zip(spaces, now, strict=True))
        return self._stays((self.weights @ corners)[self.triangles], inner)

    def _stays(self, posed: FloatArray, inner: FloatArray) -> bool:
        """The same for posed triangles (T, 3, 2) and vertices (n, 2) of what is in them, apart from folds."""
        first, last = self.edges.T
        here, entered = self.at[first], np.full(len(first), -1)
        start, end = inner[first], inner[last]
        flipped = _areas(posed) * _areas(self.rest[self.triangles]) <= 0.0
        for _ in range(len(posed)):
            parts, ends = _parts(posed[here], start), _parts(posed[here], end)
            arrived = (ends > -ROUND_OFF).all(axis=1)
            found = (ends[arrived][:, :, None] * self.rest[self.triangles[here[arrived]]]).sum(axis=1)
            if len(found) and np.abs(found - self.places[last[arrived]]).max() > SAME_PLACE * size(self.places):
                return False
            left = ~arrived & ~flipped[here]  # folds are told as such
            if not left.any():
                return True
            parts, ends = parts[left], ends[left]
            with np.errstate(divide="ignore", invalid="ignore"):
                crossing = np.where(ends < -ROUND_OFF, parts / (parts - ends), np.inf)
            across = self.beyond[here[left]]
            crossing[(across == entered[left, None]) & (entered[left, None] >= 0)] = np.inf
            side = crossing.argmin(axis=1)
            following = across[np.arange(len(side)), side]
            if (following < 0).any():
                return False
            entered, here = here[left], following
            start, end, last = start[left], end[left], last[left]
        return False


def _areas(triangles: FloatArray) -> FloatArray:
    """Twice the signed areas (k,) of triangles (k, 3, 2)."""
    one, other = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


def _parts(triangles: FloatArray, points: FloatArray) -> FloatArray:
    """Barycentric coordinates (k, 3) of points (k, 2) in triangles (k, 3, 2)."""
    area = _areas(triangles)
    against = [np.concatenate([points[:, None], np.delete(triangles, k, axis=1)], axis=1) for k in range(3)]
    signs = (1.0, -1.0, 1.0)  # the order of the two other corners
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.column_stack([sign * _areas(each) / area for sign, each in zip(signs, against, strict=True)])


def _beyond(triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """(T, 3) the triangle on the other side of the edge across from each corner, -1 at the border."""
    edges = np.sort(np.concatenate([np.delete(triangles, k, axis=1) for k in range(3)]), axis=1)
    order = np.lexsort(edges.T)
    same = (edges[order[1:]] == edges[order[:-1]]).all(axis=1)
    across = np.full(len(edges), -1)
    one, other = order[:-1][same], order[1:][same]
    across[one], across[other] = other % len(triangles), one % len(triangles)
    return across.reshape(3, -1).T


def _found(points: FloatArray, triangles: FloatArray) -> NDArray[np.int64]:
    """The triangle (n,) of (T, 3, 2) that each point (n, 2) lies in, -1 for none."""
    corner = triangles[:, 0]
    (a, b), (c, d) = np.moveaxis(triangles[:, 1:] - corner[:, None], 0, -1)
    found, area = np.full(len(points), -1), a * d - b * c
    for first in range(0, len(points), BLOCK):
        x, y = np.moveaxis(points[first : first + BLOCK, None] - corner, -1, 0)
        second, third = (x * d - y * c) / area, (y * a - x * b) / area
        inside = np.minimum(np.minimum(second, third), 1.0 - second - third)
        best = inside.argmax(axis=1)
        found[first : first + BLOCK] = np.where(inside.max(axis=1) > -ROUND_OFF, best, -1)
    return found
