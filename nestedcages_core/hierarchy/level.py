"""One level: decimation, flow, reinflation, tightening, verification."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ..contact.pairs import Bodies
from ..contact.reinflation import Reinflation, reinflate
from ..decimation import Count, Decimation, SeveralStarts
from ..decimation.base import clamped, shared_anew
from ..energies import CageEnergy, signed_area
from ..errors import FlowError, NestedCagesError, NestingError, ReinflationError
from ..flow import FlowResult
from ..flow.loop_matching import match_loops
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..verification import Certificate, verify, verify_motion
from ..verification.certificate import loops_in_words
from .clearance_bounds import no_room
from .reporting import Reporter
from .results import Level, NestingReport
from .settings import Settings
from .units import Clearance, Frame

logger = logging.getLogger(__name__)

FIRST_LOOK = 4
"""Steps of a tightening before it is compared with the best one: the first steps only repair the start."""

STEPS_AHEAD = 4.0
"""Steps like the last one that a tightening is trusted to make still; gains about halve from step to step."""


class LevelBuilder:
    """Makes one level around ``fine``."""

    def __init__(self, fine: Mesh, clearance: Clearance, settings: Settings, report: Reporter) -> None:
        self.fine = fine
        self.clearance = clearance
        self.settings = settings
        self.report = report
        self.frame = Frame.of(fine)
        self.unit_fine = fine.moved(self.frame.inside(fine.vertices))

    def build(self, wanted: int | Mesh) -> Level:
        """The level for a vertex count or a coarse mesh, by the flow or, where that fails, from the fallback."""
        settings = self.settings
        notes: tuple[str, ...] = ()
        if not isinstance(wanted, Mesh):
            wanted, notes = clamped(wanted, self.fine)
        same = not isinstance(wanted, Mesh) and settings.fallback == settings.decimation
        fallback = None if same else settings.fallback
        self.report.begin("decimation")
        try:
            if isinstance(wanted, Mesh):
                return self._certified(self._approach(wanted, False), ())
            return self._best(self._starts(settings.decimation, wanted), notes, last=fallback is None)
        except (FlowError, ReinflationError, NestingError) as error:
            if fallback is None:
                raise
            note = f"Started from the outer hull instead of the coarse mesh: {error}"
            logger.debug("fallback: %s", error)
        self.report.begin("decimation")
        counts = self._counts(wanted)
        starts = self._starts(fallback, counts)
        return self._best(starts, (*notes, note, *shared_anew(counts, starts[0])), last=True)

    def _starts(self, decimation: Decimation, count: Count) -> list[Mesh]:
        """Coarse meshes to begin with: several where the decimation offers them, since they end in different optima."""
        clearance = self.clearance.length
        if isinstance(decimation, SeveralStarts) and self.settings.starts > 1:
            return decimation.candidates(self.fine, count, clearance=clearance, keep=self.settings.starts)
        return [decimation.decimate(self.fine, count, clearance=clearance)]

    def _counts(self, wanted: int | Mesh) -> Count:
        """For the fallback: the vertices of each loop of the coarse mesh, or their total where its loops are others."""
        if not isinstance(wanted, Mesh):
            return wanted
        total = max(len(wanted.vertices), 3 * len(self.fine.loops))
        if len(wanted.loops) != len(self.fine.loops):
            return total
        try:
            return [len(wanted.loops[k]) for k in match_loops(self.fine, wanted).partner]
        except FlowError:
            return total

    def _best(self, starts: list[Mesh], notes: tuple[str, ...], *, last: bool) -> Level:
        """The tightest certified cage from any of the starts; the first error when there is none.

        last: whether nothing else will be tried, so that a start which is a cage itself is better than none.
        """
        attempts: list[_Attempt] = []
        errors: list[NestedCagesError] = []
        for number, coarse in enumerate(starts):
            self.report.start(number, len(starts))
            size, area = len(coarse.vertices), coarse.area
            logger.debug("start %d of %d: %d vertices, area %.9g", number + 1, len(starts), size, area)
            beat = min((attempt.area for attempt in attempts), default=np.inf)
            try:
                attempts.append(self._approach(coarse, True, beat))
            except _LosingError:
                logger.debug("start %d given up: it will not beat the best one", number + 1)
                continue
            except (FlowError, ReinflationError, NestingError) as error:
                logger.debug("start %d failed: %s", number + 1, error)
                errors.append(error)
        for attempt in sorted(attempts, key=lambda attempt: attempt.area):
            try:
                return self._certified(attempt, notes)
            except NestingError as error:
                errors.append(error)
        for coarse in starts if last else ():
            level = self._untightened(coarse, notes)
            if level is not None:
                return level
        raise errors[0]

    def _approach(self, coarse: Mesh, generated: bool, beat: float = np.inf) -> _Attempt:
        """Flow, reinflation and tightening from a coarse mesh; given up when it will not come below the area
        ``beat``."""
        settings, frame, report = self.settings, self.frame, self.report
        unit_coarse = coarse.moved(frame.inside(coarse.vertices))
        report.begin("flow")
        unit_flow = self._flow(unit_coarse)
        report.begin("reinflation")
        energy = settings.energy.at(unit_coarse)
        expansion = energy if settings.expansion_energy is None else settings.expansion_energy.at(unit_coarse)
        way_home = reinflate(
            self.unit_fine,
            unit_coarse,
            unit_flow.steps,
            contacts=settings.contacts(len(coarse.vertices), len(self.fine.vertices)),
            energy=expansion,
            solver=settings.solver,
            clearance=frame.length(self.clearance.length),
            progress=report,
        )
        attempt = _Attempt(coarse, generated, unit_coarse, unit_flow, way_home, energy)
        return self._tightened(attempt, self.clearance.length, beat)

    def _tightened(self, attempt: _Attempt, clearance: float, beat: float = np.inf) -> _Attempt:
        """The attempt with its cage tightened at a clearance in the input's units."""
        self.report.begin("tightening")
        race = _Race(attempt.unit_coarse.successor, beat)
        cages: list[FloatArray] = []

        def on_step(cage: FloatArray) -> None:
            cages.append(cage)
            self.report(1.0 - 1.0 / (1.0 + 0.1 * len(cages)), f"tightening, step {len(cages)}")
            race.check(cage)

        start = attempt.way_home.cage_steps[-1]
        outcome = self.settings.tightening.run(
            Bodies.of(attempt.unit_coarse, self.unit_fine),
            start,
            self.unit_fine.vertices,
            clearance=self.frame.length(clearance),
            energy=attempt.energy,
            on_step=on_step,
        )
        return replace(
            attempt,
            way=attempt.way_home.with_tightening(cages),
            area=signed_area(cages[-1] if cages else start, attempt.unit_coarse.successor),
            counts={"tightening": outcome.iterations, "quadratic programs": outcome.quadratic_programs},
        )

    def _certified(self, attempt: _Attempt, notes: tuple[str, ...]) -> Level:
        """The level that an attempt makes, at the largest of the clearances in question that can be certified."""
        report, coarse, wanted = self.report, attempt.coarse, self.clearance.length
        # a coarse mesh of one's own may wrap several parts in one loop or cover holes
        same_loops = coarse.has_loops_like(self.fine)
        for length in self.clearance.options():
            if length < wanted:
                attempt = self._tightened(attempt, length)
            report.begin("verification")
            flow, reinflation = self._in_input_units(attempt)
            cage = coarse.moved(reinflation.cage_steps[-1])
            certificate = verify(cage, self.fine, length, same_loops=same_loops)
            if not _is_only_too_close(certificate, length):
                break
        if not certificate.holds:
            raise NestingError(_refusal(certificate, self.fine, length, wanted))
        motion = verify_motion(cage, self.fine, reinflation.cage_steps, reinflation.fine_steps)
        report.pause()
        if not motion:
            raise NestingError(
                f"The motion from step {motion.step} to the next could not be certified free of collisions; "
                "use more cage vertices, or a coarse mesh closer to the fine one."
            )
        if length < wanted:
            notes = (*notes, f"The gaps of the fine mesh leave room for a clearance of {length:.3g}, not {wanted:.3g}.")
        if not same_loops:
            kept, given = loops_in_words(coarse), loops_in_words(self.fine)
            notes = (*notes, f"The cage has {kept}, but the mesh in it has {given}.")
        start = "outer hull" if attempt.generated and len(flow.steps) == 1 else "flow"
        counts = {"flow": flow.iterations, "reinflation": reinflation.iterations, **attempt.counts}
        nesting = self._report(certificate, length, start=start, iterations=counts, notes=notes)
        return Level(self.fine, coarse, cage, flow, reinflation, nesting)

    def _untightened(self, coarse: Mesh, notes: tuple[str, ...]) -> Level | None:
        """The level of a coarse mesh that is a cage as it is; None if it is none.

        Details that are tiny beside the whole may be told apart in the input's units only, near the origin.
        """
        certificate, wanted = verify(coarse, self.fine), self.clearance.length
        length = min(wanted, certificate.clearance) if self.clearance.negotiable else wanted
        if not certificate.holds or certificate.clearance < length:
            return None
        notes = (*notes, "The coarse mesh is not tightened: details of the fine mesh are too small beside the whole.")
        counts = {"flow": 0, "reinflation": 0}
        nesting = self._report(certificate, length, start="outer hull", iterations=counts, notes=notes)
        flow = FlowResult(self.fine.vertices[None], 0, "inside")
        stands = Reinflation(self.fine.vertices[None], coarse.vertices[None], 0, 0)
        return Level(self.fine, coarse, coarse, flow, stands, nesting)

    def _report(
        self,
        certificate: Certificate,
        length: float,
        *,
        start: str,
        iterations: Mapping[str, int],
        notes: tuple[str, ...],
    ) -> NestingReport:
        """What is certified, and how long it took."""
        return NestingReport(
            strict=certificate.strict,
            simple=certificate.simple,
            clearance=certificate.clearance,
            wanted_clearance=length,
            excess=certificate.excess,
            start=start,
            iterations=iterations,
            seconds=dict(self.report.seconds),
            notes=notes,
        )

    def _flow(self, unit_coarse: Mesh) -> FlowResult:
        try:
            return self.settings.flow.run(self.unit_fine, unit_coarse, progress=self.report)
        except FlowError as error:
            partial = error.partial
            if isinstance(partial, FlowResult) and partial.obstacle is not None:
                x, y = self.frame.centre
                raise FlowError(partial.obstacle.sentence(self.frame.scale, (float(x), float(y)))) from error
            raise

    def _in_input_units(self, attempt: _Attempt) -> tuple[FlowResult, Reinflation]:
        """Its steps in the input's units; what came in is put back bit by bit."""
        frame, home, way = self.frame, self.fine.vertices, attempt.way
        assert way is not None
        flow_steps = frame.outside(attempt.unit_flow.steps)
        flow_steps[0] = home
        fine_steps = frame.outside(way.fine_steps)
        fine_steps[0] = flow_steps[-1]
        fine_steps[way.tightening_start :] = home
        cage_steps = frame.outside(way.cage_steps)
        cage_steps[0] = attempt.coarse.vertices
        flow = FlowResult(flow_steps, attempt.unit_flow.iterations, attempt.unit_flow.stage)
        return flow, Reinflation(fine_steps, cage_steps, way.tightening_start, way.iterations)


