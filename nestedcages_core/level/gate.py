"""The gate: the only place where a level is made.

Whatever made or changed a cage, its final numbers are judged here: that it is nested, simple and as far away as wanted,
that it keeps its constraints, that its steps form a chain and move without collisions. The report tells what was
measured here. A level carries the seal of what was judged, so that nothing is judged twice: if it is changed, only what
is new is judged; :func:`passed` finds what was changed elsewhere.
"""

from __future__ import annotations

from dataclasses import replace
from hashlib import blake2b
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..contact.pairs import Bodies
from ..contact.reinflation import Reinflation
from ..errors import Fault, NestingError
from ..flow import FlowResult
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..progress import Tick, no_tick
from ..verification.motion import certify_motion
from .plan import Plan
from .report import JudgedCage, Level, NestingReport, Seal


class Way(NamedTuple):
    """How a cage comes about: it is the last step of the reinflation."""

    coarse: Mesh
    flow: FlowResult
    reinflation: Reinflation

    @property
    def cage(self) -> Mesh:
        """The coarse mesh moved there."""
        return self.coarse.moved(self.reinflation.cage_steps[-1])

    @classmethod
    def of(cls, level: Level) -> Way:
        """That of a level."""
        return cls(level.coarse, level.flow, level.reinflation)

    @classmethod
    def at_rest(cls, fine: Mesh, coarse: Mesh) -> Way:
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


def judged(
    plan: Plan, cage: Mesh, wanted: float, *, promised: bool = True, same_loops: bool | None = None
) -> JudgedCage:
    """The verdict on a cage of a plan at a clearance.

    promised: whether it must keep what only finished cages do, too, as every level that is handed out.
    same_loops: whether the loops must match; None: where it has as many as the fine mesh. A user's own coarse mesh may
    wrap several parts in one loop or cover holes.
    """
    alike = cage.has_loops_like(plan.fine) if same_loops is None else same_loops
    certificate = plan.verify(cage, wanted, same_loops=alike)
    fault = next(iter(certificate.problems), None)
    if fault is None:
        fault = next(plan.missed(cage, whole=promised), None)
    numbers = (None, None) if plan.numbers is None else (plan.numbers.grid, plan.numbers.stored)
    return JudgedCage(cage, plan.fine, plan.side, wanted, certificate, numbers if promised else None, fault)


def admitted(
    cage: JudgedCage,
    way: Way,
    report: NestingReport,
    before: Level | None = None,
    *,
    stored: str | None = None,
    tick: Tick = no_tick,
) -> Level:
    """The level of a judged cage. before: a level whose steps it shares; stored: the type that holds the steps.

    Raises NestingError if the cage has a fault, or where its steps are no chain, collide or are not stored numbers.
    """
    fine, mesh = cage.fine, cage.cage
    if cage.fault is not None:
        raise NestingError(cage.fault)
    if not way.leads(fine, mesh) or not way.is_stored(stored):
        raise _refusal("The steps of the level do not lead to its cage, or not on the numbers asked for.")
    links = _links(way.reinflation)
    known = set() if before is None or before.seal is None else set(before.seal.links)
    cages, fines = way.reinflation.cage_steps, way.reinflation.fine_path
    new = np.flatnonzero(np.diff([False, *(link not in known for link in links), False]))
    for first, last in new.reshape(-1, 2).tolist():
        steps = slice(first, last + 1)
        motion = certify_motion(Bodies.of(mesh, fine), list(cages[steps]), fines[steps], tick=tick)
        if not motion:
            assert motion.step is not None
            raise NestingError(_collides(first + motion.step, cage.side))
    seal = Seal(cage, stored, digest_of(way.flow.steps), links)
    report = replace(cage.told(report), stored=stored)
    return Level(fine, way.coarse, mesh, way.flow, way.reinflation, report, cage.side, seal)


def rerouted(level: Level, way: Way, stored: str | None = None) -> Level:
    """The level with other steps to the same cage; stored: the type that holds them. Raises NestingError."""
    cage = None if level.seal is None else level.seal.judged
    if cage is None or cage.cage is not level.cage or cage.fine is not level.fine:
        plan = Plan.of(level.fine, side=level.side)
        cage = judged(plan, level.cage, level.report.wanted_clearance, promised=False)
    return admitted(cage, way, level.report, level, stored=stored)


def standing(fine: Mesh, cage: Mesh, report: NestingReport, wanted: float, *, side: int = 1) -> Level:
    """The level of a cage that stands still, with a mesh in it or around it, and that no constraint binds.

    Raises NestingError.
    """
    verdict = judged(Plan.of(fine, side=side), cage, wanted, same_loops=False)
    return admitted(verdict, Way.at_rest(fine, cage), report)


def passed(level: Level, inner: Mesh, least: float = 0.0) -> Level:
    """The level around or inside a mesh, as it was judged, at a least clearance. Raises NestingError if it was not, or
    changed since."""
    seal, way = level.seal, Way.of(level)
    if seal is None or seal.judged.numbers is None or seal.judged.wanted < least:
        raise _refusal("The level was not judged.")
    cage, fine, told = seal.judged.cage, seal.judged.fine, seal.judged.told(level.report)
    same = level.cage is cage and level.fine is fine and np.array_equal(fine.vertices, inner.vertices)
    steps = way.leads(fine, cage) and (seal.flow, seal.links) == (digest_of(way.flow.steps), _links(way.reinflation))
    if not same or not steps:
        raise _refusal("The level is not the one that was judged.")
    if level.report != told or not level.report.stored == seal.stored == seal.judged.numbers[1]:
        raise _refusal("The report tells what was not measured.")
    return level


def _refusal(said: str) -> NestingError:
    return NestingError(said, code="certificate.failed", problems=(said,))


def _collides(step: int, side: int) -> Fault:
    return Fault(
        f"The motion from step {step} to the next could not be certified free of collisions; "
        f"use more cage vertices{'' if side < 0 else ', or a coarse mesh closer to the fine one'}.",
        "motion.collides",
        step=step,
    )


def digest_of(array: FloatArray) -> bytes:
    """That of the numbers and the shape of an array."""
    digest = blake2b(repr(array.shape).encode(), digest_size=8)  # changes are mistakes, not attacks
    digest.update(array.tobytes())
    return digest.digest()


def _links(way: Reinflation) -> tuple[bytes, ...]:
    """A digest of both meshes before and after each motion from one step to the next."""
    rest = digest_of(way.moving_steps[-1])
    fines = [*map(digest_of, way.moving_steps[:-1]), *[rest] * (len(way.cage_steps) - len(way.moving_steps) + 1)]
    steps = [fine + digest_of(cage) for fine, cage in zip(fines, way.cage_steps, strict=True)]
    return tuple(one + other for one, other in pairwise(steps))
