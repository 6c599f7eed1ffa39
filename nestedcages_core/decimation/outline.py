"""Outline: the loops that a decimation works on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.predicates import BoxTree
from ..geometry.vectors import cross, norm


@dataclass(frozen=True, eq=False)
class Outline:
    """Closed loops with the solid on their left, one after the other.

    vertices: (n, 2). sizes: vertices per loop.
    """

    vertices: FloatArray
    sizes: tuple[int, ...]

    @cached_property
    def begins(self) -> IntArray:
        """(L,) the first vertex of each loop."""
        return np.cumsum([0, *self.sizes[:-1]], dtype=np.int64)

    @cached_property
    def successor(self) -> IntArray:
        """(n,) the vertex after each vertex."""
        following = np.arange(1, len(self.vertices) + 1)
        following[self.begins + self.sizes - 1] = self.begins
        return following

    @cached_property
    def predecessor(self) -> IntArray:
        """(n,) the vertex before each vertex."""
        before = np.arange(-1, len(self.vertices) - 1)
        before[self.begins] = self.begins + self.sizes - 1
        return before

    @property
    def loops(self) -> list[FloatArray]:
        """The vertices of each loop, (k, 2)."""
        return np.split(self.vertices, self.begins[1:])

    @property
    def ends(self) -> FloatArray:
        """(n, 2) where the edge that starts at each vertex ends."""
        return self.vertices.take(self.successor, axis=0)

    @property
    def tree(self) -> BoxTree:
        """The edges, each by its start."""
        return BoxTree(self.vertices, self.ends)

    @cached_property
    def centre(self) -> FloatArray:
        """(2,) centroid of the loops as wires, independent of rotation."""
        here = self.vertices - self.vertices[0]
        there = here.take(self.successor, axis=0)
        lengths = norm(there - here)
        centre: FloatArray = self.vertices[0] + (lengths[:, None] * (0.5 * (here + there))).sum(axis=0) / lengths.sum()
        return centre

    @cached_property
    def diameter(self) -> float:
        """Diameter of the circle around the centre that holds the loops."""
        return 2.0 * float(norm(self.vertices - self.centre).max())

    @property
    def area(self) -> float:
        """Area of the solid; clockwise loops count negative."""
        here = self.vertices - self.vertices[0]
        there = here.take(self.successor, axis=0)
        return 0.5 * float(cross(here, there).sum())

    def moved(self, vertices: FloatArray) -> Outline:
        """The same loops with other vertices (n, 2)."""
        return Outline(vertices, self.sizes)
