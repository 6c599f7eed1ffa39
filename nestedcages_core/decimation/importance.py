"""Importance: weights along a shape, and places that keep a vertex."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray
from ..geometry.broad_phase import nearest
from ..geometry.group import Symmetry
from ..geometry.loops import Loops
from ..geometry.mesh import Mesh
from ..geometry.vectors import norm
from .turns import PIN_REACH

LEAST_WEIGHT = 0.02
"""Lower bound of the weights, as a fraction of their mean, so that all edges are pulled inwards."""

FARTHEST_PIN = 0.02
"""Distance from a pin, in diagonals, up to which the closest vertex of an outline is the pinned one: levels, and
drawings united with their images, run that far outside of the drawing itself."""


@dataclass(frozen=True, eq=False)
class Importance:
    """Weights and pins of a fine mesh, in input units; shared by all its levels."""

    fine: Mesh
    weights: FloatArray | None
    """(n,) weight of each fine vertex, at least 0; None: equal weights."""
    pins: FloatArray
    """(P, 2) places that keep a vertex, near the outline of the fine mesh."""
    symmetry: Symmetry | None = None
    """Symmetry of the cages: a place matters as much as the most important one of its images."""

    @cached_property
    def relative(self) -> FloatArray:
        """(n,) weights with a mean of 1 along the outline, and a lower bound."""
        assert self.weights is not None
        fine = self.fine
        length = 0.5 * (fine.edge_lengths + fine.edge_lengths[fine.predecessor])
        mean = float(length @ self.weights) / float(length.sum())
        relative: FloatArray = np.maximum(self.weights / mean, LEAST_WEIGHT)
        return relative

    def at(self, points: FloatArray) -> FloatArray:
        """(P,) weight at the closest place on the fine mesh to each of the points (P, 2)."""
        if self.weights is None:
            return np.ones(len(points))
        group = self.symmetry
        images = [points] if group is None else [group.image(points, k) for k in range(group.order)]
        ends, close = self.relative[self.fine.successor], map(self.fine.edge_search.closest, images)
        return np.asarray(np.max([each.between(self.relative, ends) for each in close], axis=0))

    def pinned(self, outline: Loops) -> BoolArray:
        """(n,) the vertices of an outline that are closest to pins; with `with_vertices` all pins have one."""
        held = np.zeros(len(outline.vertices), bool)
        distance, vertex = nearest(self.pins, outline.vertices)
        held[vertex[distance <= FARTHEST_PIN * self.fine.diagonal]] = True
        return held

    def with_vertices(self, outline: Loops, most: float = np.inf) -> Loops:
        """The outline with additional vertices at pins without one, as long as it has at most so many."""
        for pin in self.pins:
            missed = norm(outline.vertices - pin).min()
            if len(outline.vertices) < most and missed > 0.5 * PIN_REACH * self.fine.diagonal:
                close = outline.tree.closest(pin[None])
                edge, new = int(close.edge[0]), close.between(outline.vertices, outline.ends)
                sizes = outline.sizes + (np.arange(len(outline.sizes)) == outline.loop[edge])
                outline = Loops.of(np.insert(outline.vertices, edge + 1, new, axis=0), sizes)
        return outline
