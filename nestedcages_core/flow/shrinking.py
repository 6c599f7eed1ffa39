"""Further steps of the flow, for animations: the fine mesh is inside the coarse one and shrinks on, until it shows.

The same descent of the penetration energy with margins that grow towards a quarter of the local thickness. The return
takes the same steps, so the cage is the one without them.
"""

from __future__ import annotations

import numpy as np

from ..errors import FlowError, InvalidMeshError
from ..geometry.arrays import FloatArray
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh
from ..geometry.precision import PART_OF_GAP
from ..geometry.vectors import dot, norm, rotated_left
from .containment import obstacle
from .matching import match_loops
from .penetration import PenetrationEnergy, Spacing
from .step_system import StepSystem
from .two_sided import TwoSidedFlow

STEPS = 8
"""Number of further steps: smooth to look at, and about as many as the tightening has."""

DESCENTS = 2
"""Gauss-Newton steps per step that is recorded."""

SMOOTHING = 0.03
"""Smoothing length in extents: dense outlines stay smooth."""

ACROSS = 2.0
"""Distance along the loop, in straight distances, from which on an edge counts as opposite instead of next to."""

FACING = 0.3
"""Least cosine between the inward normal and the direction to an opposite edge."""

MAX_COARSE = 1000
"""Largest number of coarse vertices: thickness compares all pairs."""


def shrink(fine: Mesh, coarse: Mesh, start: FloatArray) -> FloatArray:
    """Further steps (S, n, 2) from positions (n, 2) inside the coarse mesh, each simple and certified inside.

    They end before the first step that is not; there may be none.
    """
    steps: list[FloatArray] = []
    try:
        matching = match_loops(fine, coarse)
    except FlowError:
        matching = None
    if matching is not None and len(coarse.vertices) <= MAX_COARSE:
        unit, here = TwoSidedFlow.spacing * fine.extent, start
        energy = PenetrationEnergy(fine, coarse, matching, 0.0, Spacing(np.inf, unit), from_coarse=False)
        system, margins = StepSystem(fine, unit), PART_OF_GAP * thickness(coarse)
        for k in range(1, STEPS + 1):
            energy.margins = k / STEPS * margins
            for _ in range(DESCENTS):
                before = energy.at(here)
                moved = here + system.direction(before, SMOOTHING * fine.extent)
                if energy.at(moved).energy < before.energy:
                    here = moved
            if obstacle(fine, coarse, here) is not None or not _is_simple(fine, here):
                break
            steps.append(here)
    return np.array(steps).reshape(-1, *start.shape)


def thickness(mesh: Mesh) -> FloatArray:
    """(m,) thickness of the shape at the middle of each edge, at most twice area by perimeter of its component."""
    starts, ends, lengths, loop = mesh.vertices, mesh.edge_ends, mesh.edge_lengths, mesh.loop_of_vertex
    middles, inward = 0.5 * (starts + ends), rotated_left(ends - starts) / lengths[:, None]
    perimeters = np.bincount(loop, lengths)
    component = mesh.component_of_loop
    areas = np.bincount(component, mesh.loop_signs * np.abs(mesh.loop_areas))
    sizes = 2.0 * areas / np.bincount(component, perimeters)
    along = np.empty(len(starts))
    for places in mesh.loops:
        along[places] = np.cumsum(lengths[places]) - 0.5 * lengths[places]
    way = middles - middles[:, None]
    straight, arc = norm(way), np.abs(along - along[:, None])
    arc = np.minimum(arc, perimeters[loop] - arc)
    beside = (loop == loop[:, None]) & (arc < ACROSS * straight)
    opposite = ~beside & (dot(way, inward[:, None]) > FACING * straight)
    gaps = np.where(opposite, point_edge(middles[:, None], starts, ends).distance, np.inf)
    return np.asarray(np.minimum(sizes[component[loop]], gaps.min(axis=1)), np.float64)


def _is_simple(mesh: Mesh, vertices: FloatArray) -> bool:
    """Whether the mesh with other vertices (n, 2) is valid."""
    try:
        Mesh(vertices, mesh.edges)
    except InvalidMeshError:
        return False
    return True
