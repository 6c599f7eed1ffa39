"""Holes that a clearance nearly fills: their loops start as small polygons at the widest place.

See docs/ablation.md: room in small holes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...geometry.arrays import FloatArray
from ...geometry.loops import Loops
from ...geometry.mesh import Mesh
from ...geometry.precision import MOST_ROUNDS
from ...geometry.signed_distance import SignedDistance
from .offset import shortfall

GRID_SIZE = 32
"""Points along each side of the grids that search for the widest place of a hole."""

REFINED_POINTS = 8
"""Number of best points of a grid that are refined."""

MAX_SHORTFALL = 0.02
"""Shortfall of a loop, in clearances, above which the first steps of a tightening may not repair it."""

POLYGON_SIZE = 0.9
"""Size of the small polygon as a fraction of the free circle."""


class Circle(NamedTuple):
    """A circle in a hole."""

    centre: FloatArray
    """(2,)."""
    radius: float


def largest_circle(fine: Mesh, hole: int) -> Circle:
    """The largest circle inside a hole of a mesh, ignoring what lies in the hole, by refined grids."""
    loop = fine.loops[hole]
    distance = SignedDistance(fine.vertices[loop], fine.edge_ends[loop], outside=-1)
    low, high = fine.vertices[loop].min(axis=0), fine.vertices[loop].max(axis=0)
    width, middles = high - low, (0.5 * (low + high))[None]
    steps = np.linspace(-0.5, 0.5, GRID_SIZE)
    grid = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(1, -1, 2)
    for _ in range(MOST_ROUNDS):
        points: FloatArray = np.concatenate((middles, (middles[:, None] + width * grid).reshape(-1, 2)))
        room = distance.at(points).distance
        best = np.argsort(-room)[:REFINED_POINTS]
        middles, width = points[best], 4.0 * width / GRID_SIZE  # two steps on either side
    return Circle(middles[0], float(room[best[0]]))


def with_room(coarse: Mesh, fine: Mesh, clearance: float) -> Mesh:
    """The coarse mesh, whose loop k belongs to loop k of the fine one, with small polygons for the holes that are too
    close to it, if these are empty and have space for the clearance."""
    loops = [coarse.vertices[loop] for loop in coarse.loops]
    changed = False
    for k in np.flatnonzero(fine.loop_signs < 0).tolist():
        single = Loops.of(loops[k], [len(loops[k])])
        if shortfall(single, fine, clearance).max() <= MAX_SHORTFALL * clearance or (fine.parent_of_loop == k).any():
            continue
        circle = largest_circle(fine, k)
        if circle.radius > clearance:
            angles = 2.0 * np.pi * np.arange(len(loops[k])) / len(loops[k])
            size = POLYGON_SIZE * (circle.radius - clearance)
            loops[k] = circle.centre + size * np.stack((np.cos(angles), np.sin(angles)), axis=1)
            changed = True
    return Mesh.from_loops(loops) if changed else coarse
