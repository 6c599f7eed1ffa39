"""The paper's way from a coarse mesh to a tight cage: flow, reinflation, tightening."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

from ..contact.pairs import Bodies
from ..contact.reinflation import Reinflation, reinflate
from ..decimation import Start
from ..decimation.line_cycles import SOURCE
from ..energies import signed_area
from ..errors import FlowError
from ..flow import FlowResult
from ..geometry.arrays import TINY, FloatArray
from ..geometry.mesh import Mesh, Nesting
from ..tightening.coarse_to_fine import coarse_to_fine
from .progress import OutOfTimeError
from .work import Draft, Work, contacts_for

PAPER_PREFERENCE = 0.01
"""A cage from flow and reinflation is preferred to one that needed neither, unless the latter is tighter by more than
this fraction of its excess."""

MISSED = 1e6
"""Added to the rank of cages that miss a constraint, more than any excess: others, where they are tried, are better."""

OWN = "coarse mesh"
"""What a start from the user's own coarse mesh is called."""


def tight_draft(work: Work, start: Start) -> Draft:
    """The tight cage from a start. Raises FlowError, ReinflationError."""
    draft = at_rest(work, start)
    moves = not work.rests and work.watch.over is None
    if moves and (work.settings.steps or not _needs_no_flow(start, work.plan.fine)):
        draft = reinflated(work, flowed(work, draft))
    return tightened(work, draft, work.clearances[0])


def at_rest(work: Work, start: Start) -> Draft:
    """A coarse mesh, and the fine mesh where it is."""
    rest, coarse = work.unit_fine.vertices[None], work.units.from_input(start.coarse)
    energy, _ = work.plan.energy(work.settings.energy.at(coarse), coarse, work.units)
    still = Reinflation(rest, coarse.vertices[None], 0)
    return Draft(
        start, coarse, FlowResult(rest, 0, "inside"), still, energy, excess=_excess(work, coarse, coarse.vertices)
    )


def flowed(work: Work, draft: Draft) -> Draft:
    """The fine mesh shrinks into the coarse one. Raises FlowError."""
    plan, units, watch = work.plan, work.units, work.watch
    watch.begin("flow")
    if plan.outline.mesh is not plan.fine and Nesting(draft.start.coarse, plan.fine).encloses():
        return draft  # images may have loops of their own, which the flow does not know
    try:
        method = units.method(work.settings.flow)
        return replace(draft, flow=method.run(work.unit_fine, draft.unit_coarse, tick=watch.tick("flow")))
    except FlowError as error:
        partial = error.partial
        if isinstance(partial, FlowResult) and partial.obstacle is not None:
            x, y = units.centre
            raise FlowError(partial.obstacle.fault(units.scale, (float(x), float(y)))) from error
        raise


def reinflated(work: Work, draft: Draft) -> Draft:
    """The fine mesh comes back along the flow, and pushes the cage out. Raises ReinflationError."""
    units, watch = work.units, work.watch
    watch.begin("reinflation")
    contacts = contacts_for(work.settings, own=draft.start.source == OWN)
    reinflation = reinflate(
        work.unit_fine,
        draft.unit_coarse,
        draft.flow.steps,
        contacts=[units.method(contact) for contact in contacts],
        clearance=units.clearance(work.clearances[0] + work.room),
        bounds=work.plan.bounds(draft.unit_coarse, units),
        tick=watch.tick("reinflation"),
    )
    return replace(draft, reinflation=reinflation)


def tightened(work: Work, draft: Draft, clearance: float) -> Draft:
    """The cage at its optimum for a clearance in input units, or as far as time allows."""
    plan, units, watch, coarse = work.plan, work.units, work.watch, draft.unit_coarse
    bounds, wanted = plan.bounds(coarse, units), units.clearance(clearance + work.room)
    meshes = iter([(work.unit_fine, plan.clearances(units))])
    if plan.is_free and plan.side > 0:
        meshes = coarse_to_fine(work.unit_fine, plan.fine, coarse, wanted, lambda: cages[-1] if cages else draft.cage)
    steps, programs, cages = 0, 0, list[FloatArray]()

    def on_step(vertices: FloatArray) -> None:
        cages.append(vertices)
        watch.show(1.0 - 1.0 / (1.0 + 0.1 * len(cages)), f"tightening, step {len(cages)}")

    with suppress(OutOfTimeError):
        watch.begin("tightening")
        for fine, clearances in () if watch.over else meshes:
            outcome = work.settings.tightening.run(
                Bodies.of(coarse, fine, side=plan.side, bounds=bounds, clearances=clearances),
                cages[-1] if cages else draft.cage,
                fine.vertices,
                clearance=wanted,
                energy=draft.energy,
                on_step=on_step,
            )
            steps, programs = steps + outcome.iterations, programs + outcome.quadratic_programs
    draft = replace(draft, tightening=[*draft.tightening, *cages], iterations=(steps, programs))
    excess = _excess(work, coarse, draft.cage)
    rank = excess if plan.side < 0 or len(draft.flow.steps) > 1 else (1.0 + PAPER_PREFERENCE) * excess
    if plan.importance is not None:
        rank = draft.energy.after(draft.cage).value(draft.cage, coarse.successor) / max(work.unit_fine.area, TINY)
    missed = any(bound.short(draft.cage).any() for bound in bounds)
    return replace(draft, excess=excess, rank=rank + MISSED * missed)


def _needs_no_flow(start: Start, fine: Mesh) -> bool:
    """Whether the fine mesh is inside a start, or all but what thinning left out, which tightening brings inside."""
    return start.source == SOURCE or Nesting(start.coarse, fine).encloses()


def _excess(work: Work, coarse: Mesh, cage: FloatArray) -> float:
    """The excess of a cage (m, 2), or the area that it loses inside."""
    area = max(work.unit_fine.area, TINY)  # of slivers it may round to 0
    return work.plan.side * (signed_area(cage, coarse.successor) / area - 1.0)
