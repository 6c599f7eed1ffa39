"""What a level is assembled from: a cage in progress, steps in input units, the level with its report, and errors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ..contact.reinflation import Reinflation
from ..decimation import Start
from ..energies import CageEnergy
from ..errors import Fault, note
from ..flow import FlowResult
from ..geometry.mesh import Mesh
from ..verification.certificate import loops_in_words
from .gate import Way, admitted, judged
from .plan import Plan
from .report import JudgedCage, Level, LevelProgress, NestingReport
from .units import SolverUnits


@dataclass(frozen=True, eq=False)
class CageInProgress:
    """A cage in progress, in the units of the solvers."""

    start: Start
    """With its coarse mesh in input units."""
    unit_coarse: Mesh
    flow: FlowResult
    untightened: Reinflation
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
        self.is_final = plan.numbers is None and plan.outline.inner is None
        """Whether its levels are handed out as they are, so that they keep all constraints."""

    def around(self, inner: Mesh, level: Level) -> Level:
        """The level of a mesh that rests in the one that was solved for. Raises NestingError."""
        way, report, cage = Way.of(level), level.report, level.cage
        mended = self.plan.mended(cage)
        if mended is not None:
            cage, said = mended
            way, report = Way.at_rest(inner, cage), report.with_count(said)
        rest = inner.vertices[None]
        way = Way(way.coarse, FlowResult(rest, 0, "inside"), replace(way.reinflation, moving_steps=rest))
        certified = judged(replace(self.plan, fine=inner), cage, report.wanted_clearance)
        report = replace(report, notes=(*loops_note(certified), *report.notes))
        tick = self.progress.tick("verification")
        return admitted(certified, way, report, stored=report.stored, tick=tick)

    def level(
        self, cage: JudgedCage, way: Way, start: str, iterations: Mapping[str, int], notes: tuple[Fault, ...]
    ) -> Level:
        """The level of a judged cage with its report, after its motion is judged. Raises NestingError."""
        draft = NestingReport(False, False, 0.0, cage.wanted, 0.0, start, iterations, {}, notes)
        level = admitted(cage, way, draft, tick=self.progress.tick("verification"))
        self.progress.stop_clock()
        return replace(level, report=replace(level.report, seconds=dict(self.progress.seconds)))

    def untightened(self, start: Start, clearances: tuple[float, ...], notes: tuple[Fault, ...]) -> Level | None:
        """The level of a coarse mesh that already is a cage; None if it is none.

        Holes like round-off may be resolved in input units only, near the origin. See docs/ablation.md: untightened
        cage as last resort.
        """
        self.progress.begin("verification")
        cage = judged(self.plan, start.coarse, 0.0, promised=self.is_final, same_loops=True)
        clearance = min(clearances[0], cage.certificate.clearance) if len(clearances) > 1 else clearances[0]
        if not cage or cage.certificate.clearance < clearance:
            return None
        cage = judged(self.plan, start.coarse, clearance, promised=self.is_final)
        way, every = Way.at_rest(self.fine, start.coarse), (note("note.untightened"), *notes)
        return self.level(cage, way, start.source, {"flow": 0, "reinflation": 0}, every)

    def in_input_units(self, cage: CageInProgress) -> Way:
        """The steps in input units; input coordinates are restored exactly."""
        units, reinflation = self.units, cage.reinflation
        flow_steps = units.to_input(cage.flow.steps)
        flow_steps[0] = self.fine.vertices
        moving_steps = units.to_input(reinflation.moving_steps)
        moving_steps[0] = flow_steps[-1]
        moving_steps[-1] = self.fine.vertices
        cage_steps = units.to_input(reinflation.cage_steps)
        cage_steps = self.plan.restored(cage.start.coarse, cage_steps)
        cage_steps[0] = cage.start.coarse.vertices
        flow = FlowResult(flow_steps, cage.flow.iterations, cage.flow.stage)
        return Way(cage.start.coarse, flow, Reinflation(moving_steps, cage_steps, reinflation.iterations))


def loops_note(judged_cage: JudgedCage) -> tuple[Fault, ...]:
    """What became of loops, where a cage has others than the mesh in it."""
    cage, fine = judged_cage.cage, judged_cage.fine
    if cage.has_loops_like(fine):
        return ()
    lost = judged_cage.certificate.lost.note
    return (note("note.loops", given=loops_in_words(cage), wanted=loops_in_words(fine), **lost),)


def deviations(plan: Plan, judged_cage: JudgedCage, clearance: float, wanted: float) -> tuple[Fault, ...]:
    """What differs from the request in a certified cage."""
    notes = (*loops_note(judged_cage), *plan.notes(judged_cage.cage))
    if clearance < wanted:
        on = "inside" if plan.side < 0 else "gaps"
        notes = (note("note.clearance", on=on, wanted=wanted, given=clearance), *notes)
    return notes
