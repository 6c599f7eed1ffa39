"""One level, as in the paper: a coarse mesh, flow, reinflation, tightening, and a certificate.

Coarse meshes are tried in turn: where loops need not be kept, along the sequence of outlines, from the drawing to a box
around it, the tightest first. The fine mesh flows into the one on the curve and comes back, pushing the cage out; where
that is blocked, or looser than the enclosing mesh, the enclosing mesh is tightened: the fine mesh is inside already.

A cage inside has the unbounded region around it as its solid. Walked backwards, its loops are the oriented boundary of
that region, so start and solvers push it away from the fine mesh as they do with a cage outside.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import islice
from math import inf
from typing import Any, NamedTuple, TypeAlias

from ..decimation import Start
from ..decimation.cycle_search import OFFSET
from ..energies import Area
from ..errors import FlowError, NestedCagesError, NestingError, note
from ..flow import FlowResult
from ..geometry.mesh import Mesh
from .certify import Path, UnsettledError, Verdict, certify, judge, lost_loops
from .draft import OWN, PAPER_PREFERENCE, Draft, at_rest, flowed, in_input_units, is_at_rest, reinflated, tightened
from .plan import Plan
from .progress import OutOfTimeError
from .report import Level, NestingReport
from .starts import Notes, starts
from .work import FAILURES, Work

logger = logging.getLogger(__name__)

ON_CURVE = "on the curve"
"""What a start with its vertices on the fine mesh is called."""

NO_EXCESS = 3e-4
"""Excess up to which the clearance decides: a cage from flow and reinflation is not compared."""

LOOSE_ON_GRID, FURTHER_ON_GRID = 0.1, 2
"""Part of the excess that a grid may add before other starts are tried, and how many further ones along the sequence
are."""


class Candidate(NamedTuple):
    """A certified level."""

    level: Level
    excess: float
    """That of its cage before it moved onto certain numbers, or lost area if inside."""


Maker: TypeAlias = Callable[[Work, Any], Candidate]
"""Makes the level of a target. Raises NestedCagesError."""


def build_level(work: Work, target: int | Mesh, most: int | None = None) -> Candidate:
    """The level of the first start that leads to one, or a better one from a start about as good.

    Parameters
    ----------
    work : Work
        What it is made from.
    target : int or Mesh
        The largest number of vertices, or the user's own coarse mesh.
    most : int, optional
        Number of starts that are tried. Default: all.

    Raises
    ------
    NestedCagesError
        Why there is none from the first start, or that time is over.
    """
    refusals: list[NestedCagesError] = []
    failed: list[Mesh] = []
    offered = starts(work, target, refusals)
    for start, notes in islice(offered, most):
        try:
            best = with_room(work, start, notes)
        except FAILURES as refusal:
            logger.debug("no level from %s: %s", start.source, refusal)
            refusals.append(refusal)
            failed.append(start.coarse)
            if work.watch.over is not None:
                break
        else:
            with suppress(OutOfTimeError):
                for rival in rivals(work, start, (other for other, _ in offered), best):
                    if all(rival.coarse is not mesh for mesh in failed):
                        with suppress(*FAILURES):
                            best = min(best, with_room(work, rival, notes), key=lambda each: work.merit(each.level))
            return best
    raise work.watch.over or refusals[0]


def rivals(work: Work, start: Start, others: Iterator[Start], best: Candidate) -> Iterator[Start]:
    """Starts that may lead to a tighter cage: about as good, and on a grid further ones along the sequence."""
    if not work.compares or work.below < inf or start.source == OWN:
        return
    yield from start.rivals
    for other in islice(others, FURTHER_ON_GRID if work.plan.grid is not None else 0):
        excess = other.coarse.area / work.plan.outline.mesh.area - 1.0
        if (1.0 + LOOSE_ON_GRID) * excess >= best.level.excess:
            return
        if all(other.coarse is not rival.coarse for rival in start.rivals):
            yield other


def with_room(work: Work, start: Start, notes: Notes) -> Candidate:
    """The level from a start, with more distance where its cage has no place on the numbers.

    Raises one of `FAILURES`.
    """
    rooms = (0.0,) if work.plan.numbers is None or work.below < inf else (0.0, *work.plan.numbers.rooms)
    unsettled: list[NestingError] = []
    for room in rooms:
        try:
            return level_from_start(replace(work, room=room), start, notes)
        except NestingError as refusal:
            unsettled.append(refusal)
            if not isinstance(refusal, UnsettledError):
                break
    raise unsettled[0]


def level_from_start(work: Work, start: Start, notes: Notes) -> Candidate:
    """The paper's way from the mesh on the curve; where that is blocked or looser, from the enclosing mesh.

    Raises one of `FAILURES`.
    """
    start = work.plan.started(start)
    drafts, failures, refusals = list[Draft](), list[NestedCagesError](), list[NestedCagesError]()
    ways = [start] if start.on_curve is None else [Start(start.on_curve, ON_CURVE)]
    if start.on_curve is not None and work.settings.fallback is not None:
        ways.append(start)
    for way in ways:
        if drafts and drafts[0].rank <= good_enough(work, start):
            break
        try:
            drafts.append(tight_draft(work, way))
        except FAILURES as failure:
            logger.debug("start from %s failed: %s", way.source, failure)
            failures.append(failure)
    if drafts and failures and drafts[0].start is start and not isinstance(failures[0], OutOfTimeError):
        on = "flow" if isinstance(failures[0], FlowError) else "reinflation"
        notes = (*notes, note("note.start", on=on, source=start.source, first=ON_CURVE))
    for draft in sorted(drafts, key=lambda draft: draft.rank):
        try:
            return Candidate(certified(work, draft, notes), draft.excess)
        except NestingError as refusal:
            refusals.append(refusal)
    raise (refusals or failures)[0]


def good_enough(work: Work, start: Start) -> float:
    """Rank of a draft from the curve up to which the enclosing mesh cannot be tighter by much."""
    if not isinstance(work.settings.energy, Area):
        return inf
    fine = work.plan.outline.mesh
    # lines keep a little away from the fine mesh, beyond the clearance
    away = max(0.0, OFFSET * fine.diagonal - work.clearances[0]) * float(start.coarse.edge_lengths.sum())
    return max((1.0 + PAPER_PREFERENCE) * ((start.coarse.area - away) / fine.area - 1.0), NO_EXCESS)


def tight_draft(work: Work, start: Start) -> Draft:
    """Flow, reinflation and tightening from a coarse mesh. Raises FlowError, ReinflationError."""
    draft = at_rest(work, start)
    if not is_at_rest(work, start):
        draft = reinflated(work, flowed(work, draft))
    return tightened(work, draft, work.clearances[0])


def certified(work: Work, draft: Draft, notes: Notes) -> Level:
    """The level of a draft, at the largest of the clearances that allows one. Raises NestingError."""
    plan, watch, wanted = work.plan, work.watch, work.clearances[0]
    for clearance in work.clearances:
        if clearance < wanted:
            draft = tightened(work, draft, clearance)
        watch.begin("verification")
        path = in_input_units(work, draft)
        verdict = judge(plan, path.cage, clearance, whole=plan.numbers is None and plan.outline.inner is None)
        if not verdict.is_only_too_close:
            break
    if not verdict:
        from .explanations import rejection

        raise NestingError(rejection(verdict, wanted))
    if clearance < wanted:
        notes += (note("note.clearance", on="inside" if plan.side < 0 else "gaps", wanted=wanted, given=clearance),)
    notes += lost_loops(verdict.cage, plan.fine, verdict.certificate)
    energy = work.settings.energy
    if not draft.tightening and len(path.reinflation.cage_steps) == 1 and not isinstance(energy, Area):
        notes += (note("note.energy", energy=type(energy).__name__),)
    iterations = {"flow": draft.flow.iterations, "reinflation": draft.reinflation.iterations}
    iterations |= {"tightening": draft.iterations[0], "quadratic programs": draft.iterations[1]}
    source = "flow" if len(draft.flow.steps) > 1 else draft.start.source
    if plan.numbers is None:
        notes += tuple(plan.missed(verdict.cage, must=False))
    report = NestingReport(False, False, 0.0, clearance, 0.0, source, iterations, {}, notes)
    if plan.numbers is not None:
        from .snap import snapped

        if draft.excess >= work.below:
            raise UnsettledError("The cage is not tighter than another one.")
        level = snapped(work, path, report)
        if plan.outline.inner is None:
            return level
        path, report = Path.of(level), level.report
    if plan.outline.inner is not None:
        verdict, path, report = around_inner(plan.outline.inner, plan, path, report)
    return certify(verdict, path, report, stored=report.stored, tick=watch.tick("verification"))


def around_inner(inner: Mesh, plan: Plan, path: Path, report: NestingReport) -> tuple[Verdict, Path, NestingReport]:
    """The cage of a mesh that rests in the one that was solved for, and is judged with it."""
    mended = plan.mended(path.cage)
    if mended is not None:
        path, report = Path.at_rest(inner, mended[0]), report.with_count(mended[1])
    rest = inner.vertices[None]
    path = Path(path.coarse, FlowResult(rest, 0, "inside"), replace(path.reinflation, moving_steps=rest))
    verdict = judge(replace(plan, fine=inner), path.cage, report.wanted_clearance)
    lost = lost_loops(path.cage, inner, verdict.certificate)
    return verdict, path, replace(report, notes=(*lost, *report.notes))
