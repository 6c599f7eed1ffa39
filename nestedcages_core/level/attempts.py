"""The attempts for one level, best first: starts, contacts, clearances and fallbacks.

This file alone decides what follows a failure: `level` runs the attempts in turn until one gives a certified cage.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite

import numpy as np

from ..contact import Contact, SequentialQP
from ..decimation import Count, Decimation, LineCycles, Start, Starts
from ..decimation.cycle_search import OFFSET
from ..energies import Area
from ..errors import FlowError, NestingError
from ..flow import FlowMethod
from ..flow.loop_matching import match_loops
from ..geometry.mesh import Mesh
from ..geometry.precision import INPUT_ROUND_OFF
from .plan import Plan
from .settings import DEFAULT_CLEARANCE, LevelSettings

CLEARANCE_REDUCTION = 0.1
"""Factor on the default clearance where the gaps of the fine mesh are too narrow for it."""


MAX_CLEARANCE = 1e6
"""Upper bound of a clearance in diagonals: beyond it, floating-point numbers cannot represent the shape."""

LOOSE = 0.5
"""Excess above which a note says what fewer loops would give and, from a user's own coarse mesh, the next contact is
tried too: around needles the contacts end in different minima."""

PAPER_PREFERENCE = 0.01
"""A cage from flow and reinflation is preferred to one that needed neither, unless the latter is tighter by more than
this fraction of its excess."""

NO_EXCESS = 3e-4
"""Excess up to which the clearance decides: a cage from flow and reinflation is not compared."""


@dataclass(frozen=True)
class Attempt:
    """Cages from one or several coarse meshes; the tightest one that can be certified is the level."""

    source: Mesh | Decimation
    """A user's own coarse mesh, or a decimation."""
    count: Count
    """Vertices of the coarse meshes."""
    flow: FlowMethod
    """Brings the fine mesh inside the coarse ones."""
    contacts: tuple[Contact, ...]
    """Tried in turn: each starts over where the one before is blocked."""
    clearances: tuple[float, ...]
    """In input units: the wanted one, then smaller ones for gaps that are too narrow for it."""
    fallback: bool = False
    """Whether this differs from what was asked for."""
    may_fall_back: bool = True
    """Whether to try something else if flow or reinflation fails."""
    seeks_area: bool = False
    """Whether the cage of least area is sought, so that the areas of coarse meshes are bounds."""

    def again(self, excess: float) -> Attempt | None:
        """The same with the next contact, where a cage from a user's own coarse mesh is loose."""
        if excess <= LOOSE or len(self.contacts) < 2 or not isinstance(self.source, Mesh) or not self.seeks_area:
            return None
        return replace(self, contacts=self.contacts[1:])


def methods_for(settings: LevelSettings, plan: Plan) -> LevelSettings:
    """The settings with methods that can keep the constraints of a plan. Raises NestingError where none is allowed.

    Convex cages are made around hulls: from lines outside, and of least area.
    """
    decimation = settings.decimation
    if plan.outline.per_loop:
        decimation = getattr(decimation, "outside", LineCycles(on_curve=False))
        settings = replace(settings, decimation=decimation, fallback=None, energy=Area())
    if plan.group is None:
        return settings
    contacts = contacts_for(settings)
    if not all(getattr(each, "keeps_ties", False) for each in contacts):
        raise NestingError(
            f"Symmetric cages need contact=SequentialQP(), not {settings.contact!r}; leave it out.",
            code="setting.conflict",
        )
    if not isinstance(decimation, Starts):
        raise NestingError(
            f"Symmetric cages need decimation=LineCycles(), not {decimation!r}.", code="setting.conflict"
        )
    outside = getattr(decimation, "outside", decimation)
    return replace(settings, contact=contacts, fallback=None if settings.fallback is None else outside)


