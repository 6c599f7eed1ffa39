"""Elimination: equalities between the motions of vertices leave fewer unknowns.

The motions of m vertices are D = S d, with S of one or two 2 × 2 blocks a vertex. A program in D becomes one in d with
the gradient Sᵀ G, the Hessian Sᵀ W S and the rows J S. Its solution keeps the equalities by construction, whatever the
data (Nocedal & Wright, Numerical Optimization, section 15.3).

* Images of each other under a symmetry move together: d is the motion of the first vertex of each orbit.
* Edges of fixed direction move along their normals: d is the offset of their line. Where a line with tangent t and
  offset g follows one with tangent u and offset h, the vertex moves by (h t - g u) / (u × t). Within a line it slides.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..energies import Blocks
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.group import Orbits
from ..geometry.precision import ROUND_OFF
from ..geometry.vectors import cross, norm, rotated_left
from .banded import BandOrder, Rows
from .quadratic_program import InteriorPoint, QPSolution, QuadraticProgram


@dataclass(frozen=True, eq=False)
class Elimination:
    """S of m vertices over u blocks of two unknowns."""

    block: IntArray
    """(w, m) the one or two blocks of each vertex."""
    linear: FloatArray
    """(w, m, 2, 2) motion of each vertex per unknowns of its blocks."""
    inverse: FloatArray
    """(w, m, 2, 2) unknowns of its blocks per motion of each vertex."""
    edge_group: IntArray
    """(m,) the same number for all edges that are shifted alike, by their starts."""
    successor: IntArray
    """(m,)."""
    stretch: FloatArray | None = None
    """(m,) how much farther a vertex can move than its unknowns, at corners that are not right; None: none does."""
    tangent: FloatArray | None = None
    """(u, 2) along the lines that blocks stand for, which give their axes; NaN: those of their first vertices."""

    @classmethod
    def of_images(cls, orbits: Orbits, successor: IntArray) -> Elimination:
        """That of a symmetric mesh; on an axis a vertex moves by the projection onto it."""
        turned = orbits.symmetry.about_origin()
        linear = np.stack([turned.image(np.eye(2), k).T for k in range(turned.order)])[orbits.element]
        linear[orbits.on_axis[orbits.orbit]] = turned.fixed(np.eye(2)).T
        back = linear.transpose(0, 2, 1)
        return cls(orbits.orbit[None], linear[None], back[None], orbits.edge_orbit(successor), successor)

    @classmethod
    def of_lines(
        cls, tangent: FloatArray, fixed: BoolArray, successor: IntArray, images: Elimination | None = None
    ) -> Elimination:
        """That of a mesh whose edges keep their unit tangents (m, 2) where they are fixed (m,).

        images: of its symmetry, under which fixed edges are images of fixed edges.
        """
        m, vertex = len(successor), np.arange(len(successor))
        before = np.empty(m, np.int64)
        before[successor] = vertex
        moved, orbit, edge_group = np.tile(np.eye(2), (m, 1, 1)), vertex, vertex
        if images is not None:
            moved, orbit, edge_group = images.linear[0], images.block[0], images.edge_group
        both, sine = fixed & fixed[before], cross(tangent[before], tangent)
        corner = both & (np.abs(sine) > ROUND_OFF)
        edge_group = _joined(edge_group, before[both & ~corner], vertex[both & ~corner])
        lines, line = np.unique(edge_group, return_inverse=True)  # of free edges, too, which no vertex has
        own, free = np.where(fixed, vertex, before), ~fixed & ~fixed[before]
        along, normal = tangent[own], rotated_left(tangent)

        # within a line: its offset, and a slide like that of the first vertex of the orbit
        first = np.unique(orbit, return_index=True)[1]
        slide = np.einsum("kij,kj->ki", moved, along[first][orbit])
        slide[norm(slide) < 0.5] = 0.0  # along an axis, the projection of what is across it
        shifts, readings = [normal[own], slide], [normal[own], slide]
        bases = [normal[lines][line[own]], along[first][orbit]]
        block = np.stack((line[own], len(lines) + orbit))
        # at a corner: the offsets of both lines
        wide = np.where(corner, sine, 1.0)[:, None]
        for k, (shift, edge) in enumerate(((-tangent[before] / wide, vertex), (tangent / wide, before))):
            shifts[k] = np.where(corner[:, None], shift, shifts[k])
            readings[k] = np.where(corner[:, None], normal[edge], readings[k])
            bases[k] = np.where(corner[:, None], normal[lines][line[edge]], bases[k])
            block[k] = np.where(corner, line[edge], block[k])
        longest = np.maximum(norm(shifts[0] + shifts[1]), norm(shifts[0] - shifts[1])) / np.sqrt(2.0)
        stretch = np.where(corner, np.maximum(longest, 1.0), 1.0)
        linear = np.stack([_outer(shift, base) for shift, base in zip(shifts, bases, strict=True)])
        inverse = np.stack([_outer(base, reading) for base, reading in zip(bases, readings, strict=True)])
        # at the end of no fixed edge: its own motion
        linear[:, free], inverse[:, free] = 0.0, 0.0
        linear[1, free], inverse[1, free] = moved[free], moved[free].transpose(0, 2, 1)
        block[0, free] = block[1, free]

        axis = np.concatenate((tangent[lines], np.where(free[first][:, None], np.nan, along[first])))
        used, dense = np.unique(block, return_inverse=True)
        return cls(dense.reshape(block.shape), linear, inverse, edge_group, successor, stretch, axis[used])

    @property
    def count(self) -> int:
        """u."""
        return len(self.first[0])

    @property
    def slots(self) -> range:
        """The numbers of blocks of a vertex."""
        return range(len(self.block))

    @cached_property
    def first(self) -> tuple[IntArray, IntArray]:
        """(u,) the first vertex of each block, and which of its blocks that is."""
        slot, vertex = np.divmod(np.unique(self.block, return_index=True)[1], self.block.shape[1])
        return vertex, slot

    @cached_property
    def order(self) -> BandOrder:
        """An order of the blocks that keeps neighbours close together."""
        other = self.block[:, self.successor]
        pairs = [(one, two) for one in self.block for two in other]
        pairs += [(self.block[0], two) for two in self.block[1:]]
        row, column = (np.concatenate(each) for each in zip(*pairs, strict=True))
        return BandOrder.of(self.count, row, column)

    def solve(
        self, solver: InteriorPoint, program: QuadraticProgram, absolute: float, order: BandOrder | None = None
    ) -> QPSolution:
        """The solution of a program over all m vertices that keeps the equalities; order: of the blocks."""
        solution = solver.solve(self.program(program), absolute, order)
        return replace(solution, step=self.motion(solution.step))

    def program(self, program: QuadraticProgram) -> QuadraticProgram:
        """The program in d."""
        axes = program.axes[self.first[0]]
        if self.tangent is not None:
            own = np.stack((self.tangent, rotated_left(self.tangent)), axis=1)
            axes = np.where(np.isnan(own), axes, own)
        return replace(
            program,
            gradient=self._gradient(program.gradient),
            hessian=self._hessian(program.hessian),
            rows=[self.rows(group) for group in program.rows],
            radius=self._least(program.radius if self.stretch is None else program.radius / self.stretch),
            axes=axes,
        )

    def motion(self, unknowns: FloatArray) -> FloatArray:
        """S d, (m, 2) from (u, 2)."""
        moved = _applied(self.linear[0], unknowns[self.block[0]])
        for slot in self.slots[1:]:
            moved = moved + _applied(self.linear[slot], unknowns[self.block[slot]])
        return moved

    def scaled(self, motion: FloatArray, fraction: FloatArray) -> FloatArray:
        """(m, 2) a motion that keeps the equalities, each unknown reduced by the least fraction (m,) it moves."""
        least = self._least(fraction)
        if len(self.block) == 1:
            return np.asarray(least[self.block[0]][:, None] * motion)
        vertex, slot = self.first
        return self.motion(least[:, None] * _applied(self.inverse[slot, vertex], motion[vertex]))

    def least(self, values: FloatArray) -> FloatArray:
        """(m,) the least of the values (m,) of vertices that are images of each other."""
        return self._least(values)[self.block[0]] if len(self.block) == 1 else values

    def largest_of_edges(self, values: FloatArray) -> FloatArray:
        """(m,) the largest of the values (m,) of edges that are shifted alike."""
        largest = np.full(len(values), -np.inf)
        np.maximum.at(largest, self.edge_group, values)
        return largest[self.edge_group]

    def longest(self, motion: FloatArray) -> FloatArray:
        """(m, 2) a motion that keeps the equalities: for each block the longest unknowns of a motion (m, 2)."""
        back = np.concatenate(self.readings(motion))
        by_length = np.argsort(back[:, 0] ** 2 + back[:, 1] ** 2, kind="stable")
        unknowns = np.zeros((self.count, 2))
        unknowns[self.block.ravel()[by_length]] = back[by_length]  # the last value written stays
        return self.motion(unknowns)

    def readings(self, motion: FloatArray) -> list[FloatArray]:
        """w times (m, 2) the unknowns of its blocks that a motion (m, 2) of each vertex stands for."""
        return [_applied(self.inverse[slot], motion) for slot in self.slots]

    def _least(self, values: FloatArray) -> FloatArray:
        least = np.full(self.count, np.inf)
        for block in self.block:
            np.minimum.at(least, block, values)
        return least

    def _gradient(self, gradient: FloatArray) -> FloatArray:
        total = np.zeros((self.count, 2))
        for slot in self.slots:
            back = _applied(self.linear[slot].transpose(0, 2, 1), gradient)
            for axis in (0, 1):
                total[:, axis] += np.bincount(self.block[slot], back[:, axis], len(total))
        return total

    def _hessian(self, hessian: Blocks) -> Blocks:
        parts = []
        for one in self.slots:
            for two in self.slots:
                # a block on the diagonal is symmetric: of the two products across it one stands for both
                kept = slice(None) if one == two else np.flatnonzero((hessian.row != hessian.column) | (one < two))
                i, j, value = hessian.row[kept], hessian.column[kept], hessian.value[kept]
                value = self.linear[one][i].transpose(0, 2, 1) @ value @ self.linear[two][j]
                row, column = self.block[one][i], self.block[two][j]
                folded = (row == column) & ((i != j) | (one != two))  # its mirror image falls on the diagonal too
                value[folded] += value[folded].transpose(0, 2, 1)
                parts.append(Blocks(row, column, value))
        return parts[0] if len(parts) == 1 else Blocks.sum([(1.0, part) for part in parts])

    def rows(self, rows: Rows) -> Rows:
        """J S."""
        vertex = np.concatenate([self.block[slot][rows.vertex] for slot in self.slots])
        direction = np.empty((len(vertex), 2, rows.count))
        for j, own in enumerate(rows.vertex):
            given = rows.directions[:, min(j, rows.directions.shape[1] - 1)]
            for slot in self.slots:
                along = _applied(self.linear[slot][own].transpose(0, 2, 1), given)
                direction[slot * len(rows.vertex) + j] = (rows.weight[j][:, None] * along).T
        for j in range(1, len(vertex)):
            for i in range(j):  # two of the same block become one unknown
                same = vertex[i] == vertex[j]
                direction[i][:, same] += direction[j][:, same]
                direction[j][:, same] = 0.0
        return Rows(vertex, np.ones(vertex.shape), direction)


def _applied(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    """(K, 2) matrices (K, 2, 2) times vectors (K, 2)."""
    out: FloatArray = np.matmul(matrices, vectors[:, :, None])[:, :, 0]
    return out


def _outer(u: FloatArray, v: FloatArray) -> FloatArray:
    """(K, 2, 2) u vᵀ of vectors (K, 2)."""
    return u[:, :, None] * v[:, None, :]


def _joined(group: IntArray, one: IntArray, other: IntArray) -> IntArray:
    """(m,) the least number of all groups (m,) that pairs of members connect."""
    for _ in range(len(group)):
        least = group.copy()
        np.minimum.at(least, group[one], group[other])
        np.minimum.at(least, group[other], group[one])
        if np.array_equal(least[group], group):
            break
        group = least[group]
    return group