@dataclass(frozen=True, eq=False)
class _Attempt:
    """A cage on its way, in the units of the solvers but for ``coarse``."""

    coarse: Mesh
    generated: bool
    unit_coarse: Mesh
    unit_flow: FlowResult
    way_home: Reinflation
    energy: CageEnergy
    way: Reinflation | None = None
    """The way home and the tightening after it."""
    area: float = np.inf
    """Of the tightened cage."""
    counts: Mapping[str, int] = field(default_factory=dict)


class _LosingError(Exception):
    """Raised inside a tightening that will not beat the best one so far."""


class _Race:
    """Gives a tightening up when even several more steps like its last one would leave it behind."""

    def __init__(self, successor: IntArray, beat: float) -> None:
        self._successor = successor
        self._beat = beat
        self._areas: list[float] = []

    def check(self, cage: FloatArray) -> None:
        """Look at the next step."""
        if np.isinf(self._beat):
            return
        self._areas.append(signed_area(cage, self._successor))
        if len(self._areas) >= FIRST_LOOK:
            gain = max(self._areas[-2] - self._areas[-1], 0.0)
            if self._areas[-1] - STEPS_AHEAD * gain > self._beat:
                raise _LosingError


def _is_only_too_close(certificate: Certificate, clearance: float) -> bool:
    """Whether a cage lacks nothing but the clearance."""
    sound = certificate.strict and certificate.simple and len(certificate.problems) == 1
    return sound and certificate.clearance < clearance


def _refusal(certificate: Certificate, fine: Mesh, tried: float, wanted: float) -> str:
    """Why a cage was not returned; tried: the last clearance asked for."""
    if not _is_only_too_close(certificate, tried):
        return "The cage could not be certified: " + " ".join(certificate.problems)
    return no_room(fine, wanted) or (
        f"No cage with so few vertices was found that keeps the clearance of {wanted:.6g}: the best one comes as close "
        f"as {certificate.clearance:.6g}; ask for less clearance or use more vertices."
    )