def attempts(
    settings: LevelSettings, fine: Mesh, wanted: Count | Mesh, clearances: tuple[float, ...], side: int = 1
) -> Iterator[Attempt]:
    """The attempts for the level around ``fine``, or inside it, with a vertex count or the user's own coarse mesh."""
    if side < 0:
        yield from _attempts_inside(settings, fine, wanted, clearances)
        return
    size = len(wanted.vertices) if isinstance(wanted, Mesh) else wanted
    flow, contacts = settings.flow, contacts_for(settings, own=isinstance(wanted, Mesh))
    if isinstance(wanted, Mesh):
        last = Attempt(wanted, size, flow, contacts, clearances)
    else:
        decimation = settings.decimation
        may_fall_back = settings.fallback is not None
        if may_fall_back and _prefers_curve(decimation):
            # starts outside need no flow and lead to cages as tight: give up on it early
            flow = getattr(flow, "quick", flow)
        last = Attempt(decimation, wanted, flow, contacts, clearances, may_fall_back=may_fall_back)
    last = replace(last, seeks_area=getattr(settings.energy, "is_area", False))
    yield last
    if settings.fallback is not None and settings.fallback != last.source:
        counts = _counts(fine, wanted)
        last = Attempt(settings.fallback, counts, flow, contacts, clearances, fallback=True)
        around = getattr(settings.decimation, "outside", settings.fallback)
        if isinstance(wanted, Mesh) and around != settings.fallback:  # line cycles: tighter, where there are any
            yield replace(last, source=around)
        yield last


def _attempts_inside(
    settings: LevelSettings, fine: Mesh, wanted: Count | Mesh, clearances: tuple[float, ...]
) -> Iterator[Attempt]:
    """The same for a cage inside ``fine``: starts rest inside it, so nothing flows."""
    first = getattr(settings.decimation, "inside", LineCycles(on_curve=False, side=-1))
    count: Count = len(wanted.vertices) if isinstance(wanted, Mesh) else wanted
    last = Attempt(first, count, settings.flow, (), clearances)
    if isinstance(wanted, Mesh):
        yield replace(last, source=wanted)
        if settings.fallback is None:
            return
        alike = np.array_equal(wanted.loop_signs, fine.loop_signs)
        count = [len(loop) for loop in wanted.loops] if alike else max(len(wanted.vertices), 3 * len(fine.loops))
        last = replace(last, count=count, fallback=True)
    yield last


def in_turn(start: Start, fine: Mesh, attempt: Attempt) -> Generator[Start, float, None]:
    """The meshes of a start that are worth trying; a generator that is sent the rank of each.

    A rank is smaller where a cage is better, and infinite where there is none. First on the curve, as in the paper;
    then as it is, where that led nowhere or its own cage would probably be tighter.
    """
    if start.on_curve is not None:
        least = yield Start(start.on_curve, "on the curve")
        enough = (1.0 + PAPER_PREFERENCE) * _excess(start, fine, attempt.clearances[0]) if attempt.seeks_area else inf
        if not attempt.may_fall_back or (isfinite(least) and least <= max(enough, NO_EXCESS)):
            return
    yield start


def contacts_for(settings: LevelSettings, *, own: bool = False) -> tuple[Contact, ...]:
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


def _prefers_curve(source: Mesh | Decimation) -> bool:
    """Whether starts come with meshes on the curve."""
    return bool(getattr(source, "on_curve", False))


def _excess(start: Start, fine: Mesh, clearance: float) -> float:
    """The excess of a start, less what its lines keep away from the fine mesh beyond the clearance."""
    away = max(0.0, OFFSET * fine.diagonal - clearance)
    return (start.coarse.area - away * float(start.coarse.edge_lengths.sum())) / fine.area - 1.0


def clearances_for(settings: LevelSettings, fine: Mesh) -> tuple[float, ...]:
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


def _counts(fine: Mesh, wanted: Count | Mesh) -> Count:
    """For the fallback: the vertices of each loop of the coarse mesh, or their total where its loops are others."""
    if not isinstance(wanted, Mesh):
        return wanted
    total = max(len(wanted.vertices), 3 * len(fine.loops))
    if len(wanted.loops) != len(fine.loops):
        return total
    try:
        return [len(wanted.loops[k]) for k in match_loops(fine, wanted).partner]
    except FlowError:
        return total
