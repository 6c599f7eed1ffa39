"""From the draft of a cage to its certified level."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..contact.reinflation import Reinflation
from ..energies import Area
from ..errors import Fault, NestingError, note
from ..flow import FlowResult
from ..geometry.mesh import Mesh
from ..verification.certificate import Certificate, loops_in_words
from .certify import Path, Verdict, certify, judge
from .draft import tightened
from .plan import Plan
from .report import Level, NestingReport
from .work import Draft, Work


def finished(work: Work, draft: Draft, notes: tuple[Fault, ...]) -> Level:
    """The level of a draft, at the largest of the clearances that allows one. Raises NestingError."""
    plan, watch, wanted = work.plan, work.watch, work.clearances[0]
    for clearance in work.clearances:
        if clearance < wanted and not draft.still:
            draft = tightened(work, draft, clearance)
        watch.begin("verification")
        path = in_input_units(work, draft)
        verdict = judge(plan, path.cage, clearance, whole=plan.numbers is None and plan.outline.inner is None)
        if not verdict.is_only_too_close:
            break
    if not verdict:
        raise NestingError(verdict.rejection(wanted))
    notes = (*notes, *_deviations(work, verdict, draft, wanted))
    iterations = {"flow": draft.flow.iterations, "reinflation": draft.reinflation.iterations}
    iterations |= {"tightening": draft.iterations[0], "quadratic programs": draft.iterations[1]}
    source = "flow" if len(draft.flow.steps) > 1 else draft.start.source
    report = NestingReport(False, False, 0.0, clearance, 0.0, source, iterations, {}, notes)
    if plan.numbers is not None:
        from .snap import UnsettledError, snapped

        if draft.excess >= work.below:
            raise UnsettledError.of(path, report, "The cage is not tighter than another one.")
        level = snapped(plan, work.settings.energy, path, report, watch)
        path, report = Path.of(level), level.report
    if plan.outline.inner is not None:
        level = _around(plan.outline.inner, plan, path, report)
    elif plan.numbers is None:
        level = certify(verdict, path, report, tick=watch.tick("verification"))
    watch.stop_clock()
    return replace(level, report=replace(level.report, seconds=dict(watch.seconds)))


def in_input_units(work: Work, draft: Draft) -> Path:
    """The steps of a draft in input units; input coordinates are restored exactly."""
    units, fine, coarse = work.units, work.plan.fine, draft.start.coarse
    if not work.settings.steps and len(draft.flow.steps) == 1:
        return Path.at_rest(fine, coarse.moved(work.plan.snapped(coarse, units.to_input(draft.cage[None]))[0]))
    reinflation = draft.reinflation.with_tightening(draft.tightening)
    flow_steps = units.to_input(draft.flow.steps)
    flow_steps[0] = fine.vertices
    moving_steps = units.to_input(reinflation.moving_steps)
    moving_steps[0] = flow_steps[-1]
    moving_steps[-1] = fine.vertices
    cage_steps = work.plan.snapped(coarse, units.to_input(reinflation.cage_steps))
    cage_steps[0] = coarse.vertices
    flow = FlowResult(flow_steps, draft.flow.iterations, draft.flow.stage)
    return Path(coarse, flow, Reinflation(moving_steps, cage_steps, reinflation.iterations))


def _around(inner: Mesh, plan: Plan, path: Path, report: NestingReport) -> Level:
    """The level of a mesh that rests in the one that was solved for. Raises NestingError."""
    cage, stored = path.cage, report.stored
    mended = plan.mended(cage)
    if mended is not None:
        cage, said = mended
        path, report = Path.at_rest(inner, cage), report.with_count(said)
    rest = inner.vertices[None]
    path = Path(path.coarse, FlowResult(rest, 0, "inside"), replace(path.reinflation, moving_steps=rest))
    verdict = judge(replace(plan, fine=inner), cage, report.wanted_clearance)
    report = replace(report, notes=(*lost_loops(cage, inner, verdict.certificate), *report.notes))
    return certify(verdict, path, report, stored=stored)


def _deviations(work: Work, verdict: Verdict, draft: Draft, wanted: float) -> Iterator[Fault]:
    """What differs from the request in a certified cage."""
    if verdict.wanted < wanted:
        on = "inside" if work.plan.side < 0 else "gaps"
        yield note("note.clearance", on=on, wanted=wanted, given=verdict.wanted)
    yield from lost_loops(verdict.cage, verdict.plan.fine, verdict.certificate)
    if work.plan.numbers is None:
        yield from work.plan.notes(verdict.cage)
    energy = work.settings.energy
    if draft.still:
        yield note("note.untightened")
    elif not len(draft.tightening) and len(draft.reinflation.cage_steps) == 1 and not isinstance(energy, Area):
        yield note("note.energy", energy=type(energy).__name__)


def lost_loops(cage: Mesh, fine: Mesh, certificate: Certificate) -> tuple[Fault, ...]:
    """What became of loops, where a cage has others than the mesh in it."""
    if cage.has_loops_like(fine):
        return ()
    return (note("note.loops", given=loops_in_words(cage), wanted=loops_in_words(fine), **certificate.lost.note),)
