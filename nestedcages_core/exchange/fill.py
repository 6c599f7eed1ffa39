"""Painted areas as one solid: fill rules, overlaps and self-crossings resolved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import InvalidMeshError
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.predicates import winding_number
from .arrangement import arranged


@dataclass(frozen=True)
class Painted:
    """Closed loops of points, each (k, 2), in any direction, painted by one rule."""

    loops: Sequence[FloatArray]
    evenodd: bool = False
    """Whether points are inside where the winding number is odd, else where it is not zero."""

    def painted(self, winding: IntArray) -> BoolArray:
        """(...,) whether places with these winding numbers are inside."""
        return np.asarray(winding % 2 == 1 if self.evenodd else winding != 0)


def solid(areas: Sequence[Painted]) -> Mesh:
    """The union of areas as a mesh. Loops without crossing keep their points to the last bit.

    Where the union touches itself in a point it becomes one by a neck as thin as a hair. Raises InvalidMeshError where
    nothing is inside.
    """
    loops, owner = _cleaned(areas)
    if not loops:
        raise InvalidMeshError("The shapes have no inside: every loop is shorter than three different points.")
    try:
        mesh = Mesh.from_loops(loops)
    except InvalidMeshError:
        return arranged(loops, owner, [area.painted for area in areas])
    kept = _on_the_rim(mesh, loops, owner, areas)
    if not kept.any():
        raise InvalidMeshError("The shapes have no inside.")
    return mesh if kept.all() else Mesh.from_loops([loops[k] for k in np.flatnonzero(kept)])


def _cleaned(areas: Sequence[Painted]) -> tuple[list[FloatArray], IntArray]:
    """All loops without repeated points, those without an inside left out, and the area of each."""
    loops, owner = [], []
    for k, area in enumerate(areas):
        for points in area.loops:
            loop = points[(points != np.roll(points, -1, axis=0)).any(axis=1)]
            if len(loop) > 2:
                loops.append(loop)
                owner.append(k)
    return loops, np.array(owner, dtype=np.int64)


def _on_the_rim(mesh: Mesh, loops: list[FloatArray], owner: IntArray, areas: Sequence[Painted]) -> BoolArray:
    """(L,) whether a loop has painted places on one side only; loops neither cross nor touch.

    mesh: made of the loops, in their order.
    """
    first = np.array([loop[0] for loop in loops])
    winding = np.zeros((len(loops), len(areas)), dtype=np.int64)  # around the first point of each loop, without itself
    own = np.empty(len(loops), dtype=np.int64)
    for k, loop in enumerate(loops):
        others = np.arange(len(loops)) != k
        winding[others, owner[k]] += winding_number(first[others], loop, np.roll(loop, -1, axis=0))
        begin = mesh.loops[k][0]
        as_given = mesh.successor[begin] == begin + 1
        own[k] = mesh.loop_signs[k] if as_given else -mesh.loop_signs[k]
    inside = winding.copy()
    inside[np.arange(len(loops)), owner] += own
    outside_painted = np.any([area.painted(winding[:, k]) for k, area in enumerate(areas)], axis=0)
    inside_painted = np.any([area.painted(inside[:, k]) for k, area in enumerate(areas)], axis=0)
    return np.asarray(outside_painted != inside_painted)
