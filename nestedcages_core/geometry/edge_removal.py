"""A mesh with fewer edges around what it encloses: corners are extended, dents filled."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from ..errors import InvalidMeshError
from .arrays import BoolArray, FloatArray
from .mesh import Mesh
from .precision import MOST_ROUNDS
from .vectors import cross


class _Removal(NamedTuple):
    """One edge less in a ring."""

    area: float
    """What it adds to that of the ring, without sign."""
    loop: int
    edge: int
    """Place of the edge in the ring."""
    gone: int
    """Place of the vertex that goes."""
    moved: int
    """Place of the other end of the edge."""
    to: FloatArray
    """(2,) where that end comes to lie."""


def without_edges(mesh: Mesh, edges: BoolArray, most: int, side: int = 1) -> Mesh | None:
    """The mesh without some of its edges (m,), named by their starts: those that add the least area.

    At most so many go together, and of edges in a row every third; where they would cross others, fewer. side: 1 for a
    mesh that grows, -1 for one that shrinks. Each ring keeps three vertices. None if no edge can go.
    """
    rings = [mesh.vertices[loop] for loop in mesh.loops]
    found = [each for k, loop in enumerate(mesh.loops) for each in _removals(k, rings[k], edges[loop], side)]
    found.sort(key=lambda each: each.area)
    near = [np.zeros(len(ring), bool) for ring in rings]
    together: list[_Removal] = []
    for each in found:
        around = np.mod(np.arange(each.edge - 1, each.edge + 3), len(rings[each.loop]))
        if len(together) < most and not near[each.loop][around].any():
            near[each.loop][around] = True
            together.append(each)
    for some in (together, together[: len(together) // 2], *([each] for each in found[:MOST_ROUNDS])):
        with suppress(InvalidMeshError):
            if some:
                return _without(rings, some)
    return None


def _without(rings: Sequence[FloatArray], removals: Sequence[_Removal]) -> Mesh:
    """The mesh of rings without some edges that are not near each other. Raises InvalidMeshError where edges cross."""
    left, gone = [ring.copy() for ring in rings], [np.zeros(len(ring), bool) for ring in rings]
    for each in removals:
        if len(gone[each.loop]) - gone[each.loop].sum() > 3:
            gone[each.loop][each.gone] = True
            left[each.loop][each.moved] = each.to
    return Mesh.from_loops([ring[~out] for ring, out in zip(left, gone, strict=True)])


def _removals(loop: int, ring: FloatArray, edges: BoolArray, side: int) -> Iterator[_Removal]:
    """For each edge of a ring that may go the way that adds the least area, if there is one."""
    if len(ring) <= 3:
        return
    along = np.roll(ring, -1, axis=0) - ring
    turn = side * cross(np.roll(along, 1, axis=0), along)
    for k in np.flatnonzero(edges).tolist():
        end = (k + 1) % len(ring)
        before, here, there, after = (ring[(k + step) % len(ring)] for step in (-1, 0, 1, 2))
        ways: list[_Removal] = []
        if turn[k] <= 0.0:
            ways.append(_Removal(-0.5 * float(turn[k]), loop, k, k, end, there))
        if turn[end] <= 0.0:
            ways.append(_Removal(-0.5 * float(turn[end]), loop, k, end, k, here))
        sine = side * float(cross(here - before, after - there))
        if not ways and sine > 0.0:
            corner = here + side * float(cross(there - here, after - there)) / sine * (here - before)
            ways.append(_Removal(0.5 * abs(float(cross(there - here, corner - here))), loop, k, end, k, corner))
        if ways:
            yield min(ways)
