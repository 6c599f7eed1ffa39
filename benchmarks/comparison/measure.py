"""One run of one method on one shape, phase by phase, so that a failure leaves behind what was reached until then."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from nestedcages_core import (
    Area,
    FlowResult,
    Mesh,
    NestedCagesError,
    Settings,
    Tightening,
    nested_cages,
    verify,
    verify_motion,
)
from nestedcages_core.cache import forget
from nestedcages_core.contact import Contact, ContactOutcome
from nestedcages_core.contact.pairs import Bodies
from nestedcages_core.contact.reinflation import Reinflation, reinflate
from nestedcages_core.energies.containment_energy import ContainmentEnergy
from nestedcages_core.level.attempts import contacts_for
from nestedcages_core.level.units import SolverUnits
from nestedcages_core.tasks import Stage, drain, mapped

OUT_OF_TIME = "ended after"
"""How the problem of a run begins that was ended."""

PHASES = ("flow", "reinflation", "tightening")
CLEARANCE = 1e-5  # bounding-box diagonals of the fine mesh, the default of nested_cages
LIMIT = 6.0  # CPU seconds after which a run is ended
REPEATS = 3  # runs of which the median counts, where they are short
SHORT = 0.05  # CPU seconds up to which a run is short


class OutOfTimeError(Exception):
    """The run has used up its seconds."""


class Started(NamedTuple):
    """A coarse mesh and the steps of a flow into it, so that all methods start alike."""

    coarse: Mesh
    steps: np.ndarray
    """(J + 1, n, 2), in the units of the solvers."""


Wanted = Mesh | int | Started
"""A coarse mesh, or how many vertices it should have."""


@dataclass
class Measurement:
    """What became of a run. Lengths in bounding-box diagonals, excess in per cent."""

    fine: Mesh
    coarse: Mesh | None = None
    cage: Mesh | None = None
    shrunk: Mesh | None = None
    """The fine mesh at the end of the flow."""
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
    """Whether the cage strictly contains the fine mesh at home, simple, with its loops."""
    free: bool | None = None
    """Whether the animation is certified free of crossings, its first step included."""

    @property
    def success(self) -> bool:
        """A certified cage, the fine mesh at home, an animation without a crossing."""
        return not self.failed and self.certified and self.short == 0.0 and bool(self.free)

    @property
    def ended(self) -> bool:
        """Whether the run came to its own end with a cage that encloses the fine mesh, home or not."""
        return self.certified and not self.out_of_time

    @property
    def out_of_time(self) -> bool:
        """Whether it was ended from outside."""
        return self.problem.startswith(OUT_OF_TIME)

    @property
    def total(self) -> float:
        """CPU seconds of all phases; the certificates, which judge all methods alike, are not among them."""
        return sum(self.seconds.values())


def measure(
    settings: Settings, fine: Mesh, wanted: Wanted, repeats: int = REPEATS, limit: float = LIMIT
) -> Measurement:
    """Run a method on a fine mesh, from a coarse mesh or a vertex count; of a short run, the repeat of median time."""
    found = [_once(settings, fine, wanted, limit)]
    while len(found) < repeats and found[0].total <= SHORT:
        found.append(_once(settings, fine, wanted, limit))
    return sorted(found, key=lambda result: result.total)[len(found) // 2]


@dataclass(frozen=True)
class Recorded:
    """A contact whose steps are kept, so that they are there when it runs out of time."""

    contact: Contact
    steps: list[np.ndarray]

    def reinflate(
        self,
        bodies: Bodies,
        x: np.ndarray,
        path: Sequence[np.ndarray],
        *,
        clearance: float,
    ) -> Stage[np.ndarray, ContactOutcome]:
        """What the contact does."""

        def record(state: np.ndarray) -> np.ndarray:
            if state is not self.steps[-1]:
                self.steps.append(state)
            return state

        self.steps[:] = [x]
        return mapped(self.contact.reinflate(bodies, x, path, clearance=clearance), record)


def _once(settings: Settings, fine: Mesh, wanted: Wanted, limit: float) -> Measurement:
    forget()
    result = Measurement(fine)
    ends = time.process_time() + limit
    phase = "decimation"
    began = time.process_time()

    def in_time(value: Any) -> Any:
        if time.process_time() > ends:
            raise OutOfTimeError
        return value

    def enter(next_phase: str) -> None:
        nonlocal phase, began
        now = time.process_time()
        result.seconds[phase] = now - began
        phase, began = next_phase, now

    units = SolverUnits.of(fine)
    home = units.from_input(fine)
    way: Reinflation | None = None
    states: list[np.ndarray] = []
    try:
        if isinstance(wanted, int):
            coarse = settings.decimation.decimate(fine, wanted, clearance=CLEARANCE * fine.diagonal)
        else:
            coarse = wanted if isinstance(wanted, Mesh) else wanted.coarse
        coarse = units.from_input(coarse)
        result.coarse = coarse
        enter("flow")
        if isinstance(wanted, Started):
            steps = wanted.steps
        else:
            steps = drain(mapped(units.method(settings.flow).run(home, coarse), in_time)).steps
        result.flow_steps, result.shrunk = len(steps) - 1, home.moved(steps[-1])
        enter("reinflation")
        contacts = [units.method(contact) for contact in contacts_for(settings, own=True)]
        recorded = [Recorded(contact, states) for contact in contacts]
        way = drain(mapped(reinflate(home, coarse, steps, contacts=recorded, clearance=CLEARANCE), in_time))
        enter("tightening")
        if settings.tightening.iterations > 0:
            tightening = settings.tightening.run(
                Bodies.of(coarse, home), way.cage_steps[-1], home.vertices,
                clearance=CLEARANCE, energy=settings.energy.at(coarse),
            )  # fmt: skip
            way = way.with_tightening(list(tightening))
    except OutOfTimeError:
        result.failed, result.problem = phase, f"{OUT_OF_TIME} {limit:.0f} s"
        if way is None and states and result.coarse is not None:
            m, stacked = len(result.coarse.vertices), np.stack(states)
            way = Reinflation(stacked[:, m:], stacked[:, :m], 0)
    except NestedCagesError as error:
        result.failed, result.problem = phase, str(error)
        if isinstance(error.partial, Reinflation):
            way = error.partial
        elif isinstance(error.partial, FlowResult):
            result.flow_steps, result.shrunk = len(error.partial.steps) - 1, home.moved(error.partial.steps[-1])
    enter("")
    if way is not None and result.coarse is not None:
        _judge(result, way, home)
    return result


def tightened(result: Measurement) -> Measurement:
    """The same run with the tightening after it, which begins where its reinflation ended."""
    again = replace(result, seconds=dict(result.seconds))
    if not result.success or result.coarse is None or result.cage is None:
        return again
    units = SolverUnits.of(result.fine)
    home, cage = units.from_input(result.fine), result.cage.vertices
    began = time.process_time()
    steps = list(
        Tightening().run(Bodies.of(result.coarse, home), cage, home.vertices, clearance=CLEARANCE,
                         energy=Area().at(result.coarse))
    )  # fmt: skip
    again.seconds["tightening"] = time.process_time() - began
    _judge(again, Reinflation(home.vertices[None], np.stack([cage, *steps]), result.iterations), home)
    return again


def measure_default(fine: Mesh, coarse: Mesh) -> Measurement:
    """What ``nested_cages`` does with a coarse mesh and no settings: contacts in turn, at last the outer hull."""
    result = Measurement(fine)
    units = SolverUnits.of(fine)
    forget()
    began = time.process_time()
    try:
        (level,) = nested_cages(fine, [coarse]).levels
    except NestedCagesError as error:
        result.failed, result.problem = "nested_cages", str(error)
        return result
    finally:
        result.seconds["nested_cages"] = time.process_time() - began
    result.coarse = units.from_input(level.coarse)
    result.flow_steps = len(level.flow.steps) - 1
    inner, outer = level.reinflation.moving_steps, level.reinflation.cage_steps
    way = Reinflation(
        (inner - units.centre) / units.scale, (outer - units.centre) / units.scale, level.reinflation.iterations
    )
    _judge(result, way, units.from_input(fine))
    return result


def _judge(result: Measurement, way: Reinflation, home: Mesh) -> None:
    """What the certificates say of the last step and of the way to it."""
    assert result.coarse is not None
    result.iterations = way.iterations or len(way.fine_steps) - 1
    result.short = float(np.hypot(*(way.fine_steps[-1] - home.vertices).T).max())
    if not np.isfinite(way.cage_steps[-1]).all():
        return
    result.cage = result.coarse.moved(way.cage_steps[-1])
    certificate = verify(result.cage, home, 0.0, same_loops=result.coarse.has_loops_like(home))
    result.certified, result.smallest = certificate.holds, certificate.clearance
    result.excess = 100.0 * certificate.excess
    start = np.concatenate([way.cage_steps[0], way.fine_steps[0]])
    apart = ContainmentEnergy(result.cage.successor, home.successor).value(start) == 0.0
    result.free = apart and bool(verify_motion(result.cage, home, way.cage_steps, way.fine_steps))
