"""Certificates of levels: the only place where a level is made.

Whatever made or changed a cage, its final numbers are judged here: that it is nested, simple and as far away as wanted,
that it keeps its constraints, that its steps form a chain, and that they move without collisions after the flow. The
report tells what was measured.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from typing import NamedTuple

import numpy as np

from ..contact.pairs import Bodies
from ..contact.reinflation import Reinflation
from ..errors import Fault, NestingError, note
from ..flow import FlowResult
from ..geometry.mesh import Mesh
from ..progress import Tick, no_tick
from ..verification.certificate import Certificate, loops_in_words
from ..verification.motion import certify_motion
from .plan import Plan
from .report import Level, NestingReport


class UnsettledError(NestingError):
    """A cage has no place on the numbers asked for."""

    excess: float = inf
    """Of the cage before it moved there, or lost area if inside."""


class Path(NamedTuple):
    """How a cage comes about: it is the last step of the reinflation."""

    coarse: Mesh
    flow: FlowResult
    reinflation: Reinflation

    @property
    def cage(self) -> Mesh:
        """The coarse mesh moved there."""
        return self.coarse.moved(self.reinflation.cage_steps[-1])

    @classmethod
    def of(cls, level: Level) -> Path:
        """That of a level."""
        return cls(level.coarse, level.flow, level.reinflation)

    @classmethod
    def at_rest(cls, fine: Mesh, coarse: Mesh) -> Path:
        """That of a coarse mesh which is the cage."""
        rest = fine.vertices[None]
        return cls(coarse, FlowResult(rest, 0, "inside"), Reinflation(rest, coarse.vertices[None], 0))

    def leads(self, fine: Mesh, cage: Mesh) -> bool:
        """Whether the steps are a chain from a fine mesh back to it, and from the coarse mesh to a cage."""
        flow, moving, cages = self.flow.steps, self.reinflation.moving_steps, self.reinflation.cage_steps
        there = flow[0], flow[-1], moving[-1], cages[0], cages[-1]
        wanted = fine.vertices, moving[0], fine.vertices, self.coarse.vertices, cage.vertices
        return len(moving) <= len(cages) and all(map(np.array_equal, there, wanted))

    def is_stored(self, stored: str | None) -> bool:
        """Whether a type holds all steps but the fine mesh itself; None: any does."""
        if stored is None:
            return True
        moving, cages = np.concatenate([self.flow.steps, self.reinflation.moving_steps]), self.reinflation.cage_steps
        held = (moving == moving.astype(stored)) | (moving == moving[0])
        return bool(held.all()) and np.array_equal(cages, cages.astype(stored))


@dataclass(frozen=True, eq=False)
class Verdict:
    """A cage of a plan, and what is wrong with it; true if nothing is."""

    cage: Mesh
    plan: Plan
    wanted: float
    """The clearance asked for."""
    certificate: Certificate
    fault: Fault | None

    def __bool__(self) -> bool:
        return self.fault is None

    @property
    def is_only_too_close(self) -> bool:
        """Whether its nesting lacks nothing but the clearance."""
        found = self.certificate
        return found.strict and found.simple and len(found.problems) == 1 and found.clearance < self.wanted


def judge(plan: Plan, cage: Mesh, wanted: float, *, whole: bool = True, same_loops: bool | None = None) -> Verdict:
    """The verdict on a cage of a plan at a clearance.

    whole: whether it must keep what only finished cages do, too, as every level that is handed out.
    same_loops: whether the loops must match; None: where it has as many as the fine mesh. A user's own coarse mesh may
    wrap several parts in one loop or cover holes.
    """
    alike = cage.has_loops_like(plan.fine) if same_loops is None else same_loops
    certificate = plan.verify(cage, wanted, same_loops=alike)
    fault = next(iter(certificate.problems), None) or next(plan.missed(cage, whole=whole), None)
    return Verdict(cage, plan, wanted, certificate, fault)


def certify(
    verdict: Verdict, path: Path, report: NestingReport, *, stored: str | None = None, tick: Tick = no_tick
) -> Level:
    """The level of a judged cage at the end of a path. stored: the type that holds the steps.

    Raises NestingError if the cage has a fault, or where its steps are no chain, collide or are not stored numbers.
    """
    fine, cage, plan, found = verdict.plan.fine, verdict.cage, verdict.plan, verdict.certificate
    if verdict.fault is not None:
        raise NestingError(verdict.fault)
    if not path.leads(fine, cage) or not path.is_stored(stored):
        said = "The steps of the level do not lead to its cage, or not on the numbers asked for."
        raise NestingError(said, code="certificate.failed", problems=(said,))
    moves = path.reinflation
    motion = certify_motion(Bodies.of(cage, fine), list(moves.cage_steps), list(moves.fine_path), tick=tick)
    if not motion:
        raise NestingError(
            f"The motion from step {motion.step} to the next could not be certified free of collisions; "
            f"use more cage vertices{'' if plan.side < 0 else ', or a coarse mesh closer to the fine one'}.",
            code="motion.collides",
            step=motion.step,
        )
    report = replace(
        report,
        strict=found.strict,
        simple=found.simple,
        clearance=found.clearance,
        wanted_clearance=verdict.wanted,
        excess=cage.area / fine.area - 1.0,
        grid=None if plan.numbers is None else plan.numbers.grid,
        stored=stored,
        lost=found.lost,
    )
    return Level(fine, path.coarse, cage, path.flow, path.reinflation, report, plan.side)


def rerouted(level: Level, path: Path, stored: str | None = None) -> Level:
    """The level with other steps to the same cage; stored: the type that holds them. Raises NestingError."""
    verdict = judge(Plan.of(level.fine, side=level.side), level.cage, level.report.wanted_clearance)
    other = certify(verdict, path, level.report, stored=stored)
    return replace(other, report=replace(other.report, grid=level.report.grid))


def lost_loops(cage: Mesh, fine: Mesh, certificate: Certificate) -> tuple[Fault, ...]:
    """What became of loops, where a cage has others than the mesh in it."""
    if cage.has_loops_like(fine):
        return ()
    return (note("note.loops", given=loops_in_words(cage), wanted=loops_in_words(fine), **certificate.lost.note),)


def standing(fine: Mesh, cage: Mesh, report: NestingReport, wanted: float, *, side: int = 1) -> Level:
    """The level of a cage that stands still, with a mesh in it or around it, and that no constraint binds.

    Raises NestingError.
    """
    verdict = judge(Plan.of(fine, side=side), cage, wanted, same_loops=False)
    return certify(verdict, Path.at_rest(fine, cage), report)
