"""Thinning: an outline of far more vertices than are wanted loses those next to chords, many at a time."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import FloatArray
from ...geometry.distance import point_edge
from ...geometry.loops import Loops

LEAST_CHORDS = 8
"""Chords that each loop keeps, if it has as many edges."""


def thinned(outline: Loops, tolerance: float) -> Loops:
    """The outline with chords of 2, 4, 8, … edges from which no vertex in between is farther than a tolerance."""
    rings = [_thinned(ring, tolerance) for ring in outline.split()]
    return Loops.of(np.concatenate(rings), [len(ring) for ring in rings])


def _thinned(ring: FloatArray, tolerance: float) -> FloatArray:
    """The same for a loop (k, 2)."""
    kept, straight, length = np.ones(len(ring), bool), np.ones(len(ring), bool), 2
    while straight.any() and len(ring) >= LEAST_CHORDS * length:
        count = len(ring) // length
        straight = straight[: 2 * count : 2] & straight[1 : 2 * count : 2]
        first = length * np.flatnonzero(straight)
        start, end = (ring[at % len(ring)].repeat(length - 1, axis=0) for at in (first, first + length))
        between = ring[(first[:, None] + np.arange(1, length)).ravel()]
        distance = point_edge(between, start, end).distance.reshape(len(first), length - 1).max(axis=1)
        straight[first // length] = distance <= tolerance
        kept[length * np.flatnonzero(straight) + length // 2] = False
        length *= 2
    left: FloatArray = ring[kept]
    return left
