"""The plan of a level: one slot per mathematical object. Needs fill the slots; the builder alone couples them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING, Protocol, TypeAlias

import numpy as np

from ..decimation import Count, Start
from ..decimation.budget import clamped
from ..energies import CageEnergy
from ..errors import Fault, NestingError, note
from ..geometry.arrays import FloatArray
from ..geometry.group import Symmetry
from ..geometry.mesh import Mesh, by_side
from ..tasks import Stage
from ..verification import Certificate, verify
from .units import SolverUnits

if TYPE_CHECKING:
    from ..constraints.base import Bound, Constraint

EdgeCost: TypeAlias = Callable[[int, FloatArray, FloatArray], FloatArray]
"""(K,) what an edge adds to the energy, in squared input units: its first vertex, and places (K, 2) of both ends."""


class Numbers(Protocol):
    """The numbers that coordinates of cages may be, if not all."""

    @property
    def spacing(self) -> float:
        """Distance between neighbours."""

    @property
    def grid(self) -> float | None:
        """The length that coordinates are multiples of, for the report."""

    @property
    def room(self) -> float:
        """Clearance that all cages have in reserve for these numbers; 0 where few need it."""

    @property
    def stored(self) -> str | None:
        """The name of the type that holds the coordinates, for the report; None for doubles."""

    def nearest(self, points: FloatArray) -> FloatArray:
        """These numbers next to points (..., 2)."""

    def exact(self, points: FloatArray) -> FloatArray:
        """The doubles that stored points (..., 2) stand for."""

    def settled(
        self, cage: Mesh, fine: Mesh, clearance: float, side: int, cost: EdgeCost | None
    ) -> Stage[float, FloatArray | None]:
        """(m, 2) places for the vertices of a cage, of least cost, or of least excess without one; None if none."""

    def finer(self) -> Iterator[Numbers]:
        """Finer numbers, tried for the message where these have no cage."""

    def hasty(self) -> Numbers:
        """The same numbers, on which places are not improved once there are some."""


class Need:
    """A promise in addition to the number of vertices. It sees the plan, never another need."""

    @property
    def places(self) -> FloatArray:
        """(P, 2) places on the outline that this need is about."""
        return np.empty((0, 2))

    def fill(self, plan: Plan) -> Plan:
        """The plan with the slots of this need filled. Raises NestingError where it has no cage."""
        return plan

    def count(self, plan: Plan, count: int) -> tuple[int, tuple[Fault, ...]]:
        """The closest possible number of vertices, and a note if it is another one."""
        return count, ()

    def energy(
        self, plan: Plan, energy: CageEnergy, coarse: Mesh, units: SolverUnits, clearance: float
    ) -> CageEnergy | None:
        """The energy of a cage with the terms of this need; None if it has none.

        coarse and clearance are in the units of the solvers.
        """
        return None

    def fault(self, plan: Plan, cage: Mesh) -> Fault | None:
        """Why a cage does not keep the promise, judged on its final numbers."""
        return None

    def mended(self, plan: Plan, cage: Mesh) -> tuple[Mesh, Fault] | None:
        """A cage of fewer vertices that keeps the promise, made from one that does not, and a note."""
        return None

    def notes(self, plan: Plan, cage: Mesh, clearance: float) -> tuple[Fault, ...]:
        """A sentence for each wish that a cage misses."""
        return ()


@dataclass(frozen=True, eq=False)
class Plan:
    """What the builder works from."""

    fine: Mesh
    side: int
    """1 for cages around the fine mesh, -1 for cages inside it."""
    needs: tuple[Need, ...]
    outline: Mesh
    """What is decimated: the fine mesh, or it and its images."""
    numbers: Numbers | None = None
    """What coordinates may be; None: all doubles."""
    group: Symmetry | None = None
    """Symmetries that cages have exactly."""
    inner: Mesh | None = None
    """The mesh that levels are about, where the fine one stands for it, resting and around it; None: the fine one."""
    per_loop: bool = False
    """Whether a number of vertices is that of each loop of the outline, not of all together."""
    remarks: tuple[Fault, ...] = ()
    """Notes of the report."""
    constraints: tuple[Constraint, ...] = ()
    """What cages keep in addition."""

    @classmethod
    def of(
        cls, fine: Mesh, needs: Sequence[Need] = (), constraints: tuple[Constraint, ...] = (), *, side: int = 1
    ) -> Plan:
        """The plan of one level. Raises NestingError."""
        plan = cls(fine, side, tuple(needs), fine, constraints=constraints)
        for need in needs:
            plan = need.fill(plan)
        return plan

    def verify(self, cage: Mesh, clearance: float, *, same_loops: bool = True) -> Certificate:
        """The certificate of a cage of this plan; its excess is that of the outer mesh."""
        return verify(*by_side(cage, self.fine, self.side), clearance, same_loops=same_loops)

    def possible(self, wanted: int) -> tuple[Count, tuple[Fault, ...]]:
        """A number of vertices that the outline and all needs allow, or one per loop; and notes, of the least one."""
        if not self.per_loop:
            return self._agreed(*clamped(wanted, self.outline))
        loops = [Mesh.from_loops([self.outline.vertices[loop]]) for loop in self.outline.loops]
        agreed = [replace(self, outline=loop)._agreed(wanted, ()) for loop in loops]
        return [count for count, _ in agreed], min(agreed, key=lambda each: each[0])[1]

    def number(self, mesh: Mesh) -> int:
        """The number of vertices that a mesh around the outline counts as."""
        return max(len(loop) for loop in mesh.loops) if self.per_loop else len(mesh.vertices)

    def _agreed(self, count: int, notes: tuple[Fault, ...]) -> tuple[int, tuple[Fault, ...]]:
        """A number of vertices that all needs allow."""
        tried: set[int] = set()
        while count not in tried:
            tried.add(count)
            for need in self.needs:
                count, replaced = need.count(self, count)
                notes += replaced
            for constraint in self.constraints:
                possible = constraint.count(self.outline, count)
                if possible != count:
                    notes += (note("note.count", on="constraint", asked=count, given=possible),)
                    count = possible
        return count, notes

    def started(self, starts: Sequence[Start]) -> list[Start]:
        """The starts that constraints allow. Raises the error of the first one if there are none."""
        allowed: list[Start] = []
        errors: list[NestingError] = []
        for start in starts:
            coarse = start.coarse
            try:
                for constraint in self.constraints:
                    coarse = constraint.started(coarse, self.side)
            except NestingError as error:
                errors.append(error)
            else:
                allowed.append(start if coarse is start.coarse else Start(coarse, start.source))
        if errors and not allowed:
            raise errors[0]
        return allowed

    def bounds(self, coarse: Mesh, units: SolverUnits) -> tuple[Bound, ...]:
        """The constraints on cages with the edges of a coarse mesh, in the units of the solvers."""
        unit_fine = units.from_input(self.fine)
        return tuple(constraint.bound(coarse, unit_fine, units) for constraint in self.constraints)

    def clearances(self, units: SolverUnits) -> FloatArray | None:
        """(n,) the distance that constraints ask for from each fine vertex, in the units of the solvers."""
        every = [each for constraint in self.constraints if (each := constraint.distances(self.fine)) is not None]
        if not every:
            return None
        of_loops = np.array([units.clearance(length) for length in np.max(every, axis=0).tolist()])
        return np.asarray(of_loops[self.fine.loop_of_vertex])

    def missed(self, cage: Mesh, *, must: bool = True) -> Iterator[Fault]:
        """The constraints that a cage does not keep: promises, or wishes."""
        for constraint in self.constraints:
            if constraint.must is must and (fault := constraint.fault(cage, self.fine)) is not None:
                yield fault

    def energy(self, energy: CageEnergy, coarse: Mesh, units: SolverUnits, clearance: float) -> tuple[CageEnergy, bool]:
        """The energy with the terms of all needs, and whether there are any; see `Need.energy`."""
        changed = False
        if self.side < 0:
            from ..energies.area import LostArea

            energy = energy.with_area(LostArea(units.from_input(self.fine).area))
        for need in self.needs:
            other = need.energy(self, energy, coarse, units, clearance)
            if other is not None:
                energy, changed = other, True
        return energy, changed

    def fault(self, cage: Mesh) -> Fault | None:
        """The first promise that a cage does not keep."""
        of_needs = (found for need in self.needs if (found := need.fault(self, cage)) is not None)
        return next(chain(of_needs, self.missed(cage)), None)

    def mended(self, cage: Mesh) -> tuple[Mesh, Fault] | None:
        """See `Need.mended`."""
        return next((found for need in self.needs if (found := need.mended(self, cage)) is not None), None)

    def notes(self, cage: Mesh, clearance: float) -> tuple[Fault, ...]:
        """A sentence for each wish that a cage misses."""
        of_needs = (found for need in self.needs for found in need.notes(self, cage, clearance))
        return (*of_needs, *self.missed(cage, must=False))

    def with_remarks(self, *remarks: Fault) -> Plan:
        """The plan with further notes."""
        return replace(self, remarks=(*self.remarks, *remarks))
