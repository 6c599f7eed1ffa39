"""The certificate of the flow: the moved fine mesh is strictly inside the coarse one, each loop on its side.

The fine mesh may cross itself as it moves, so "inside" is defined by winding numbers. Motion without contact preserves
them, and with them the original fine mesh lies strictly inside the coarse mesh, component by component.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.predicates import crossing_pairs
from .base import Obstacle
from .loop_matching import Matching, loop_tree, windings


class Containment:
    """Exact test of positions of the fine mesh against one coarse mesh."""

    def __init__(self, matching: Matching) -> None:
        self.matching = matching
        fine, coarse = matching.fine, matching.coarse
        self._fine_probe: IntArray = np.array([loop[0] for loop in fine.loops])
        self._coarse_probe: FloatArray = coarse.vertices[[loop[0] for loop in coarse.loops]]
        self._tree, self._order = loop_tree(coarse, coarse.vertices)
        same = matching.component[fine.component_of_loop][:, None] == coarse.component_of_loop[None, :]
        # around a fine loop: the outer loop of its component once, its holes never; other components: anything
        self._around_fine: IntArray = np.where(coarse.loop_signs > 0, 1, 0)[None, :] * same
        self._same = same
        self._around_coarse, self._prescribed = _windings_around_coarse(matching)

    def obstacle(self, vertices: FloatArray) -> Obstacle | None:
        """None if the fine mesh with vertices (n, 2) is certified inside, else the first obstacle found."""
        fine, coarse = self.matching.fine, self.matching.coarse
        tree, order = loop_tree(fine, vertices)
        i, j = crossing_pairs(tree, self._tree)
        if len(i):
            vertex, edge = order[i[0]], self._order[j[0]]
            x, y = vertices[vertex].tolist()
            cause = (
                f"Fine loop {fine.loop_of_vertex[vertex]} still crosses coarse loop {coarse.loop_of_vertex[edge]}"
                f" ({len(i)} crossing edges), at fine vertex {vertex}"
            )
            return Obstacle(cause, (x, y))
        return self._wrong_side_of_fine(vertices) or self._wrong_side_of_coarse(vertices)

    def _wrong_side_of_fine(self, vertices: FloatArray) -> Obstacle | None:
        fine, coarse = self.matching.fine, self.matching.coarse
        around = windings(vertices[self._fine_probe], coarse, coarse.vertices)
        wrong = self._same & (around != self._around_fine)
        if not wrong.any():
            return None
        k, loop = np.argwhere(wrong)[0]
        x, y = vertices[self._fine_probe[k]].tolist()
        kind = "outside" if coarse.loop_signs[loop] > 0 else "inside hole"
        name = _kind(fine.loop_signs[k])
        return Obstacle(f"{name} {k} of the fine mesh lies {kind} loop {loop} of the coarse mesh", (x, y))

    def _wrong_side_of_coarse(self, vertices: FloatArray) -> Obstacle | None:
        fine, coarse = self.matching.fine, self.matching.coarse
        around = windings(self._coarse_probe, fine, vertices)
        component_sum = np.zeros((len(coarse.loops), len(self.matching.component)), np.int64)
        np.add.at(component_sum.T, fine.component_of_loop, around.T)
        wrong = (self._prescribed & (around != self._around_coarse)).any(axis=1) | (component_sum != 0).any(axis=1)
        if not wrong.any():
            return None
        loop = int(np.nonzero(wrong)[0][0])
        x, y = self._coarse_probe[loop].tolist()
        return Obstacle(f"{_kind(coarse.loop_signs[loop])} {loop} of the coarse mesh lies inside the fine mesh", (x, y))


def _kind(sign: int) -> str:
    return "Outer loop" if sign > 0 else "Hole"


def _windings_around_coarse(matching: Matching) -> tuple[IntArray, BoolArray]:
    """(coarse loops, fine loops) required winding of the fine loop around the coarse one, and whether it is required.

    Around a coarse hole: -1 for its fine hole, 1 for the outer loop of that component. Around a coarse outer loop: 0
    for all fine loops of its component.
    """
    fine, coarse = matching.fine, matching.coarse
    inside = matching.component[fine.component_of_loop]
    wanted = np.zeros((len(coarse.loops), len(fine.loops)), np.int64)
    prescribed = np.zeros(wanted.shape, bool)
    for loop in range(len(coarse.loops)):
        if coarse.loop_signs[loop] > 0:
            prescribed[loop] = inside == coarse.component_of_loop[loop]
            continue
        for hole in np.nonzero(matching.partner == loop)[0]:
            own = fine.component_of_loop == fine.component_of_loop[hole]
            prescribed[loop] |= own
            wanted[loop, own & (fine.loop_signs > 0)] = 1
            wanted[loop, hole] = -1
    return wanted, prescribed
