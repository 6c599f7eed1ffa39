"""What do step filters and broad phases cost and save, and would it pay to keep the structures of the flow?"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from comparison import methods
from comparison.cases import Inputs, flow_cases
from comparison.measure import REPEATS, Results, compare, measure
from comparison.tables import folded, matrix, number, table
from nestedcages_core import IPC
from nestedcages_core.contact.pairs import Bodies, CandidateList, Pairs


def run(inputs: Inputs) -> Results:
    """Every filter with every broad phase, of IPC; and, as another method, the clock on its lists."""
    chosen = {
        f"{step_filter}, {broad_phase}": replace(methods.TIGHT, contact=IPC(step_filter=chosen, broad_phase=phase))
        for step_filter, chosen in methods.FILTERS.items()
        for broad_phase, phase in methods.BROAD_PHASES.items()
    }
    return compare("filters", flow_cases(inputs.shapes), chosen, repeats=REPEATS)


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """Iterations and seconds of the reinflation, and the share of building lists."""
    costs = reuse(inputs)
    lines = [
        [shape, str(cost.builds), number(cost.building, ".4f"), number(cost.reinflation, ".4f"), f"{cost.share:.0f}"]
        for shape, cost in costs.items()
    ]
    shares = [cost.share for cost in costs.values()]
    return "\n\n".join([
        "## Step filters, broad phases, and reuse",
        "IPC with each of them: Newton iterations and CPU seconds of the reinflation. *none*: any step, refused by its "
        "energy afterwards, as in the paper; *smallest distance*: the cached smallest distance bounds the step, which "
        "the paper describes as further work; *time of impact*: the first root over all pairs.",
        matrix(
            "shape", list(next(iter(found.values()))), found,
            lambda run: f"{run.iterations} · {number(run.seconds.get('reinflation'), '.3f')} s"
            + ("" if run.success else f" **{run.failed or 'not certified'}**"),
        ),
        "The paper suggests to reuse the structure of a flow step when reinflation returns to it. What that could save "
        "at most is the building of lists of pairs:",
        table(["shape", "lists built", "building s", "reinflation s", "share %"], lines),
        f"That is {min(shares):.0f} to {max(shares):.0f} % of the reinflation. Lists are already kept while little has "
        "moved, and those of the flow would hold only for a cage that has not moved since, which it has as soon as "
        "there was contact. So it was not built.",
        folded(found),
    ])  # fmt: skip


def finding(found: Results, inputs: Inputs) -> str:
    """Totals over all cases."""
    told = []
    for name in next(iter(found.values())):
        runs = [shape[name] for shape in found.values()]
        seconds = sum(run.seconds.get("reinflation", 0.0) for run in runs)
        told.append(
            f"{name}: {sum(run.iterations for run in runs)} iterations, {seconds:.2f} s, "
            f"{sum(run.success for run in runs)} of {len(runs)}"
        )
    return (
        "**Step filters and broad phases** of IPC, all cases together: " + "; ".join(told) + ". The bound by the "
        "smallest distance is as safe as the time of impact and costs no root, but the nearest pair slows all the "
        "others down: near contact its steps are so short that it needs many more iterations, and where it stalls it "
        "fails. No filter at all needs the same iterations as the time of impact here, because projected Newton steps "
        "are refused by their energy when they cross; but nothing then vouches for the way between two steps."
    )


@dataclass(frozen=True)
class TimedCells:
    """The broad phase by cells with a clock on the building of its lists."""

    clock: dict[str, float]

    def candidates(self, bodies: Bodies) -> _TimedList:
        """A list that adds the seconds of its builds to the clock."""
        return _TimedList(bodies, self.clock)


class _TimedList(CandidateList):
    def __init__(self, bodies: Bodies, clock: dict[str, float]) -> None:
        super().__init__(bodies)
        self.clock = clock

    def within(self, x: np.ndarray, reach: float, skin: float) -> Pairs:
        builds, began = self.builds, time.process_time()
        pairs = super().within(x, reach, skin)
        if self.builds > builds:
            self.clock["builds"] += 1
            self.clock["seconds"] += time.process_time() - began
        return pairs


class Reuse(NamedTuple):
    """What building lists costs in one reinflation: the most that reusing a structure of the flow could save."""

    builds: int
    building: float
    """CPU seconds."""
    reinflation: float
    """CPU seconds."""

    @property
    def share(self) -> float:
        """Per cent."""
        return 100.0 * self.building / max(self.reinflation, 1e-12)


def reuse(inputs: Inputs) -> dict[str, Reuse]:
    """The share of building among the costs of IPC."""
    found: dict[str, Reuse] = {}
    for shape, pair in flow_cases(inputs.shapes).items():
        clock = {"builds": 0.0, "seconds": 0.0}
        result = measure(replace(methods.TIGHT, contact=IPC(broad_phase=TimedCells(clock))), *pair, 1)
        found[shape] = Reuse(int(clock["builds"]), clock["seconds"], result.seconds.get("reinflation", 0.0))
    return found
