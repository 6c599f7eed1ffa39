"""The orbits of a mesh's vertices under a symmetry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .all_pairs import nearest
from .arrays import BoolArray, FloatArray, IntArray
from .group import Symmetry


@dataclass(frozen=True, eq=False)
class Orbits:
    """The vertices of loops that a symmetry maps onto each other."""

    symmetry: Symmetry
    partner: IntArray
    """(m,) image of each vertex under the generator."""
    orbit: IntArray
    """(m,) number of the orbit of each vertex."""
    element: IntArray
    """(m,) the element that takes the first vertex of the orbit to this one."""
    first: IntArray
    """(u,) first vertex of each orbit."""
    on_axis: BoolArray
    """(u,) whether the orbit is one vertex, which stays where it is."""

    @classmethod
    def of(cls, vertices: FloatArray, successor: IntArray, symmetry: Symmetry, tolerance: float) -> Orbits | None:
        """The orbits of loops with vertices (m, 2); None where images are farther from vertices than a length."""
        m = len(vertices)
        distance, partner = nearest(symmetry.image(vertices), vertices)
        if not (distance <= tolerance).all() or len(np.unique(partner)) < m:
            return None
        ends = partner[successor]
        joined = successor[ends] == partner if symmetry.reverses else successor[partner] == ends
        if not joined.all():
            return None
        vertex = np.arange(m)
        lowest, lowest_element, current = vertex.copy(), np.zeros(m, np.int64), vertex
        for k in range(1, symmetry.order):
            current = partner[current]  # image under element k
            lower = current < lowest
            lowest[lower], lowest_element[lower] = current[lower], k
        if not np.array_equal(partner[current], vertex):
            return None
        first, orbit = np.unique(lowest, return_inverse=True)
        sizes = np.bincount(orbit)
        if not np.isin(sizes, (1, symmetry.order) if symmetry.reverses else (symmetry.order,)).all():
            return None
        # element k takes the vertex to the first one, so its inverse takes the first one to the vertex
        return cls(symmetry, partner, orbit, -lowest_element % symmetry.order, first, sizes == 1)

    def symmetrised(self, points: FloatArray) -> FloatArray:
        """(m, 2) the first vertex of each orbit as given in points (m, 2), the others as its images."""
        first = self.symmetry.settled(points[self.first])
        first[self.on_axis] = self.symmetry.fixed(first[self.on_axis])
        out = first[self.orbit]
        for k in range(1, self.symmetry.order):
            moved = self.element == k
            out[moved] = self.symmetry.image(out[moved], k)
        return out

    def edge_orbit(self, successor: IntArray) -> IntArray:
        """(m,) the lowest start among the images of the edge that starts at each vertex."""
        image = self.partner[successor] if self.symmetry.reverses else self.partner
        lowest = current = np.arange(len(image))
        for _ in range(1, self.symmetry.order):
            current = image[current]
            lowest = np.minimum(lowest, current)
        return lowest
