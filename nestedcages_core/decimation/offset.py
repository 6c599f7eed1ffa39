"""The rounded offset: what a cage at a large clearance encloses, with as many vertices as the cage can use."""

from __future__ import annotations

from math import cos, pi

from ..geometry.mesh import Mesh
from ..geometry.precision import NEGLIGIBLE
from ..geometry.solids import mesh_of
from ..libraries import load_shapely
from .base import MIN_PER_LOOP
from .line_cycles import is_narrow
from .problem import Problem

WIDE = 1e-3
"""Clearance, in diagonals, from which the rounded offset is looked at."""

ARC, SMOOTH = 16, 1e-3
"""Edges of a quarter of a circle of the offset; detail that it leaves out, in clearances."""


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
    solid = load_shapely("A rounded offset").geometry.shape(fine.__geo_interface__)
    wide = solid.buffer(distance / cos(pi / (4 * ARC)), quad_segs=ARC)
    smooth = wide.simplify(SMOOTH * distance).buffer((SMOOTH + NEGLIGIBLE) * distance, join_style="mitre")
    return mesh_of(smooth)
