"""Further steps of the flow, for animations: the fine mesh is inside the coarse one and shrinks on, until it shows.

The same descent of the penetration energy with margins that grow towards a quarter of the local thickness. The
return takes the same steps, so the cage is the one without them.
"""

from __future__ import annotations

import numpy as np

from ..errors import FlowError, InvalidMeshError
from ..geometry.arrays import FloatArray
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh
from ..geometry.precision import PART_OF_GAP
from ..geometry.vectors import dot, rotated_left
from .containment import Containment
from .energy_flow import StepSystem
from .loop_matching import match_loops
from .penetration import PenetrationEnergy, Spacing
from .two_sided import TwoSidedFlow

STEPS = 8
"""Number of further steps: smooth to look at, and about as many as the tightening has."""

DESCENTS = 2
"""Gauss-Newton steps per step that is recorded."""

SMOOTHINGS = (0.03, 0.01)
"""Smoothing lengths to try, in extents: the first keeps dense outlines smooth, the second small features apart."""

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
    none: FloatArray = np.empty((0, *start.shape))
    if len(coarse.vertices) > MAX_COARSE:
        return none
    try:
        matching = match_loops(fine, coarse)
    except FlowError:
        return none
    containment, unit = Containment(matching), fine.extent
    energy = PenetrationEnergy(matching, 0.0, Spacing(np.inf, TwoSidedFlow.spacing * unit), from_coarse=False)
    system, margins = StepSystem(fine, TwoSidedFlow.spacing * unit), PART_OF_GAP * thickness(coarse)
    found = []
    for smoothing in SMOOTHINGS:
        vertices, steps = start, []
        for k in range(1, STEPS + 1):
            energy.margins = k / STEPS * margins
            vertices = _descended(energy, system, vertices, smoothing * unit)
            if containment.obstacle(vertices) is not None or not _is_simple(fine, vertices):
                break
            steps.append(vertices)
        if len(steps) == STEPS:
            return np.stack(steps)
        found.append(steps)
    longest = max(found, key=lambda steps: float(np.abs(steps[-1] - start).mean()) if steps else -1.0)
    return np.stack(longest) if longest else none


def _descended(energy: PenetrationEnergy, system: StepSystem, vertices: FloatArray, smoothing: float) -> FloatArray:
    """Positions (n, 2) after a few steps of descent."""
    here = energy.at(vertices)
    for _ in range(DESCENTS):
        moved = vertices + system.direction(here, smoothing)
        after = energy.at(moved)
        if not after.energy < here.energy:
            break
        vertices, here = moved, after
    return vertices


def thickness(mesh: Mesh) -> FloatArray:
    """(m,) thickness of the shape at the middle of each edge, at most twice area by perimeter of its component."""
    starts, ends, lengths = mesh.vertices, mesh.edge_ends, mesh.edge_lengths
    middles, inward = 0.5 * (starts + ends), rotated_left(ends - starts)
    perimeters = np.bincount(mesh.loop_of_vertex, lengths)
    areas = mesh.loop_signs * np.abs(mesh.loop_areas)
    component = mesh.component_of_loop
    sizes = 2.0 * np.bincount(component, areas) / np.bincount(component, perimeters)
    along = np.empty(len(starts))
    for loop in mesh.loops:
        along[loop] = np.cumsum(lengths[loop]) - 0.5 * lengths[loop]
    result: FloatArray = sizes[component[mesh.loop_of_vertex]]
    for k, loop in enumerate(mesh.loop_of_vertex.tolist()):
        way = middles - middles[k]
        straight = np.hypot(way[:, 0], way[:, 1])
        arc = np.abs(along - along[k])
        arc = np.minimum(arc, perimeters[loop] - arc)
        beside = (mesh.loop_of_vertex == loop) & (arc < ACROSS * straight)
        opposite = ~beside & (dot(way, inward[k]) > FACING * lengths[k] * straight)
        if opposite.any():
            gaps = point_edge(middles[k], starts[opposite], ends[opposite]).distance
            result[k] = min(result[k], float(gaps.min()))
    return result


def _is_simple(mesh: Mesh, vertices: FloatArray) -> bool:
    """Whether the mesh with other vertices (n, 2) is valid."""
    try:
        Mesh(vertices, mesh.edges)
    except InvalidMeshError:
        return False
    return True
