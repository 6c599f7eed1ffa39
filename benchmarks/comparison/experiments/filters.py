"""What do step filters and broad phases cost and save?"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from comparison import methods
from comparison.bench import Bench
from comparison.cases import Inputs, flow_cases
from comparison.measure import REPEATS, Results
from comparison.tables import matrix, number
from nestedcages_core import IPC


def run(inputs: Inputs, bench: Bench) -> Results:
    """Every filter with every broad phase, of IPC."""
    chosen = {
        f"{step_filter}, {broad_phase}": replace(methods.TIGHT, contact=IPC(step_filter=chosen, broad_phase=phase))
        for step_filter, chosen in methods.FILTERS.items()
        for broad_phase, phase in methods.BROAD_PHASES.items()
    }
    return bench.compare("filters", flow_cases(inputs.shapes), chosen, repeats=REPEATS)


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """Iterations and seconds of the reinflation."""
    return "\n\n".join([
        "## Step filters and broad phases",
        "IPC with each of them: Newton iterations and CPU seconds of the reinflation. *none*: any step, refused by its "
        "energy afterwards, as in the paper; *smallest distance*: the cached smallest distance bounds the step, which "
        "the paper describes as further work; *time of impact*: the first root over all pairs.",
        matrix(
            "shape", list(next(iter(found.values()))), found,
            lambda run: f"{run.iterations} · {number(run.seconds.get('reinflation'), '.3f')} s"
            + ("" if run.success else f" **{run.failed or 'not certified'}**"),
        ),
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
