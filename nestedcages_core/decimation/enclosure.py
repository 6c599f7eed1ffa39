"""Whether a coarse mesh strictly encloses a fine one, by exact predicates, and how far it keeps away from it."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import FloatArray
from ..geometry.broad_phase import near_pairs
from ..geometry.distance import point_edge
from ..geometry.mesh import Mesh
from ..geometry.predicates import BoxTree, crossing_pairs, winding_number
from .outline import Outline


class Enclosure:
    """A fine mesh as something to enclose; what is asked of it again and again is kept."""

    def __init__(self, fine: Mesh) -> None:
        order = np.concatenate(fine.loops)
        self.fine = fine
        self.starts, self.ends = fine.vertices[order], fine.vertices[fine.successor[order]]
        self.tree = BoxTree(self.starts, self.ends)

    def holds(self, coarse: Mesh) -> bool:
        """Whether the solid of the fine mesh lies inside that of a valid coarse mesh, and each loop k along loop k.

        If the boundaries do not meet, then it is enough that one vertex of each fine loop lies inside the coarse mesh
        and one of each coarse loop outside the fine one.
        """
        fine = self.fine
        if not np.array_equal(coarse.loop_signs, fine.loop_signs):
            return False
        starts, ends = coarse.vertices, coarse.vertices[coarse.successor]
        if len(crossing_pairs(self.tree, BoxTree(starts, ends))[0]):
            return False
        fine_points = fine.vertices[[loop[0] for loop in fine.loops]]
        coarse_points = coarse.vertices[[loop[0] for loop in coarse.loops]]
        if (winding_number(fine_points, starts, ends) != 1).any():
            return False
        if (winding_number(coarse_points, self.starts, self.ends) != 0).any():
            return False
        for k, sign in enumerate(fine.loop_signs):
            around, point = (coarse, fine_points[k]) if sign > 0 else (fine, coarse_points[k])
            loop = around.loops[k]
            if winding_number(point[None], around.vertices[loop], around.vertices[around.successor[loop]])[0] != sign:
                return False
        return True

    def shortfall(self, outline: Outline, distance: float) -> FloatArray:
        """(n,) how much farther each vertex of an outline has to go so that both of its edges keep a distance."""
        starts, ends = outline.vertices, outline.vertices[outline.successor]
        missing = np.zeros(len(starts))
        point, edge = near_pairs(self.fine.vertices, starts, ends, distance)
        short = distance - point_edge(self.fine.vertices[point], starts[edge], ends[edge]).distance
        np.maximum.at(missing, edge, short)
        np.maximum.at(missing, outline.successor[edge], short)
        vertex, edge = near_pairs(starts, self.starts, self.ends, distance)
        short = distance - point_edge(starts[vertex], self.starts[edge], self.ends[edge]).distance
        np.maximum.at(missing, vertex, short)
        return missing
