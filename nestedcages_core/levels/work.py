"""What a level is made from, and the methods and clearances that it is made with."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

from ..contact import Contact, SequentialQP
from ..decimation import LineCycles, Starts
from ..energies import Area
from ..errors import FlowError, NestedCagesError, NestingError, ReinflationError
from ..geometry.mesh import Mesh
from ..geometry.precision import INPUT_ROUND_OFF
from .plan import Plan
from .progress import OutOfTimeError, Watch
from .report import Level
from .settings import DEFAULT_CLEARANCE, Settings
from .units import SolverUnits

FAILURES: tuple[type[NestedCagesError], ...] = (FlowError, ReinflationError, NestingError, OutOfTimeError)
"""Errors after which another way or start is tried, while there is time; any other error ends the run."""

CLEARANCE_REDUCTION = 0.1
"""Factor on the default clearance where the gaps of the fine mesh are too narrow for it."""

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
    within: Callable[[Mesh], bool] | None = None
    """Whether a cage stays within a tolerance, where tightening ends early if not."""
    below: float = inf
    """Excess from which on a cage is not worth moving onto certain numbers."""

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

    def misses(self, level: Level) -> bool:
        """Whether a cage misses a wish."""
        return any(self.plan.missed(level.cage, must=False))

    def merit(self, level: Level) -> float:
        """Smaller is better: the excess, or the part of the area that a cage inside loses; a wish that it misses is
        worth the area of the drawing."""
        return self.plan.side * level.excess + self.misses(level)


def methods_for(settings: Settings, plan: Plan) -> Settings:
    """The settings with methods that can keep the constraints of a plan. Raises NestingError where none is allowed.

    Convex cages are made around hulls: from lines outside, and of least area. Cages inside start from lines inside.
    """
    decimation = settings.decimation
    lines = decimation if isinstance(decimation, LineCycles) else LineCycles(on_curve=False)
    if lines is decimation and not settings.steps:
        settings = replace(settings, decimation=lines.outside)
    if plan.outline.per_loop:
        settings = replace(settings, decimation=lines.outside, fallback=None, energy=Area())
    if plan.side < 0:
        fallback = None if settings.fallback is None else lines.inside
        return replace(settings, decimation=lines.inside, fallback=fallback)
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

    See docs/numbers.md: sequential QPs first; sequential QPs; IPC behind sequential QPs.
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
