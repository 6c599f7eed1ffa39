"""The phases of the paper between a coarse mesh and its certificate, in the units of the solvers."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from math import inf

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
from .certify import Path
from .progress import OutOfTimeError
from .work import Work, contacts_for

PAPER_PREFERENCE = 0.01
"""A cage from flow and reinflation is preferred to one that needed neither, unless the latter is tighter by more than
this fraction of its excess."""

MISSED = 1e6
"""Added to the rank of cages that miss a constraint, more than any excess: others, where they are tried, are better."""

OWN = "coarse mesh"
"""What a start from the user's own coarse mesh is called."""


@dataclass(frozen=True, eq=False)
class Draft:
    """A cage before its certificate."""

    start: Start
    """With its coarse mesh in input units."""
    unit_coarse: Mesh
    flow: FlowResult
    reinflation: Reinflation
    tightening: tuple[FloatArray, ...] = ()
    """The cages (m, 2) of the tightening."""
    iterations: tuple[int, int] = (0, 0)
    """Steps and quadratic programs of the tightening."""
    excess: float = inf
    """That of the cage, or lost area if inside."""
    rank: float = inf
    """Smaller is better: the excess, or the energy where that is no area."""

    @property
    def cage(self) -> FloatArray:
        """(m, 2)."""
        return self.tightening[-1] if self.tightening else self.reinflation.cage_steps[-1]


def at_rest(work: Work, start: Start) -> Draft:
    """A coarse mesh, and the fine mesh where it is."""
    rest, coarse = work.unit_fine.vertices[None], work.units.from_input(start.coarse)
    return Draft(start, coarse, FlowResult(rest, 0, "inside"), Reinflation(rest, coarse.vertices[None], 0))


def is_at_rest(work: Work, start: Start) -> bool:
    """Whether the fine mesh stays where it is: it is inside, or all of it that thinning left, and no steps lead into
    the user's own coarse mesh; or there is no time."""
    steps = work.settings.steps
    if work.rests or work.watch.over is not None or (start.source == SOURCE and not steps):
        return True
    return not (steps and start.source == OWN) and Nesting(start.coarse, work.plan.fine).encloses()


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
    energy, bounds = plan.energy(work.settings.energy.at(coarse), coarse, units), plan.bounds(coarse, units)
    wanted, cages = units.clearance(clearance + work.room), [draft.cage]
    meshes = iter([(work.unit_fine, plan.clearances(units))])
    if plan.is_free and plan.side > 0:
        meshes = coarse_to_fine(work.unit_fine, plan.fine, coarse, wanted, lambda: cages[-1])
    steps, programs = draft.iterations

    def on_step(cage: FloatArray) -> None:
        cages.append(cage)
        watch.show(1.0 - 1.0 / (1.0 + 0.1 * (len(cages) - 1)), f"tightening, step {len(cages) - 1}")

    with suppress(OutOfTimeError):
        watch.begin("tightening")
        for fine, clearances in () if watch.over else meshes:
            outcome = work.settings.tightening.run(
                Bodies.of(coarse, fine, side=plan.side, bounds=bounds, clearances=clearances),
                cages[-1],
                fine.vertices,
                clearance=wanted,
                energy=energy,
                on_step=on_step,
            )
            steps, programs = steps + outcome.iterations, programs + outcome.quadratic_programs
    while work.within is not None and len(cages) > 1 and not work.within(coarse.moved(units.to_input(cages[-1]))):
        del cages[(len(cages) + 1) // 2 :]
    cage, area = cages[-1], max(work.unit_fine.area, TINY)  # of slivers it may round to 0
    excess = plan.side * (signed_area(cage, coarse.successor) / area - 1.0)
    rank = excess if plan.side < 0 or len(draft.flow.steps) > 1 else (1.0 + PAPER_PREFERENCE) * excess
    if plan.importance is not None:
        rank = energy.after(cage).value(cage, coarse.successor) / area
    rank += MISSED * any(bound.short(cage).any() for bound in bounds)
    return replace(
        draft, tightening=(*draft.tightening, *cages[1:]), iterations=(steps, programs), excess=excess, rank=rank
    )


def in_input_units(work: Work, draft: Draft) -> Path:
    """The steps of a draft in input units; input coordinates are restored exactly."""
    units, fine, coarse = work.units, work.plan.fine, draft.start.coarse
    if not work.settings.steps and len(draft.flow.steps) == 1:
        return Path.at_rest(fine, coarse.moved(work.plan.snapped(coarse, units.to_input(draft.cage[None]))[0]))
    reinflation = draft.reinflation.with_tightening(draft.tightening)
    flow_steps, moving_steps = units.to_input(draft.flow.steps), units.to_input(reinflation.moving_steps)
    flow_steps[0] = moving_steps[-1] = fine.vertices
    moving_steps[0] = flow_steps[-1]
    cage_steps = work.plan.snapped(coarse, units.to_input(reinflation.cage_steps))
    cage_steps[0] = coarse.vertices
    flow = FlowResult(flow_steps, draft.flow.iterations, draft.flow.stage)
    return Path(coarse, flow, Reinflation(moving_steps, cage_steps, reinflation.iterations))
