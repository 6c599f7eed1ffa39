"""One level: decimation, flow, reinflation, tightening, verification."""

from __future__ import annotations

from .._types import FloatArray
from ..contact.pairs import Bodies
from ..decimation import Candidates, Count, Decimation
from ..energies import CageEnergy
from ..errors import FlowError, NestedCagesError, NestingError, ReinflationError
from ..flow import FlowResult
from ..flow.matching import match_loops
from ..mesh import Mesh
from ..reinflation import Reinflation, reinflate
from ..verification import Certificate, verify, verify_motion
from .reporting import Reporter
from .results import Level, NestingReport
from .settings import Settings
from .units import Clearance, Frame


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
        generated = not isinstance(wanted, Mesh)
        self.report.begin("decimation")
        try:
            if isinstance(wanted, Mesh):
                return self._nest(wanted, False, ())
            return self._best(self._starts(settings.decimation, wanted), ())
        except (FlowError, ReinflationError, NestingError) as error:
            if settings.fallback is None or (generated and settings.fallback == settings.decimation):
                raise
            note = f"Started from the outer hull instead of the coarse mesh: {error}"
        self.report.begin("decimation")
        return self._best(self._starts(settings.fallback, self._counts(wanted)), (note,))

    def _starts(self, decimation: Decimation, count: Count) -> list[Mesh]:
        """Coarse meshes to begin with: several where the decimation offers them, since they end in different optima."""
        clearance = self.clearance.length
        if isinstance(decimation, Candidates) and self.settings.starts > 1:
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

    def _best(self, starts: list[Mesh], notes: tuple[str, ...]) -> Level:
        """The tightest cage from any of the starts; the first error when there is none."""
        best: Level | None = None
        first_error: NestedCagesError | None = None
        for number, coarse in enumerate(starts):
            self.report.start(number, len(starts))
            try:
                level = self._nest(coarse, True, notes)
            except (FlowError, ReinflationError, NestingError) as error:
                first_error = first_error or error
                continue
            if best is None or level.report.excess < best.report.excess:
                best = level
        if best is not None:
            return best
        assert first_error is not None
        raise first_error

    def _nest(self, coarse: Mesh, generated: bool, notes: tuple[str, ...]) -> Level:
        settings, frame, report = self.settings, self.frame, self.report
        unit_coarse = coarse.moved(frame.inside(coarse.vertices))
        report.begin("flow")
        unit_flow = self._flow(unit_coarse)
        report.begin("reinflation")
        wanted = self.clearance.length
        energy = settings.energy.at(unit_coarse)
        expansion = energy if settings.expansion_energy is None else settings.expansion_energy.at(unit_coarse)
        way_home = reinflate(
            self.unit_fine,
            unit_coarse,
            unit_flow.steps,
            contacts=settings.contacts(len(coarse.vertices), len(self.fine.vertices)),
            energy=expansion,
            solver=settings.solver,
            clearance=frame.length(wanted),
            progress=report,
        )
        for length in self.clearance.options():
            report.begin("tightening")
            tightened, counts = self._tighten(unit_coarse, way_home, length, energy)
            report.begin("verification")
            flow, reinflation = self._in_input_units(coarse, unit_flow, tightened)
            cage = coarse.moved(reinflation.cage_steps[-1])
            certificate = verify(cage, self.fine, length, same_loops=len(coarse.loops) == len(self.fine.loops))
            report.pause()
            if certificate.holds or not (certificate.strict and certificate.simple):
                break
        if not certificate.holds:
            raise NestingError(_refusal(certificate, self.clearance.length))
        motion = verify_motion(cage, self.fine, reinflation.cage_steps, reinflation.fine_steps)
        report.pause()
        if not motion:
            raise NestingError(
                f"The motion from step {motion.step} to the next could not be certified free of collisions; "
                "use more cage vertices, or a coarse mesh closer to the fine one."
            )
        if length < wanted:
            notes = (*notes, f"The gaps of the fine mesh leave room for a clearance of {length:.3g}, not {wanted:.3g}.")
        if len(coarse.loops) != len(self.fine.loops):
            notes = (*notes, f"The cage has {len(coarse.loops)} loops, and the mesh inside it {len(self.fine.loops)}.")
        nesting = NestingReport(
            strict=certificate.strict,
            simple=certificate.simple,
            clearance=certificate.clearance,
            wanted_clearance=length,
            excess=certificate.excess,
            start="outer hull" if generated and len(flow.steps) == 1 else "flow",
            iterations={"flow": flow.iterations, "reinflation": way_home.iterations, **counts},
            seconds=dict(report.seconds),
            notes=notes,
        )
        return Level(self.fine, coarse, cage, flow, reinflation, nesting)

    def _flow(self, unit_coarse: Mesh) -> FlowResult:
        try:
            return self.settings.flow.run(self.unit_fine, unit_coarse, progress=self.report)
        except FlowError as error:
            partial = error.partial
            if isinstance(partial, FlowResult) and partial.obstacle is not None:
                x, y = self.frame.centre
                raise FlowError(partial.obstacle.sentence(self.frame.scale, (float(x), float(y)))) from error
            raise

    def _tighten(
        self, unit_coarse: Mesh, way_home: Reinflation, clearance: float, energy: CageEnergy
    ) -> tuple[Reinflation, dict[str, int]]:
        cages: list[FloatArray] = []

        def on_step(cage: FloatArray) -> None:
            cages.append(cage)
            self.report(1.0 - 1.0 / (1.0 + 0.1 * len(cages)), f"tightening, step {len(cages)}")

        outcome = self.settings.tightening.run(
            Bodies.of(unit_coarse, self.unit_fine),
            way_home.cage_steps[-1],
            self.unit_fine.vertices,
            clearance=self.frame.length(clearance),
            energy=energy,
            on_step=on_step,
        )
        counts = {"tightening": outcome.iterations, "quadratic programs": outcome.quadratic_programs}
        return way_home.with_tightening(cages), counts

    def _in_input_units(
        self, coarse: Mesh, unit_flow: FlowResult, unit_way: Reinflation
    ) -> tuple[FlowResult, Reinflation]:
        """The same in the input's units; what came in is put back bit by bit."""
        frame, home = self.frame, self.fine.vertices
        flow_steps = frame.outside(unit_flow.steps)
        flow_steps[0] = home
        fine_steps = frame.outside(unit_way.fine_steps)
        fine_steps[0] = flow_steps[-1]
        fine_steps[unit_way.tightening_start :] = home
        cage_steps = frame.outside(unit_way.cage_steps)
        cage_steps[0] = coarse.vertices
        flow = FlowResult(flow_steps, unit_flow.iterations, unit_flow.stage)
        return flow, Reinflation(fine_steps, cage_steps, unit_way.tightening_start, unit_way.iterations)


def _refusal(certificate: Certificate, wanted: float) -> str:
    """Why a cage was not returned."""
    if certificate.strict and certificate.simple:
        return (
            f"No cage keeps the clearance of {wanted:.6g}: the best one comes as close as {certificate.clearance:.6g}. "
            "Ask for less clearance or use more vertices."
        )
    return "The cage could not be certified: " + " ".join(certificate.problems)
