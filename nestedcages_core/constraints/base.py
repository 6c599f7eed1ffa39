"""What cages keep in addition to nesting: the base classes of all constraints.

A `Constraint` is in the units of the input: limits of lines at the start, and a judge of finished cages. Its `Bound` is
in the units of the solvers: inequalities on cages of one topology. Every hook has a default here that asks for nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, ClassVar, NamedTuple, Protocol

import numpy as np

from ..errors import Fault, NestedCagesError
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.broad_phase import BoxTree
from ..geometry.group import Symmetry
from ..geometry.mesh import Mesh
from ..geometry.precision import ROUND_OFF
from ..geometry.smallest_gap import smallest_gap
from ..solver.banded import Rows

if TYPE_CHECKING:
    from ..decimation.base import LevelTarget
    from ..decimation.outline import Lines, Outline
    from ..decimation.sampling import NormalFrame
    from ..energies import CageEnergy
    from ..solver.elimination import Elimination

LARGEST = 1e100
"""Upper bound of numbers in rows, so that their squares are finite."""


class Terms(NamedTuple):
    """K linear inequalities room + J D ≥ 0 on the motion D of a cage; room and J D are lengths."""

    rows: Rows
    """J."""
    room: FloatArray
    """(K,)."""


class Units(Protocol):
    """The units of the solvers: the fine mesh's bounding box has its centre at the origin and a diagonal of 1."""

    @property
    def scale(self) -> float:
        """Their length in the units of the input."""

    def points(self, points: FloatArray) -> FloatArray:
        """Points (..., 2) of the input in these units."""

    def to_input(self, points: FloatArray) -> FloatArray:
        """Points (..., 2) of these units in those of the input."""

    def clearance(self, length: float) -> float:
        """A distance of the input in these units, with a margin for rounding."""


class Rounding(Protocol):
    """The numbers that coordinates of cages may be; see `Numbers`."""

    def nearest(self, points: FloatArray) -> FloatArray:
        """These numbers next to points (..., 2)."""

    def exact(self, points: FloatArray) -> FloatArray:
        """The doubles that stored points (..., 2) stand for."""


class Bound:
    """A constraint on cages of one topology, in the units of the solvers. The base class bounds nothing."""

    def rows(self, cage: FloatArray, radius: float) -> Iterable[Terms]:
        """The inequalities at a cage (m, 2) that motions of its vertices by at most a radius along two axes can break.

        With a radius of 0, those that are missed.
        """
        return ()

    def short(self, cage: FloatArray) -> FloatArray:
        """(m,) the length that the cage (m, 2) lacks at each vertex; by default, of the rows that are missed."""
        lack = np.zeros(len(cage))
        for rows, room in self.rows(cage, 0.0):
            for vertex in rows.vertex:  # numpy 1.26 reads past the end of values that it has to broadcast
                np.maximum.at(lack, vertex, -room)
        return lack

    def eliminated(self, images: Elimination | None, successor: IntArray) -> Elimination | None:
        """The unknowns where the constraint has equalities; images: those of the symmetry of the cage.

        successor: (m,) of its vertices; loops of cages inside are walked backwards.
        """
        return images

    def allowed(self, vertex: IntArray, start: FloatArray, end: FloatArray) -> BoolArray:
        """(K,) whether the edges from vertices (K,) may run from starts (K, 2) to ends (K, 2), on a grid."""
        return np.ones(len(vertex), bool)


