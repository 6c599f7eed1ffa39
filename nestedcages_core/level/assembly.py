"""What a level is assembled from: a cage in progress, steps in input units, the level with its report, and errors."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ..contact.reinflation import Reinflation
from ..decimation import Decimation, Start
from ..energies import CageEnergy
from ..errors import Fault, NestingError, note
from ..flow import FlowResult
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..tasks import Stage
from ..verification import Certificate, verify
from ..verification.certificate import loops_in_words
from .plan import Plan
from .report import Level, LevelProgress, NestingReport, Progress
from .units import SolverUnits

if TYPE_CHECKING:
    from .symmetrised_start import Alike


@dataclass(frozen=True, eq=False)
class CageInProgress:
    """A cage in progress, in the units of the solvers."""

    start: Start
    """With its coarse mesh in input units."""
    unit_coarse: Mesh
    flow: FlowResult
    untightened: Reinflation
    alike: Alike | None = None
    """Its exact symmetry."""
    tightened: Reinflation | None = None
    """Followed by the tightening."""
    energy: CageEnergy | None = None
    is_measure: bool = False
    """Whether the energy, not the excess, ranks cages."""
    rank: float = np.inf
    """Rank of the tightened cage, see `_rank`; infinite before."""
    counts: Mapping[str, int] = field(default_factory=dict)

    @property
    def reinflation(self) -> Reinflation:
        """All steps so far."""
        return self.tightened or self.untightened


class Assembly:
    """Assembles the levels of one plan."""

    def __init__(self, plan: Plan, progress: LevelProgress, units: SolverUnits) -> None:
        self.plan, self.progress, self.units, self.fine = plan, progress, units, plan.fine

    def around(self, inner: Mesh, level: Level) -> Level:
        """The level of a mesh that rests in the one that was solved for. Raises NestingError."""
        mended = self.plan.mended(level.cage)
        if mended is not None:
            level = level.standing(*mended)
            if self.plan.mended(level.cage) is not None:
                raise NestingError("The cage is not convex.", code="convex.missed")
        cage, rest = level.cage, inner.vertices[None]
        certificate = verify(cage, inner, level.report.wanted_clearance, same_loops=False)
        if not certificate:
            raise NestingError(certificate.problems[0])
        fault = next(self.plan.missed(cage), None)
        if fault is not None:
            raise NestingError(fault)
        report = replace(level.report, clearance=certificate.clearance, excess=cage.area / inner.area - 1.0)
        if not cage.has_loops_like(inner):
            loops = note("note.loops", given=loops_in_words(cage), wanted=loops_in_words(inner))
            report = replace(report, notes=(loops, *report.notes))
        path = replace(level.reinflation, moving_steps=rest)
        return replace(level, fine=inner, flow=FlowResult(rest, 0, "inside"), reinflation=path, report=report)

    def resting(self, steps: FloatArray) -> tuple[FlowResult, Reinflation]:
        """The motion of a cage with steps (K + 1, m, 2) while the fine mesh rests."""
        rest = self.fine.vertices[None]
        return FlowResult(rest, 0, "inside"), Reinflation(rest, steps, 0)

    def level(
        self,
        coarse: Mesh,
        cage: Mesh,
        way: tuple[FlowResult, Reinflation],
        certificate: Certificate,
        clearance: float,
        start: str,
        iterations: Mapping[str, int],
        notes: tuple[Fault, ...],
    ) -> Level:
        """The level with its report: what is certified, and how long it took."""
        self.progress.stop_clock()
        report = NestingReport(
            strict=certificate.strict,
            simple=certificate.simple,
            clearance=certificate.clearance,
            wanted_clearance=clearance,
            excess=cage.area / self.fine.area - 1.0,
            start=start,
            iterations=iterations,
            seconds=dict(self.progress.seconds),
            notes=notes,
        )
        return Level(self.fine, coarse, cage, *way, report, side=self.plan.side)

    def untightened(
        self, starts: Sequence[Start], clearances: tuple[float, ...], notes: tuple[Fault, ...]
    ) -> Stage[Progress, Level | None]:
        """The level of the first coarse mesh that already is a cage; None if none is.

        Holes like round-off may be resolved in input units only, near the origin. See docs/ablation.md: untightened
        cage as last resort.
        """
        yield from self.progress.begin("verification")
        for start in starts:
            certificate = self.plan.verify(start.coarse, 0.0)
            clearance = min(clearances[0], certificate.clearance) if len(clearances) > 1 else clearances[0]
            if certificate.holds and certificate.clearance >= clearance and not any(self.plan.missed(start.coarse)):
                resting, counts = self.resting(start.coarse.vertices[None]), {"flow": 0, "reinflation": 0}
                mesh, every = start.coarse, (note("note.untightened"), *notes)
                return self.level(mesh, mesh, resting, certificate, clearance, start.source, counts, every)
        return None

    def in_input_units(self, cage: CageInProgress) -> tuple[FlowResult, Reinflation]:
        """Flow and reinflation in input units; input coordinates are restored exactly."""
        units, reinflation = self.units, cage.reinflation
        flow_steps = units.to_input(cage.flow.steps)
        flow_steps[0] = self.fine.vertices
        moving_steps = units.to_input(reinflation.moving_steps)
        moving_steps[0] = flow_steps[-1]
        moving_steps[-1] = self.fine.vertices
        cage_steps = units.to_input(reinflation.cage_steps)
        if cage.alike is not None:
            cage_steps = cage.alike.symmetrised(cage_steps)
        cage_steps[0] = cage.start.coarse.vertices
        flow = FlowResult(flow_steps, cage.flow.iterations, cage.flow.stage)
        return flow, Reinflation(moving_steps, cage_steps, reinflation.iterations)


def is_only_too_close(certificate: Certificate, clearance: float) -> bool:
    """Whether a cage lacks nothing but the clearance."""
    sound = certificate.strict and certificate.simple and len(certificate.problems) == 1
    return sound and certificate.clearance < clearance


def deviations(plan: Plan, cage: Mesh, clearance: float, wanted: float) -> tuple[Fault, ...]:
    """What differs from the request in a certified cage."""
    notes = plan.notes(cage, clearance)
    if not cage.has_loops_like(plan.fine):
        notes = (note("note.loops", given=loops_in_words(cage), wanted=loops_in_words(plan.fine)), *notes)
    if clearance < wanted:
        on = "inside" if plan.side < 0 else "gaps"
        notes = (note("note.clearance", on=on, wanted=wanted, given=clearance), *notes)
    return notes


def in_words(decimation: Decimation) -> str:
    """The name of a decimation in words: "outer hull" for ``OuterHull()``."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(decimation).__name__).lower()
