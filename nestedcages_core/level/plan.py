"""The plan of a level: one slot per mathematical object. Needs fill the slots; the builder alone couples them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ..decimation.base import clamped
from ..energies import CageEnergy
from ..errors import Fault
from ..geometry.group import Symmetry
from ..geometry.mesh import Mesh
from .units import SolverUnits


class Need:
    """A promise besides the number of vertices. It sees the plan, never another need."""

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
    group: Symmetry | None = None
    """Symmetries that cages have exactly."""
    remarks: tuple[Fault, ...] = ()
    """Notes of the report."""

    @classmethod
    def of(cls, fine: Mesh, needs: Sequence[Need] = (), *, side: int = 1) -> Plan:
        """The plan of one level. Raises NestingError."""
        plan = cls(fine, side, tuple(needs), fine)
        for need in needs:
            plan = need.fill(plan)
        return plan

    @property
    def inside(self) -> bool:
        """Whether cages lie inside the fine mesh."""
        return self.side < 0

    def with_remarks(self, *remarks: Fault) -> Plan:
        """The plan with further notes."""
        return replace(self, remarks=(*self.remarks, *remarks))

    def possible(self, wanted: int) -> tuple[int, tuple[Fault, ...]]:
        """A number of vertices that the outline and all needs allow, and a note for each replacement."""
        count, notes = clamped(wanted, self.outline)
        tried: set[int] = set()
        while count not in tried:
            tried.add(count)
            for need in self.needs:
                count, replaced = need.count(self, count)
                notes += replaced
        return count, notes

    def energy(self, energy: CageEnergy, coarse: Mesh, units: SolverUnits, clearance: float) -> tuple[CageEnergy, bool]:
        """The energy with the terms of all needs, and whether there are any; see `Need.energy`."""
        changed = False
        for need in self.needs:
            other = need.energy(self, energy, coarse, units, clearance)
            if other is not None:
                energy, changed = other, True
        return energy, changed

    def notes(self, cage: Mesh, clearance: float) -> tuple[Fault, ...]:
        """A sentence for each wish that a cage misses."""
        return tuple(note for need in self.needs for note in need.notes(self, cage, clearance))
