"""Does it matter how the flow samples and weighs the gradient of the distance along the edges?"""

from __future__ import annotations

import statistics
from pathlib import Path

from comparison import methods
from comparison.bench import Bench
from comparison.cases import Inputs, on_curve, random_cases
from comparison.drawings import drawings
from comparison.measure import Results
from comparison.tables import count, matrix, number

TWO_SIDED = "two-sided"
PROGRAM, TEXT, BY_LENGTH = "the program's", "Algorithm 2", "fall-off by length"
FIXED, NEW = "even samples", "new samples each step"
RANDOM = 20
"""Random shapes."""


def run(inputs: Inputs, bench: Bench) -> Results:
    """Every flow on drawings, shapes of the folder and random shapes."""
    cases = drawings() | on_curve(inputs.shapes, tuple(inputs.shapes))
    cases |= random_cases(min(RANDOM, inputs.sizes.random), inputs.sizes.first_seed)
    return bench.compare("flows", cases, {name: methods.with_flow(name) for name in methods.FLOWS})


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """Steps of the flow, and the excess in the end."""
    return "\n\n".join([
        "## Flows and their quadratures",
        "The flow goes down the gradient of the signed distance, averaged over both edges of a vertex. Gurditta and "
        "Jacobson describe that in two ways. *Algorithm 2* of their text takes even samples with the weights (1 − t)² "
        "on either edge and normalises the sum: both edges count alike, whatever their lengths. *The program's* "
        "weights are these over the length of the edge, so that the shorter edge decides; a comment in it says that "
        "this is meant. Both are `PaperFlow`, with `over_length=False` and `True`. *Fall-off by length* "
        "(`QuadraticFallOff`) is neither: an integral along the edges, in which longer edges weigh more, and which is "
        "not normalised, so that steps are shorter where samples disagree. The reason that the text gives for the "
        "fall-off, that a vertex can stay outside while most of its edges are inside, is about its own sample and "
        "holds for all three.",
        "The text also suggests other samples at each step: *new samples each step* draws one at random from each "
        "quarter of an edge every time; *even samples* has them in the middle, with the same weights. *Two-sided* is "
        "ours, which does not average gradients but solves for displacements. The rows of the text, the program and "
        "the rules all have exact signs. IPC and the tightening follow; steps of the flow, and the excess:",
        matrix(
            "shape", list(next(iter(found.values()))), found,
            lambda run: f"{run.flow_steps} · {number(run.excess)} %" if run.success else f"**{run.failed}**",
        ),
    ])  # fmt: skip


def entered(found: Results, name: str) -> int:
    """On how many shapes a flow gets inside."""
    return sum(shape[name].failed != "flow" for shape in found.values())


def finding(found: Results, inputs: Inputs) -> str:
    """Successes, and steps where all succeed."""
    names = list(next(iter(found.values())))
    solved = [shape for shape in found.values() if all(shape[name].success for name in names)]
    if not solved:
        return ""
    told = [
        f"{name} {entered(found, name)} inside ({count(found, name)} succeed), "
        f"{statistics.mean(shape[name].flow_steps for shape in solved):.1f} steps"
        for name in names
    ]
    rules = [name for name in names if name != TWO_SIDED]
    spreads = [max(values) - min(values) for values in ([shape[name].excess for name in rules] for shape in solved)]
    return (
        f"**Flows.** Of {len(found)} shapes, and mean number of steps on the {len(solved)} that all solve: "
        + "; ".join(told)
        + f". Between the rules the excess differs by {statistics.median(spreads):.2f} points in the median and "
        f"{max(spreads):.2f} at most."
    )
