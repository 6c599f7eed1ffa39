"""The rounded offset: what a cage at a large clearance encloses, with as many vertices as the cage can use."""

from __future__ import annotations

from math import cos, pi
from typing import Any

import numpy as np

from ..errors import InvalidMeshError
from ..geometry.mesh import Mesh
from ..geometry.precision import NEGLIGIBLE
from ..libraries import has_shapely, load_shapely
from .base import MIN_PER_LOOP
from .line_cycles import is_narrow
from .problem import Problem

WIDE = 1e-3
"""Clearance, in diagonals, from which the rounded offset is looked at."""

ARC, FINE_ARC, SMOOTH = 16, 64, 1e-3
"""Edges of a quarter of a circle of the offset, and of a fine one; detail that is left out, in clearances."""


def is_wide(fine: Mesh, count: int, clearance: float) -> bool:
    """Whether a clearance rounds corners that a number of vertices shows, or closes gaps."""
    if clearance <= WIDE * fine.diagonal:
        return False
    if is_round(fine, count, clearance):
        return True
    if len(fine.loops) == 1:
        return False
    problem = Problem.of(fine, MIN_PER_LOOP * len(fine.loops))
    narrow = is_narrow(problem.outline, problem.regions, 2.0 * clearance)
    return narrow or bool((fine.loop_signs < 0).any())


def is_round(fine: Mesh, count: int, clearance: float) -> bool:
    """Whether a number of vertices shows that a clearance rounds corners."""
    return clearance > WIDE * fine.diagonal and 2.0 * pi * clearance * count > float(fine.edge_lengths.sum())


def rounded_offset(fine: Mesh, distance: float) -> Mesh:
    """A mesh whose solid contains all within a distance of the fine one, and little more.

    Raises NestedCagesError where shapely is missing.
    """
    from ..geometry.solids import mesh_of  # which needs shapely

    wide = _buffered(fine, distance, ARC)
    smooth = wide.simplify(SMOOTH * distance).buffer((SMOOTH + NEGLIGIBLE) * distance, join_style="mitre")
    return mesh_of(smooth)


def offset_loop_by_loop(fine: Mesh, distance: float, side: int) -> Mesh | None:
    """A mesh whose loops k are at least a distance outside those of the fine one (side 1), or inside (-1), and little
    more; None where some vanish or meet, for small distances, and without shapely."""
    if distance <= WIDE * fine.diagonal or not has_shapely():
        return None
    from ..geometry.solids import mesh_of

    try:
        mesh = mesh_of(_buffered(fine, side * distance, FINE_ARC))
    except InvalidMeshError:
        return None
    owner = fine.loop_of_vertex[fine.edge_search.closest(mesh.vertices).edge]
    loops = {int(np.bincount(owner[loop]).argmax()): mesh.vertices[loop] for loop in mesh.loops}
    if not mesh.has_loops_like(fine) or len(loops) < len(mesh.loops):
        return None
    return Mesh.from_loops([loops[k] for k in range(len(loops))])


def _buffered(fine: Mesh, distance: float, arc: int) -> Any:
    """The solid with all within a distance, or without where that is negative; arcs have edges beyond it."""
    solid = load_shapely("A rounded offset").geometry.shape(fine.__geo_interface__)
    return solid.buffer(distance / cos(pi / (4 * arc)), quad_segs=arc)
