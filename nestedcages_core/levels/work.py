"""What a level is made from, a cage on its way, and the methods that a level works with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

from ..contact import Contact, SequentialQP
from ..contact.reinflation import Reinflation
from ..decimation import LineCycles, Start, Starts
from ..energies import Area, CageEnergy
from ..errors import NestingError
from ..flow import FlowResult
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.precision import INPUT_ROUND_OFF
from .plan import Plan
from .progress import Watch
from .report import Level
from .settings import DEFAULT_CLEARANCE, Settings
from .units import SolverUnits

CLEARANCE_REDUCTION = 0.1
"""Factor on the default clearance where the gaps of the fine mesh are too narrow for it."""

LOOSE_ON_GRID = 0.1
"""Part of the excess that a grid may add before other starts are tried."""

MAX_CLEARANCE = 1e6
"""Upper bound of a clearance in diagonals: beyond it, floating-point numbers cannot represent the shape."""


@dataclass(frozen=True)
class Work:
    """What a level is made from."""

    plan: Plan
    settings: Settings
    clearances: tuple[float, ...]
    """In input units: the wanted one, then smaller ones for gaps that are too narrow for it."""
    watch: Watch
    along: bool = False
    """Whether starts go along the sequence of outlines, so that the cage need not have all loops."""
    room: float = 0.0
    """Kept in addition to the clearance until the cage is put on certain numbers, which takes it."""
    below: float = inf
    """Loss from which on a cage is not worth moving onto certain numbers."""

    @cached_property
    def units(self) -> SolverUnits:
        """The units of the solvers."""
        return SolverUnits.of(self.plan.fine, 0.0 if self.plan.numbers is None else self.plan.numbers.room)

    @cached_property
    def unit_fine(self) -> Mesh:
        """The fine mesh in the units of the solvers."""
        return self.units.from_input(self.plan.fine)

    @property
    def rests(self) -> bool:
        """Whether the fine mesh stays where it is: around a cage inside it, or where hulls stand for it."""
        return self.plan.side < 0 or self.plan.outline.inner is not None

    @property
    def compares(self) -> bool:
        """Whether the area decides between cages from rival starts."""
        free = self.settings.fallback is not None and self.plan.importance is None
        return free and isinstance(self.settings.energy, Area)

    def loss(self, level: Level) -> float:
        """The excess of a cage, or the part of the area that one inside loses."""
        return self.plan.side * level.excess

    def misses(self, level: Level) -> bool:
        """Whether a cage misses a wish."""
        return any(self.plan.missed(level.cage, must=False))

    def merit(self, level: Level) -> float:
        """Smaller is better: what a cage loses; a wish that it misses is worth the area of the drawing."""
        return self.loss(level) + self.misses(level)


@dataclass(frozen=True, eq=False)
class Draft:
    """A cage before its certificate, in the units of the solvers."""

    start: Start
    """With its coarse mesh in input units."""
    unit_coarse: Mesh
    flow: FlowResult
    reinflation: Reinflation
    energy: CageEnergy
    tightening: Sequence[FloatArray] = ()
    """The cages (m, 2) of the tightening."""
    iterations: tuple[int, int] = (0, 0)
    """Steps and quadratic programs of the tightening."""
    excess: float = inf
    """That of the cage, or lost area if inside."""
    still: bool = False
    """Whether it stays as it is, untightened."""
    rank: float = inf
    """Smaller is better: the excess, or the energy where that is no area."""

    @property
    def cage(self) -> FloatArray:
        """(m, 2)."""
        return self.tightening[-1] if len(self.tightening) else self.reinflation.cage_steps[-1]


def methods_for(settings: Settings, plan: Plan) -> Settings:
    """The settings with methods that can keep the constraints of a plan. Raises NestingError where none is allowed.

    Convex cages are made around hulls: from lines outside, and of least area. Cages inside start from lines inside.
    """
    decimation = settings.decimation
    if isinstance(decimation, LineCycles) and not settings.steps:
        settings = replace(settings, decimation=decimation.outside)
    if plan.outline.per_loop:
        decimation = decimation.outside if isinstance(decimation, LineCycles) else LineCycles(on_curve=False)
        settings = replace(settings, decimation=decimation, fallback=None, energy=Area())
    if plan.side < 0:
        inside = decimation.inside if isinstance(decimation, LineCycles) else LineCycles(on_curve=False, side=-1)
        return replace(settings, decimation=inside, fallback=None if settings.fallback is None else inside)
    if plan.group is None:
        return settings
    if not all(isinstance(each, SequentialQP) for each in contacts_for(settings)):
        raise NestingError(
            f"Symmetric cages need contact=SequentialQP(), not {settings.contact!r}; leave it out.",
            code="setting.conflict",
        )
    if not isinstance(decimation, Starts):
        raise NestingError(
            f"Symmetric cages need decimation=LineCycles(), not {decimation!r}.", code="setting.conflict"
        )
    return settings


def contacts_for(settings: Settings, *, own: bool = False) -> tuple[Contact, ...]:
    """The contacts to try in turn: the user's, or sequential QPs; from an own coarse mesh also IPC, which takes longer.

    See docs/ablation.md: sequential QPs first; sequential QPs; IPC behind sequential QPs.
    """
    if isinstance(settings.contact, Sequence):
        return tuple(settings.contact)
    if settings.contact is not None:
        return (settings.contact,)
    if not own:
        return (SequentialQP(),)
    from ..contact.ipc import IPC

    return SequentialQP(), IPC(energy=settings.energy)


def clearances_for(settings: Settings, fine: Mesh) -> tuple[float, ...]:
    """The clearances to try in turn, in the units of the input: only the default one may be reduced.

    Raises NestingError for a clearance that is too large for floating-point numbers.
    """
    wanted, diagonal = settings.clearance, fine.diagonal
    if wanted is None:
        lengths = [DEFAULT_CLEARANCE * diagonal]
        while lengths[-1] * CLEARANCE_REDUCTION >= INPUT_ROUND_OFF * diagonal:
            lengths.append(lengths[-1] * CLEARANCE_REDUCTION)
        return tuple(lengths)
    if wanted > MAX_CLEARANCE * diagonal:
        raise NestingError(
            f"The clearance {wanted:.6g} is more than {MAX_CLEARANCE:.0g} times as long as the diagonal of the "
            f"fine mesh, {diagonal:.6g}; ask for less.",
            code="clearance.too_large",
            wanted=wanted,
            largest=MAX_CLEARANCE * diagonal,
        )
    return (wanted,)