class Constraint:
    """What cages keep, in the input's units. The base class asks for nothing."""

    must: bool = True
    """Whether a cage that misses it is an error, a promise; or has a note, a wish."""

    on: ClassVar[str] = "constraint"
    """What `note.count` says replaced a number of vertices."""
    is_rule: ClassVar[bool] = True
    """Whether lines of the start show it; others are judged on finished cages alone."""
    group: Symmetry | None = None
    """Symmetry that cages have exactly."""
    settles: ClassVar[bool] = False
    """Whether finished cages are moved onto certain numbers; see `Numbers`."""

    def of(self, about: Mesh, side: int) -> Constraint:
        """The constraint about a drawing, for cages around it (side 1) or inside it (-1). Raises NestingError."""
        return self

    def outline(self, outline: LevelTarget, side: int) -> LevelTarget:
        """What cages of a level are made around, such as the union of images. Raises NestingError."""
        return outline

    def around(self, outline: Mesh) -> Constraint:
        """The constraint of a level around, or inside, an outline."""
        return self

    def rounded(self, numbers: Rounding) -> Constraint:
        """The constraint where cages are put on certain numbers."""
        return self

    def count(self, outline: Mesh, count: int) -> int:
        """The closest possible number of vertices around, or inside, an outline."""
        return count

    def distances(self, fine: Mesh) -> FloatArray | None:
        """(L,) distance to keep from each loop of the mesh inside, or around, on top of the clearance; None: none."""
        return None

    @property
    def turn_limits(self) -> tuple[float, float]:
        """The least length of an edge, and angle in degrees, that the start looks for."""
        return 0.0, 0.0

    def candidates(self, outline: Outline, at: IntArray, lines: Lines, frame: NormalFrame, shift: float) -> Lines:
        """The candidate lines of the start next to a loop, in the units of the frame; all others if need be.

        at: (N,) vertices that stretches begin at. shift: by which lines are then moved away from the loop.
        """
        return lines

    def reach(self, outline: Outline, lines: Lines, shift: float) -> FloatArray:
        """(2, K) how far own candidates run from their contacts forwards and backwards, in units of the frame."""
        return np.full((2, len(lines)), np.inf)

    def free(self, lines: Lines, frame: NormalFrame) -> FloatArray:
        """(2, K) how far candidate lines of the start run from their points forwards and backwards, in the units of
        the frame; negative: a line is no candidate."""
        return np.full((2, len(lines)), np.inf)

    def snapped(self, coarse: Mesh, steps: FloatArray, side: int) -> FloatArray:
        """(K, m, 2) cages (K, m, 2) with the edges of a coarse mesh, moved to where equalities hold exactly.

        Raises NestingError where the coarse mesh does not allow it.
        """
        return steps

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        """The constraint on cages with the edges of a coarse mesh; both meshes are in the units of the solvers."""
        return Bound()

    def term(self, coarse: Mesh, units: Units) -> CageEnergy | None:
        """A term of the energy of cages with the edges of a coarse mesh, which is in the units of the solvers."""
        return None

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        """Why a cage does not keep it, judged on its final numbers: a sentence with the place and what helps.

        By default, what it lacks of the `distances`.
        """
        distances = self.distances(fine)
        for loop, wanted in () if distances is None else zip(fine.loops, distances.tolist(), strict=True):
            gap = smallest_gap(cage.edge_tree, BoxTree(fine.vertices[loop], fine.edge_ends[loop]))
            if gap < wanted * (1.0 - ROUND_OFF):
                x, y = fine.vertices[loop[0]].tolist()
                return Fault(
                    f"The cage comes as near as {gap:.6g} to the loop at ({x:.6g}, {y:.6g}); {wanted:.6g} is asked "
                    "for: ask for less there, or use more vertices.",
                    "cage.too_close",
                    clearance=gap,
                    wanted=wanted,
                )
        return None

    def mended(self, cage: Mesh) -> tuple[Mesh, Fault] | None:
        """A cage of fewer vertices that keeps it, made from one that does not, and a note."""
        return None


def are_finite(terms: Terms) -> bool:
    """Whether all numbers of rows are finite, with finite squares."""
    numbers = terms.rows.weight, terms.rows.direction, terms.room
    return all(bool((np.abs(each) < LARGEST).all()) for each in numbers)


def terms_of(bounds: Sequence[Bound], cage: FloatArray, radius: float) -> tuple[list[Rows], FloatArray]:
    """The rows and rooms of several bounds. Raises NestedCagesError where they are not finite."""
    every: list[Terms] = []
    for bound in bounds:
        terms = [Terms(*each) for each in bound.rows(cage, radius)]
        if not all(map(are_finite, terms)):
            sentence = f"{type(bound).__name__}.rows must yield finite numbers."
            raise NestedCagesError(sentence, code="constraint.failed", name=type(bound).__name__, method="rows")
        every += [each for each in terms if len(each.room)]
    return [terms.rows for terms in every], np.concatenate([np.zeros(0), *(terms.room for terms in every)])


def short_of(bounds: Sequence[Bound], cage: FloatArray) -> FloatArray:
    """(m,) the most that any bound lacks at each vertex."""
    most: FloatArray = np.max([np.zeros(len(cage)), *(bound.short(cage) for bound in bounds)], axis=0)
    return most
