"""The paper's way from a coarse mesh to a tight cage: flow, reinflation, tightening."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

from ..contact.pairs import Bodies
from ..contact.reinflation import Reinflation, reinflate
from ..decimation import Start
from ..energies import signed_area
from ..errors import FlowError, InvalidMeshError
from ..flow import FlowResult
from ..geometry.arrays import TINY, FloatArray
from ..geometry.mesh import Mesh, Nesting
from ..geometry.thinning import Thinning
from .progress import OutOfTimeError
from .work import Draft, Work, contacts_for

PAPER_PREFERENCE = 0.01
"""A cage from flow and reinflation is preferred to one that needed neither, unless the latter is tighter by more than
this fraction of its excess."""

MISSED = 1e6
"""Added to the rank of cages that miss a constraint, more than any excess: others are tried, and are better."""

OWN = "coarse mesh"
"""What a start from the user's own coarse mesh is called."""

MIN_POINTS, POINTS_PER_VERTEX, MANY = 1000, 30, 3
"""Vertices of the mesh that tightening begins with: at least, and per vertex of the cage; how many times as many a mesh
has for which there is one."""


def tight_draft(work: Work, start: Start) -> Draft:
    """The tight cage from a start. Raises FlowError, ReinflationError."""
    draft = at_rest(work, start)
    if not work.rests and work.watch.over is None:
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
    bounds, wide = plan.bounds(coarse, units), plan.clearances(units)
    steps, programs, cages = 0, 0, list[FloatArray]()

    def on_step(vertices: FloatArray) -> None:
        cages.append(vertices)
        watch.show(1.0 - 1.0 / (1.0 + 0.1 * len(cages)), f"tightening, step {len(cages)}")

    with suppress(OutOfTimeError):
        watch.begin("tightening")
        for fine, away in () if watch.over else _coarse_to_fine(work, coarse):
            outcome = work.settings.tightening.run(
                Bodies.of(coarse, fine, side=plan.side, bounds=bounds, clearances=wide),
                cages[-1] if cages else draft.cage,
                fine.vertices,
                clearance=units.clearance(clearance + work.room) + away,
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


def _excess(work: Work, coarse: Mesh, cage: FloatArray) -> float:
    """The excess of a cage (m, 2), or the area that it loses inside."""
    area = max(work.unit_fine.area, TINY)  # of slivers it may round to 0
    return work.plan.side * (signed_area(cage, coarse.successor) / area - 1.0)


def _coarse_to_fine(work: Work, cage: Mesh) -> Iterator[tuple[Mesh, float]]:
    """Meshes to tighten around in turn, and how far from each: of a large one first one with fewer vertices."""
    fine, points = work.unit_fine, MIN_POINTS + POINTS_PER_VERTEX * len(cage.vertices)
    if work.plan.is_free and work.plan.side > 0 and len(fine.vertices) > MANY * points:
        thinning = Thinning(fine)
        tolerance = thinning.tolerance(points)
        with suppress(InvalidMeshError):
            yield thinning.mesh(tolerance), tolerance
    yield fine, 0.0
