"""What bounds the distance of a cage whose loops run along those of the fine mesh: strips between the two.

The cage's outline is cut into pieces. Each end of a piece has a foot on the nearest edge of the fine loop, and between
the two feet there is a path of edges. Where the paths go around each loop once, the polygons of a piece, a path
and the segments to the feet cover what is between cage and fine mesh: their boundaries add up to the difference of
the two outlines. So do the triangles that fan out from both ends of a piece to the path, and one that is left in
between. Pieces whose triangles are too far from the fine mesh are halved a few times; what is left are strips around
the farthest places and the mouths of bays.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..errors import InvalidMeshError
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import position_in_group
from ..geometry.distance import point_edge
from ..geometry.loops import Loops
from ..geometry.mesh import Mesh
from ..geometry.signed_distance import EdgeSearch
from ..geometry.triangulation import triangulate
from ..geometry.vectors import norm

REACH_PRECISION = 1e-4
"""Relative width of the interval that contains the reach; its upper end is returned."""

PIECE_HALVINGS = 5
"""Times that a piece is halved before what is left between it and the fine mesh is cut into triangles."""


class Covered(NamedTuple):
    """What strips say of the distance of a cage."""

    largest: float
    """The largest distance found."""
    places: FloatArray
    """(P, 2) places that are too far."""
    triangles: FloatArray
    """(T, 3, 2) what else may be too far."""


class Strips:
    """The strips between a cage and a fine mesh with loops in the same order."""

    def __init__(self, cage: Mesh, fine: Mesh, search: EdgeSearch) -> None:
        """search: over the edges of the fine mesh, loop after loop."""
        self.cage, self.fine, self.search = cage.loop_order, fine.loop_order, search
        self.starts, self.ends = self.fine.vertices, self.fine.ends
        self.apart = np.array([4.0 * cage.diagonal, 0.0])
        """Between loops that are searched or triangulated alone."""
        self._own: EdgeSearch | None = None

    def covered(self, spacing: float, limit: float, slack: float) -> Covered | None:
        """What strips say of the reach; None where they do not go around each loop once, or cross.

        spacing: length of the first pieces. limit, slack: as in `reach`.
        """
        samples = self._sampled(spacing)
        points, loop = samples.vertices, samples.loop
        distance, near = self._nearest(points, loop)
        i, j, steps = np.arange(len(points)), samples.ahead, self._steps(near, near[samples.ahead], loop)
        if not np.array_equal(np.add.reduceat(steps, samples.begins), self.fine.sizes):
            return None
        for halving in range(PIECE_HALVINGS + 1):
            largest = float(distance.max())
            if largest > limit:
                break
            enough = min(limit, slack + (1.0 + REACH_PRECISION) * largest)
            for bounding in (self._bounds, self._bounds_in_bays):
                kept = bounding(points[i], points[j], near[i], near[j], steps) > enough
                i, j, steps = i[kept], j[kept], steps[kept]
            if halving == PIECE_HALVINGS or len(i) == 0:
                break
            new, middle = len(points) + np.arange(len(i)), 0.5 * (points[i] + points[j])
            far, foot = self._nearest(middle, loop[i])
            points, distance = np.concatenate([points, middle]), np.concatenate([distance, far])
            near, loop = np.concatenate([near, foot]), np.concatenate([loop, loop[i]])
            half = self._steps(near[i], foot, loop[i])
            i, j, steps = np.concatenate([i, new]), np.concatenate([new, j]), np.concatenate([half, steps - half])
        if largest > limit:
            return Covered(largest, points[distance > limit], np.empty((0, 3, 2)))
        left = [self._polygon(points[[a, b]], near[[a, b]], count) for a, b, count in zip(i, j, steps, strict=True)]
        try:
            return Covered(largest, points[:0], _triangles(left, self.apart))
        except InvalidMeshError:
            return None

    def _sampled(self, spacing: float) -> Loops:
        """The cage's loops with further vertices, about as many as the fine mesh has at most."""
        cage, steps = self.cage, self.cage.ends - self.cage.vertices
        lengths = norm(steps)
        spacing = max(spacing, float(lengths.sum()) / len(self.starts))
        parts = 2 + (lengths / spacing).astype(np.int64)
        edge = np.repeat(np.arange(len(parts)), parts)
        share = position_in_group(parts) / parts[edge]
        return Loops.of(cage.vertices[edge] + share[:, None] * steps[edge], np.add.reduceat(parts, cage.begins))

    def _nearest(self, points: FloatArray, loop: IntArray) -> tuple[FloatArray, IntArray]:
        """(P,) distances of points (P, 2) from the fine mesh, and (P,) the nearest edges of their loops (P,)."""
        distance, edge, _ = self.search.closest(points)
        others = (self.fine.loop[edge] != loop).nonzero()[0]
        if len(others):
            if self._own is None:
                apart = self.fine.loop[:, None] * self.apart
                self._own = EdgeSearch(self.starts + apart, self.ends + apart)
            edge[others] = self._own.closest(points[others] + loop[others, None] * self.apart).edge
        return distance, edge

    def _steps(self, first: IntArray, last: IntArray, loop: IntArray) -> IntArray:
        """(P,) steps from an edge to another of the same loop, whichever way around is shorter."""
        half = self.fine.sizes[loop] // 2
        return np.asarray((last - first + half) % self.fine.sizes[loop] - half)

    def _along(self, edge: IntArray, steps: IntArray) -> IntArray:
        """(P,) the edges that are some steps ahead."""
        loop = self.fine.loop[edge]
        begins = self.fine.begins[loop]
        return np.asarray(begins + (edge - begins + steps) % self.fine.sizes[loop])

    def _bounds(
        self,
        a: FloatArray,
        b: FloatArray,
        first: IntArray,
        last: IntArray,
        steps: IntArray,
        half: IntArray | None = None,
    ) -> FloatArray:
        """(P,) upper bounds of the distance of strips between pieces a-b (P, 2) and paths from the fine mesh.

        half: steps from the first edge to that where the fans from a and b meet; None: half of them.
        """
        half = np.trunc(0.5 * steps).astype(np.int64) if half is None else half
        number = np.abs(steps) + 2  # triangles of both fans: the edge where they meet has two
        strip, k = np.repeat(np.arange(len(a)), number), position_in_group(number)
        of_b = k > np.abs(half)[strip]
        edge = self._along(first[strip], np.sign(steps)[strip] * (k - of_b))
        fans = point_edge(np.where(of_b[:, None], b[strip], a[strip]), self.starts[edge], self.ends[edge]).distance
        middle = self._along(first, half)
        left = self._of_triangles(a, self.starts[middle], b, np.column_stack([first, last, middle]))
        return np.maximum(np.maximum.reduceat(fans, np.cumsum(number) - number) if len(a) else left, left)

    def _bounds_in_bays(
        self, a: FloatArray, b: FloatArray, first: IntArray, last: IntArray, steps: IntArray
    ) -> FloatArray:
        """The same by a fan from halfway between each piece and the middle of its path."""
        half = np.trunc(0.5 * steps).astype(np.int64)
        middle = self._along(first, half)
        centre = 0.25 * (a + b) + 0.5 * self.starts[middle]
        parts = (
            self._of_triangles(a, centre, b, np.column_stack([first, last, middle])),
            self._bounds(a, centre, first, middle, half, 0 * half),
            self._bounds(centre, b, middle, last, steps - half, steps - half),
        )
        return np.asarray(np.maximum.reduce(parts))

    def _of_triangles(self, a: FloatArray, b: FloatArray, c: FloatArray, edges: IntArray) -> FloatArray:
        return bounds(np.stack([a, b, c], axis=1), edges, self.starts, self.ends)

    def _polygon(self, piece: FloatArray, edges: IntArray, steps: int) -> FloatArray:
        """(K, 2) a piece (2, 2), the feet of its ends on edges (2,) and the path between them."""
        numbers = np.arange(1, steps + 1) if steps > 0 else np.arange(0, steps, -1)
        path = self.starts[self._along(np.full(len(numbers), edges[0]), numbers)]
        share = point_edge(piece, self.starts[edges], self.ends[edges]).parameter[:, None]
        feet = self.starts[edges] + share * (self.ends - self.starts)[edges]
        return np.concatenate([feet[:1], path, feet[1:], piece[::-1]])


