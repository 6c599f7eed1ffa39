"""Douglas-Peucker simplification: starting from a triangle per loop, add the vertex farthest from its chord."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heappop, heappush

import numpy as np

from nestedcages_core.decimation.base import Count
from nestedcages_core.decimation.budget import LEAST_PER_LOOP
from nestedcages_core.decimation.request import Request
from nestedcages_core.errors import NestingError
from nestedcages_core.geometry.arrays import FloatArray
from nestedcages_core.geometry.distance import point_edge
from nestedcages_core.geometry.loops import Loops
from nestedcages_core.geometry.mesh import Mesh
from nestedcages_core.geometry.precision import MOST_STEPS
from nestedcages_core.geometry.predicates import crossing_pairs
from nestedcages_core.geometry.vectors import cross, norm

from .greedy import followed

Chord = tuple[int, int, int]
"""Loop, first vertex and last vertex; a last vertex equal to the size of the loop means vertex 0."""


@dataclass(frozen=True)
class DouglasPeucker:
    """The vertices of the fine mesh that stand out most (Douglas & Peucker 1973), by count instead of tolerance.

    Crossing chords are divided first, so the loops stay simple wherever the count allows it.
    """

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """A coarse mesh of vertices of the fine one, whatever the clearance; loop k on loop k. Raises NestingError."""
        request = Request.of(fine, count)
        limits = request.outline.sizes.tolist() if request.per_loop is None else request.minimum
        total = request.target
        division = _Division(request.outline.split())
        crossing: set[Chord] = set()
        for _ in range(MOST_STEPS):
            chosen = division.chosen(total, limits, crossing)
            found = division.crossing(chosen)
            if not found:
                return followed(request, division.outline(chosen))
            if found <= crossing:
                break
            crossing |= found
        raise NestingError(
            f"{total} vertices are too few for chords that follow the mesh without crossing; ask for more, or use the "
            "outer hull.",
            code="count.too_small",
        )


class _Division:
    """Loops divided into chords step by step; caches the farthest vertex of each stretch from its chord."""

    def __init__(self, loops: Sequence[FloatArray]) -> None:
        """loops: (k, 2) each; their first vertex always stays."""
        self.loops = [np.concatenate((loop, loop[:1])) for loop in loops]
        self._farthest: dict[Chord, tuple[float, int]] = {}

    def chosen(self, total: int, limits: Sequence[int], first: set[Chord]) -> list[list[int]]:
        """Vertices of each loop, in order: a total number, at most the limits per loop, chords in `first` divided
        first."""
        chosen = [self._triangle(k) for k in range(len(self.loops))]
        heap: list[tuple[bool, float, Chord]] = []

        def push(chord: Chord) -> None:
            if chord[2] - chord[1] > 1:
                heappush(heap, (chord not in first, -self._farthest_of(chord)[0], chord))

        for k, corners in enumerate(chosen):
            ends = [*corners[1:], len(self.loops[k]) - 1]
            for start, end in zip(corners, ends, strict=True):
                push((k, start, end))
        left = total - LEAST_PER_LOOP * len(chosen)
        while left > 0 and heap:
            chord = heappop(heap)[2]
            k, start, end = chord
            if len(chosen[k]) < limits[k]:
                middle = self._farthest_of(chord)[1]
                chosen[k].append(middle)
                push((k, start, middle))
                push((k, middle, end))
                left -= 1
        return [sorted(vertices) for vertices in chosen]

    def crossing(self, chosen: list[list[int]]) -> set[Chord]:
        """The chords that touch a chord other than their neighbours and can be divided."""
        outline = self.outline(chosen)
        one, other = crossing_pairs(outline.tree)
        apart = (outline.successor[one] != other) & (outline.successor[other] != one)
        chords = [
            (k, start, end)
            for k, vertices in enumerate(chosen)
            for start, end in zip(vertices, [*vertices[1:], len(self.loops[k]) - 1], strict=True)
        ]
        touched = (chords[e] for e in np.unique(np.concatenate((one[apart], other[apart]))).tolist())
        return {chord for chord in touched if chord[2] - chord[1] > 1}

    def outline(self, chosen: list[list[int]]) -> Loops:
        """The chosen vertices."""
        vertices = np.concatenate([loop[places] for loop, places in zip(self.loops, chosen, strict=True)])
        return Loops.of(vertices, [len(each) for each in chosen])

    def _triangle(self, k: int) -> list[int]:
        """The first vertex of a loop, the one farthest from it, and the one farthest from the line of both."""
        loop = self.loops[k][:-1]
        away = loop - loop[0]
        second = int(np.argmax(norm(away)))
        third = int(np.argmax(np.abs(cross(away, away[second]))))
        return sorted((0, second, third))

    def _farthest_of(self, chord: Chord) -> tuple[float, int]:
        """Distance and number of the vertex of a stretch that is farthest from its chord."""
        if chord not in self._farthest:
            k, start, end = chord
            loop = self.loops[k]
            distance = point_edge(loop[start + 1 : end], loop[start], loop[end]).distance
            farthest = int(np.argmax(distance))
            self._farthest[chord] = float(distance[farthest]), start + 1 + farthest
        return self._farthest[chord]
