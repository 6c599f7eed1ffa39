"""One level of inner cages: inner hull, tightening towards the fine mesh, verification with the roles swapped."""

from __future__ import annotations

import logging
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from ..contact.pairs import Bodies
from ..contact.reinflation import Reinflation
from ..decimation import LineCycles, OnCurve, OuterHull, Start
from ..decimation.hull.inner_hull import SOURCE, inner_hulls
from ..decimation.line_cycles import inner_cycles
from ..energies import inwards, signed_area
from ..errors import Fault, NestingError
from ..flow import FlowResult
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..tasks import Stage
from ..verification import Certificate, verify
from ..verification.motion import certifying
from .choices import Choices
from .early_stop import EarlyStop
from .plan import Plan
from .progress import LevelProgress
from .report import Level, NestingReport, Progress
from .symmetrised_start import Alike, made_alike
from .units import SolverUnits

logger = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class _Tightened:
    """A coarse mesh and the steps from there to its cage, in the units of the solvers."""

    start: Start
    steps: tuple[FloatArray, ...]
    """(m, 2) each."""
    lost: float
    """Area between fine mesh and cage, or the energy with priorities."""
    iterations: int
    systems: int
    alike: Alike | None
    """Its exact symmetry."""


class InnerLevelBuilder:
    """Makes one level inside ``fine``. All methods that take time are generators of `Progress`.

    The unbounded region around an inner cage serves as its solid. Reversed, its loops are the oriented boundary of that
    region, so hull and solvers push it away from the fine mesh as they do with an outer cage.
    """

    def __init__(
        self,
        plan: Plan,
        clearances: tuple[float, ...],
        settings: Choices,
        progress: LevelProgress,
    ) -> None:
        self.plan, self.clearances, self.settings, self.progress = plan, clearances, settings, progress
        self.fine, self.outline = plan.fine, plan.outline
        self.symmetry = plan.group
        self.units = SolverUnits.of(self.fine)
        self.unit_fine = self.units.from_input(self.fine)

    def build(self, wanted: int | Mesh) -> Stage[Progress, Level]:
        """The certified level with the smallest lost area. Raises NestingError."""
        starts, notes = yield from self._coarse_meshes(wanted)
        cages: list[_Tightened] = []
        for start in starts:
            self.progress.next_start(len(starts))
            best = min((cage.lost for cage in cages), default=np.inf)
            cage = yield from self._tightened(start, self.clearances[0], best)
            if cage is not None:
                cages.append(cage)
        errors: list[NestingError] = []
        for cage in sorted(cages, key=lambda cage: cage.lost):
            try:
                return (yield from self._certified(cage, notes))
            except NestingError as error:
                logger.debug("inner cage from %s failed: %s", cage.start.source, error)
                errors.append(error)
        raise errors[0]

    def _coarse_meshes(self, wanted: int | Mesh) -> Stage[Progress, tuple[list[Start], tuple[Fault, ...]]]:
        """At least one mesh strictly inside the fine one, and notes."""
        notes = self.plan.remarks
        count: int | list[int]
        if isinstance(wanted, Mesh):
            inside = verify(self.fine, wanted)
            if inside:
                return [Start(wanted, "coarse mesh")], ()
            reason = "the coarse mesh does not lie strictly inside the fine one, loop by loop"
            if self.settings.fallback is None:
                raise NestingError(
                    f"No inner cage can start there: {reason}; move it inside, or give a vertex count.",
                    code="coarse.not_nested",
                )
            notes = (*notes, Fault(f"Started from the inner hull instead: {reason}.", "note.start", source=SOURCE))
            same = np.array_equal(wanted.loop_signs, self.fine.loop_signs)
            count = (
                [len(loop) for loop in wanted.loops] if same else max(len(wanted.vertices), 3 * len(self.fine.loops))
            )
        else:
            count, replaced = self.plan.possible(wanted)
            notes += replaced
        yield from self.progress.begin("decimation")
        clearance, most = self.clearances[0], self.settings.starts
        starts: list[Start] = []
        if isinstance(self.settings.decimation, LineCycles) and not isinstance(wanted, Mesh):
            cycles = inner_cycles(self.outline, count, clearance=clearance)
            with suppress(NestingError):
                starts = yield from self.progress.follow(cycles, lambda done: (done, "decimation"))
        if len(starts) < most:
            search = inner_hulls(
                _hull(self.settings), self.outline, count, clearance=clearance, most=most - len(starts)
            )
            try:
                starts += yield from self.progress.follow(search, lambda done: (done, "decimation"))
            except NestingError:
                if not starts:
                    raise
        return starts, notes

    def _tightened(self, start: Start, clearance: float, best: float = np.inf) -> Stage[Progress, _Tightened | None]:
        """The cage of a start; None if it cannot lose less area than ``best``."""
        yield from self.progress.begin("tightening")
        alike = None if self.symmetry is None else made_alike(start, self.symmetry, inside=True)
        start = start if alike is None else alike.start
        coarse = self.units.from_input(start.coarse)
        bodies = replace(
            Bodies.of(coarse, self.unit_fine, None if alike is None else alike.tie),
            cage_successor=coarse.predecessor,
            fine_successor=self.unit_fine.predecessor,
        )
        around = self.unit_fine.area
        energy, is_measure = self.plan.energy(
            inwards(self.settings.energy.at(coarse), around), coarse, self.units, self.units.clearance(clearance)
        )

        def cost(cage: FloatArray) -> float:
            if is_measure:
                return energy.after(cage).value(cage, bodies.cage_successor)
            return around - signed_area(cage, coarse.successor)

        tightening = self.settings.tightening.run(
            bodies,
            coarse.vertices,
            self.unit_fine.vertices,
            clearance=self.units.clearance(clearance),
            energy=energy,
        )
        early_stop = EarlyStop(best, cost(coarse.vertices))
        steps = [coarse.vertices]
        while True:
            try:
                steps.append(next(tightening))
            except StopIteration as end:
                outcome = end.value
                break
            if early_stop.cannot_improve(cost(steps[-1])):
                return None
            yield from self.progress.show(1.0 - 1.0 / (1.0 + 0.1 * len(steps)), f"tightening, step {len(steps) - 1}")
        lost = cost(steps[-1])
        logger.debug("inner start from %s: lost %.9g", start.source, lost)
        return _Tightened(start, tuple(steps), lost, outcome.iterations, outcome.quadratic_programs, alike)

    def _certified(self, cage: _Tightened, notes: tuple[Fault, ...]) -> Stage[Progress, Level]:
        """The level of a cage, at the largest clearance that can be certified. Raises NestingError."""
        coarse, wanted = cage.start.coarse, self.clearances[0]
        for clearance in self.clearances:
            if clearance < wanted:
                again = yield from self._tightened(cage.start, clearance)
                assert again is not None
                cage = again
            yield from self.progress.begin("verification")
            steps = self.units.to_input(np.stack(cage.steps))
            if cage.alike is not None:
                steps = cage.alike.symmetrised(steps)
            steps[0] = coarse.vertices
            result = coarse.moved(steps[-1])
            certificate = verify(self.fine, result, clearance)
            if certificate or not certificate.strict or certificate.clearance >= clearance:
                break
        if not certificate:
            raise NestingError(_failed(certificate, clearance))
        resting = Reinflation(self.fine.vertices[None], steps, 0)
        motion_check = certifying(Bodies.of(result, self.fine), list(steps), resting.fine_path)
        motion = yield from self.progress.follow(motion_check, lambda done: (done, "verification"))
        if not motion:
            raise NestingError(
                f"The motion from step {motion.step} to the next could not be certified free of collisions; "
                "use more cage vertices.",
                code="motion.collides",
                step=motion.step,
            )
        notes = (*notes, *self.plan.notes(result, clearance))
        if clearance < wanted:
            said = (
                f"The fine mesh is so narrow that there is room for a clearance of {clearance:.3g}, not {wanted:.3g}."
            )
            notes = (*notes, Fault(said, "note.clearance", wanted=wanted, given=clearance))
        self.progress.stop_clock()
        report = NestingReport(
            strict=certificate.strict,
            simple=certificate.simple,
            clearance=certificate.clearance,
            wanted_clearance=clearance,
            excess=result.area / self.fine.area - 1.0,
            start=cage.start.source,
            iterations={"flow": 0, "reinflation": 0, "tightening": cage.iterations, "quadratic programs": cage.systems},
            seconds=dict(self.progress.seconds),
            notes=notes,
        )
        flow = FlowResult(self.fine.vertices[None], 0, "inside")
        return Level(self.fine, coarse, result, flow, resting, report, inside=True)


def _hull(settings: Choices) -> OuterHull:
    """The hull search of the settings, or the default one."""
    chosen = settings.decimation.hull if isinstance(settings.decimation, OnCurve) else settings.decimation
    return chosen if isinstance(chosen, OuterHull) else OuterHull()


def _failed(certificate: Certificate, clearance: float) -> Fault:
    """Why an inner cage was not returned."""
    if certificate.strict and certificate.simple and len(certificate.problems) == 1:
        return Fault(
            f"No inner cage with so few vertices was found that keeps the clearance of {clearance:.6g}: the best one "
            f"comes as close as {certificate.clearance:.6g}; ask for less clearance or use more vertices.",
            "clearance.no_room",
            wanted=clearance,
            largest=certificate.clearance,
        )
    return Fault(
        "The inner cage could not be certified; in the words of verify(fine, cage), which takes the fine mesh for the "
        "cage: " + " ".join(certificate.problems),
        "certificate.failed",
        problems=certificate.problems,
    )
