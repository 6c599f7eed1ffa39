"""The plan of a level: a mesh, what cages keep, and what is decimated. The builder alone couples them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from ..decimation import Count, Start
from ..decimation.base import NOTHING_KEPT, Kept, LevelTarget
from ..energies import CageEnergy
from ..errors import Fault, NestingError, note
from ..geometry.arrays import FloatArray
from ..geometry.group import Symmetry, mirror_axis
from ..geometry.mesh import Mesh, outer_and_inner
from ..verification import Certificate, verify
from .units import SolverUnits

if TYPE_CHECKING:
    from ..constraints.base import Bound, Constraint
    from ..constraints.numbers import Numbers
    from ..decimation.importance import Importance


@dataclass(frozen=True, eq=False)
class Plan:
    """What the builder works from."""

    fine: Mesh
    """What cages are solved around."""
    side: int
    """1 for cages around the fine mesh, -1 for cages inside it."""
    outline: LevelTarget
    constraints: tuple[Constraint, ...] = ()
    """What cages keep."""
    importance: Importance | None = None
    """Where vertices matter."""

    @classmethod
    def of(
        cls,
        fine: Mesh,
        constraints: tuple[Constraint, ...] = (),
        importance: Importance | None = None,
        *,
        side: int = 1,
    ) -> Plan:
        """The plan of one level. Raises NestingError."""
        outline = LevelTarget(fine, fine)
        for constraint in constraints:
            outline = constraint.outline(outline, side)
        kept = tuple(constraint.around(outline.mesh) for constraint in constraints)
        return cls(outline.fine, side, outline, kept, importance)

    @property
    def is_free(self) -> bool:
        """Whether cages keep nothing but their clearance."""
        return not self.constraints and self.importance is None

    @property
    def group(self) -> Symmetry | None:
        """The symmetry that cages have exactly."""
        return next((each.group for each in self.constraints if each.group is not None), None)

    @property
    def numbers(self) -> Numbers | None:
        """What coordinates may be; None: all doubles."""
        return cast("Numbers | None", next((each for each in self.constraints if each.settles), None))

    @property
    def grid(self) -> float | None:
        """Length of which coordinates are multiples."""
        return None if self.numbers is None else self.numbers.grid

    @property
    def has_wishes(self) -> bool:
        """Whether there are constraints that may be missed."""
        return not all(each.must for each in self.constraints)

    def kept(self) -> Kept:
        """What is kept as far as lines show it; a symmetry of the outline is preferred where nothing is."""
        if not self.is_free:
            rules = tuple(each for each in self.constraints if each.is_rule)
            return Kept(self.group, None, self.importance, rules)
        axis = mirror_axis(self.outline.mesh) if self.side > 0 else None
        if axis is None:
            return NOTHING_KEPT
        from ..geometry.symmetry import Mirror

        point, direction = (tuple(each.tolist()) for each in axis)
        return Kept(preferred=Mirror(point, direction))

    def verify(self, cage: Mesh, clearance: float, *, same_loops: bool = True) -> Certificate:
        """The certificate of a cage of this plan; its excess is that of the outer mesh."""
        return verify(*outer_and_inner(cage, self.fine, self.side), clearance, same_loops=same_loops)

    def possible(self, wanted: int, *, unlimited: bool = False) -> tuple[Count, tuple[Fault, ...]]:
        """A number of vertices that the outline and all constraints allow, or one per loop; and notes, of the least
        one. unlimited: whether it may be larger than that of the outline."""
        outline = self.outline.mesh
        if not self.outline.per_loop:
            available = wanted if unlimited else min(wanted, len(outline.vertices))
            fewer = (note("note.count", on="mesh", asked=wanted, given=available),) if available < wanted else ()
            return self._agreed(outline, available, fewer)
        loops = [Mesh.from_loops([outline.vertices[loop]]) for loop in outline.loops]
        agreed = [self._agreed(loop, wanted, ()) for loop in loops]
        return [count for count, _ in agreed], min(agreed, key=lambda each: each[0])[1]

    def number(self, mesh: Mesh) -> int:
        """The number of vertices that a mesh around the outline counts as."""
        return max(len(loop) for loop in mesh.loops) if self.outline.per_loop else len(mesh.vertices)

    def _agreed(self, outline: Mesh, count: int, notes: tuple[Fault, ...]) -> tuple[int, tuple[Fault, ...]]:
        """A number of vertices around an outline that all constraints allow."""
        tried: set[int] = set()
        while count not in tried:
            tried.add(count)
            for constraint in self.constraints:
                possible = constraint.count(outline, count)
                if possible != count:
                    said = {} if constraint.group is None else {"symmetry": str(constraint.group)}
                    notes += (note("note.count", on=constraint.on, asked=count, given=possible, **said),)
                    count = possible
        return count, notes

    def started(self, start: Start) -> Start:
        """A start as constraints make it. Raises NestingError where they do not allow it."""
        coarse, on_curve = self._started(start.coarse), start.on_curve
        if coarse is not start.coarse and on_curve is not None:
            with suppress(NestingError):
                on_curve = self._started(on_curve)
            on_curve = None if on_curve is start.on_curve else on_curve
        return Start(coarse, start.source, on_curve)

    def _started(self, coarse: Mesh) -> Mesh:
        """The start from a coarse mesh. Raises NestingError."""
        given = coarse.vertices[None]
        snapped = self.snapped(coarse, given)
        return coarse if snapped is given else coarse.moved(snapped[0]).validated()

    def snapped(self, coarse: Mesh, steps: FloatArray) -> FloatArray:
        """(K, m, 2) steps of a cage from a coarse mesh, in the input's units, with equalities exact."""
        for constraint in self.constraints:
            steps = constraint.snapped(coarse, steps, self.side)
        return steps

    def bounds(self, coarse: Mesh, units: SolverUnits) -> tuple[Bound, ...]:
        """The constraints on cages with the edges of a coarse mesh, in the units of the solvers."""
        if not self.constraints:
            return ()
        from ..constraints.base import Bound  # which bounds nothing

        unit_fine = units.from_input(self.fine)
        every = [constraint.bound(coarse, unit_fine, units) for constraint in self.constraints]
        return tuple(bound for bound in every if type(bound) is not Bound)

    def clearances(self, units: SolverUnits) -> FloatArray | None:
        """(n,) the distance that constraints ask for from each fine vertex, in the units of the solvers."""
        every = [each for constraint in self.constraints if (each := constraint.distances(self.fine)) is not None]
        if not every:
            return None
        of_loops = np.array([units.clearance(length) for length in np.max(every, axis=0).tolist()])
        return np.asarray(of_loops[self.fine.loop_of_vertex])

    def energy(self, energy: CageEnergy, coarse: Mesh, units: SolverUnits) -> CageEnergy:
        """The energy with what matters and the terms of constraints.

        coarse: in the units of the solvers.
        """
        if self.side < 0:
            from ..energies.lost_area import LostArea

            energy = energy.with_area(LostArea(units.from_input(self.fine).area))
        if self.is_free:
            return energy
        importance, outline = self.importance, units.from_input(self.outline.mesh)
        if importance is not None and importance.weights is not None:
            from ..energies.weighted_area import weighted

            at = importance.at
            measure = weighted(
                coarse, outline, lambda points: at(units.to_input(points)), self.side, hulls=self.outline.per_loop
            )
            energy = energy.with_area(measure)
        terms = [term for each in self.constraints if (term := each.term(coarse, units)) is not None]
        if terms:
            from ..energies.weighted_sum import WeightedSum

            energy = WeightedSum(tuple((1.0, term) for term in (energy, *terms)))
        return energy

    def missed(self, cage: Mesh, *, must: bool = True, whole: bool = True) -> Iterator[Fault]:
        """What a cage does not keep: promises, or wishes. whole: also of what only finished cages have."""
        for constraint in self.constraints:
            if bool(constraint.must) is must and (whole or constraint.is_rule):
                fault = constraint.fault(cage, self.fine)
                if fault is not None:
                    yield fault if isinstance(fault, Fault) else Fault(fault, "constraint.missed")

    def mended(self, cage: Mesh) -> tuple[Mesh, Fault] | None:
        """See `Constraint.mended`."""
        every = (found for each in self.constraints if (found := each.mended(cage)) is not None)
        return next((found for found in every if len(found[0].vertices) < len(cage.vertices)), None)