def _triangles(polygons: list[FloatArray], apart: FloatArray) -> FloatArray:
    """(T, 3, 2) of polygons (K, 2) each. Raises InvalidMeshError where one crosses itself."""
    loops = [polygon[(polygon != np.roll(polygon, 1, axis=0)).any(axis=1)] for polygon in polygons]
    moved = [loop + k * apart for k, loop in enumerate(loops) if len(loop) > 2]
    if not moved:
        return np.empty((0, 3, 2))
    mesh = Mesh.from_loops(moved)
    tiles = triangulate(mesh)
    corners: FloatArray = (mesh.vertices - mesh.loop_of_vertex[:, None] * apart)[tiles.triangles]
    return corners


def bounds(corners: FloatArray, edges: IntArray, starts: FloatArray, ends: FloatArray) -> FloatArray:
    """(T,) upper bounds of the distance of triangles (T, 3, 2) from segments, by some of these for each, (T, K)."""
    a, b = starts[edges][:, :, None], ends[edges][:, :, None]
    distance = point_edge(corners[:, None], a, b).distance
    # half-way between two segments their mean is as small as it gets, and convex too
    one, other = np.triu_indices(edges.shape[1])
    least: FloatArray = (0.5 * (distance[:, one] + distance[:, other])).max(axis=2).min(axis=1)
    return least
