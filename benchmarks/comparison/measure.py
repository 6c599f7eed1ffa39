"""One run of one method on one shape, phase by phase, so that a failure leaves behind what was reached until then."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import numpy as np

from nestedcages_core import FlowError, Mesh, NestedCagesError, ReinflationError, Settings, verify, verify_motion
from nestedcages_core.contact.pairs import Bodies
from nestedcages_core.energies.containment import Containment
from nestedcages_core.hierarchy.units import Frame
from nestedcages_core.reinflation import Reinflation, reinflate

CLEARANCE = 1e-5  # bounding-box diagonals of the fine mesh, the default of nested_cages
LIMIT = 12.0  # CPU seconds after which a run is ended
REPEATS = 3  # runs of which the fastest counts, where they are short
SHORT = 0.5  # CPU seconds up to which a run is short


class OutOfTimeError(Exception):
    """The run has used up its seconds."""


@dataclass
class Measurement:
    """What became of a run. Lengths in bounding-box diagonals, excess in per cent."""

    fine: Mesh
    coarse: Mesh | None = None
    cage: Mesh | None = None
    failed: str = ""
    """The phase that failed, or empty."""
    problem: str = ""
    """Its message."""
    seconds: dict[str, float] = field(default_factory=dict)
    iterations: int = 0
    """Of the reinflation."""
    flow_steps: int = 0
    excess: float | None = None
    smallest: float | None = None
    """Smallest distance between the cage and the fine mesh at home."""
    short: float | None = None
    """How far the fine mesh is from home; 0 to the last bit."""
    certified: bool = False
    """Whether the cage strictly contains the fine mesh at home, simple, with its loops and the clearance."""
    free: bool | None = None
    """Whether the animation is certified free of crossings, its first step included."""

    @property
    def success(self) -> bool:
        """A certified cage, the fine mesh at home, an animation without a crossing."""
        return not self.failed and self.certified and self.short == 0.0 and bool(self.free)

    @property
    def total(self) -> float:
        """CPU seconds."""
        return sum(self.seconds.values())


def measure(
    settings: Settings, fine: Mesh, wanted: Mesh | int, repeats: int = REPEATS, limit: float = LIMIT
) -> Measurement:
    """Run a method on a fine mesh, from a coarse mesh or a vertex count; short runs are repeated for their times."""
    best = _once(settings, fine, wanted, limit)
    for _ in range(repeats - 1):
        if best.total > SHORT:
            break
        again = _once(settings, fine, wanted, limit)
        best = min(best, again, key=lambda result: result.total)
    return best


def _once(settings: Settings, fine: Mesh, wanted: Mesh | int, limit: float) -> Measurement:
    result = Measurement(fine)
    ends = time.process_time() + limit
    phase = "decimation"
    began = time.process_time()

    def progress(fraction: float, message: str) -> None:
        if time.process_time() > ends:
            raise OutOfTimeError

    def enter(next_phase: str) -> None:
        nonlocal phase, began
        now = time.process_time()
        result.seconds[phase] = now - began
        phase, began = next_phase, now

    frame = Frame.of(fine)
    home = fine.moved(frame.inside(fine.vertices))
    way: Reinflation | None = None
    try:
        coarse = wanted
        if not isinstance(coarse, Mesh):
            coarse = settings.decimation.decimate(fine, coarse, clearance=CLEARANCE * fine.diagonal)
        coarse = coarse.moved(frame.inside(coarse.vertices))
        result.coarse = coarse
        enter("flow")
        flow = settings.flow.run(home, coarse, progress=progress)
        result.flow_steps = len(flow.steps) - 1
        enter("reinflation")
        energy = settings.energy.at(coarse)
        expansion = settings.expansion_energy.at(coarse) if settings.expansion_energy else energy
        way = reinflate(
            home, coarse, flow.steps,
            contacts=settings.contacts(len(coarse.vertices), len(home.vertices)),
            energy=expansion, solver=settings.solver, clearance=CLEARANCE, progress=progress,
        )  # fmt: skip
        enter("tightening")
        if settings.tightening.iterations > 0:
            cages: list[np.ndarray] = []
            settings.tightening.run(
                Bodies.of(coarse, home), way.cage_steps[-1], home.vertices,
                clearance=CLEARANCE, energy=energy, on_step=cages.append,
            )  # fmt: skip
            way = way.with_tightening(cages)
        enter("verification")
    except OutOfTimeError:
        result.failed, result.problem = phase, f"ended after {limit:.0f} s"
    except (ReinflationError, FlowError, NestedCagesError) as error:
        result.failed, result.problem = phase, str(error)
        if isinstance(error.partial, Reinflation):
            way = error.partial
    if way is not None and result.coarse is not None:
        _judge(result, way, home)
    enter("")
    return result


def _judge(result: Measurement, way: Reinflation, home: Mesh) -> None:
    """What the certificates say of the last step and of the way to it."""
    assert result.coarse is not None
    result.iterations = way.iterations or len(way.fine_steps) - 1
    result.short = float(np.hypot(*(way.fine_steps[-1] - home.vertices).T).max())
    if not np.isfinite(way.cage_steps[-1]).all():
        return
    result.cage = result.coarse.moved(way.cage_steps[-1])
    same = len(result.coarse.loops) == len(home.loops)
    certificate = verify(result.cage, home, 0.0, same_loops=same)
    result.certified, result.smallest = certificate.holds, certificate.clearance
    result.excess = 100.0 * certificate.excess
    start = np.concatenate([way.cage_steps[0], way.fine_steps[0]])
    apart = Containment(result.cage.successor, home.successor).value(start) == 0.0
    result.free = apart and bool(verify_motion(result.cage, home, way.cage_steps, way.fine_steps))
