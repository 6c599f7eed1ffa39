"""Does it pay to keep the trees of the flow for the reinflation?"""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass
from pathlib import Path

from comparison import methods
from comparison.bench import Bench
from comparison.cases import Inputs, flow_cases
from comparison.experiments.scaling import start_of_size
from comparison.kept_trees import FineTree, KeptTrees, NewTrees
from comparison.measure import Measurement, Results, Started, measure
from comparison.starts import start_in
from comparison.tables import number, table
from nestedcages_core import IPC, Mesh
from nestedcages_core.contact import BroadPhase, UniformGrid

GRID, NEW, KEPT = "uniform grid", "new trees", "trees of the flow"
SIZES = ((2000, 40), (5000, 100))


@dataclass
class Reused(Measurement):
    """A run, with what building the trees of the flow took."""

    trees: float = 0.0
    """CPU seconds."""


def run(inputs: Inputs, bench: Bench) -> Results:
    """IPC with each broad phase, from the same starts."""
    cases = {shape: start_in(*pair) for shape, pair in flow_cases(inputs.shapes).items()}
    cases |= {f"{n} in {m}": start_of_size(n, m) for n, m in SIZES}
    tasks = {
        (shape, name): (name, *start)
        for shape, start in cases.items()
        if start is not None
        for name in (GRID, NEW, KEPT)
    }
    found: Results = {}
    for (shape, name), result in bench.each("reuse", with_broad_phase, tasks).items():
        found.setdefault(shape, {})[name] = result
    return found


def with_broad_phase(name: str, fine: Mesh, start: Started) -> Measurement:
    """The reinflation by IPC."""
    phases: dict[str, BroadPhase] = {GRID: UniformGrid(), NEW: NewTrees()}
    seconds = 0.0
    if name == KEPT:
        began = time.process_time()
        trees = [FineTree.of(step, fine.successor) for step in start.steps]
        seconds = time.process_time() - began
        phases[KEPT] = KeptTrees(trees)
    result = measure(methods.alone(IPC(broad_phase=phases[name])), fine, start, 1)
    return Reused(**vars(result), trees=seconds)


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """Seconds of the reinflation by broad phase."""
    lines = []
    for shape, runs in found.items():
        seconds = [number(runs[name].seconds["reinflation"], ".4f") for name in (GRID, NEW, KEPT)]
        lines.append([shape, *seconds, number(trees_of(runs), ".4f"), number(runs[KEPT].excess)])
    return "\n\n".join([
        "## Reuse of the flow's trees",
        "The paper suggests to keep the bounding volume hierarchy of each step of the flow for when the reinflation "
        "returns to it. Here are k-d trees over the vertices and edges of the fine mesh, in place of our grid: built "
        "anew for every list of pairs, or kept from the flow, where the tree of the nearest step serves with a wider "
        "search. The lists of pairs are kept in all three while little moves. Seconds of the reinflation by IPC; those "
        "of building the trees come on top, where they are not needed by the flow itself:",
        table(["shape", GRID, NEW, KEPT, "building them", "excess %"], lines),
    ])  # fmt: skip


def trees_of(runs: dict[str, Measurement]) -> float:
    """Seconds of building the trees of the flow."""
    kept = runs[KEPT]
    return kept.trees if isinstance(kept, Reused) else 0.0


def saved(found: Results) -> list[float]:
    """Time of kept trees over that of new ones, building not counted, by shape."""
    return [runs[KEPT].seconds["reinflation"] / runs[NEW].seconds["reinflation"] for runs in found.values()]


def finding(found: Results, inputs: Inputs) -> str:
    """What it saves."""
    ratios = saved(found)
    grid = [runs[KEPT].seconds["reinflation"] / runs[GRID].seconds["reinflation"] for runs in found.values()]
    return (
        "**Reuse.** With the trees of the flow the reinflation takes "
        f"{statistics.geometric_mean(ratios):.2f} times as long as with new trees ({min(ratios):.2f} to "
        f"{max(ratios):.2f}), their building in the flow not counted, and {statistics.geometric_mean(grid):.2f} times "
        "as long as with the grid."
    )
