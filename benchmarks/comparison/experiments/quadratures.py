"""Does it matter where the flow samples the gradient of the distance?"""

from __future__ import annotations

import statistics
from pathlib import Path

from comparison import methods
from comparison.cases import Inputs, on_curve
from comparison.drawings import drawings
from comparison.measure import Results, compare
from comparison.tables import count, matrix, number

TWO_SIDED = "two-sided flow"


def run(inputs: Inputs) -> Results:
    """Every rule in the flow of the paper's Algorithms 1 and 2, on the drawings and the shapes of the folder."""
    chosen = {name: methods.with_quadrature(name) for name in methods.QUADRATURES} | {TWO_SIDED: methods.TIGHT}
    return compare("quadratures", drawings() | on_curve(inputs.shapes, tuple(inputs.shapes)), chosen)


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """Steps of the flow, and the excess in the end."""
    return "\n\n".join([
        "## Quadratures",
        "The flow of Algorithms 1 and 2 with exact signs and each rule for the gradient along the edges, then IPC and "
        "tightening: steps of the flow, and the excess. One Gauss point is the midpoint, so that these two agree. "
        "Beside them the two-sided flow, which does not average gradients but solves for displacements.",
        matrix(
            "shape", list(next(iter(found.values()))), found,
            lambda run: f"{run.flow_steps} · {number(run.excess)} %" if run.success else f"**{run.failed}**",
        ),
    ])  # fmt: skip


def finding(found: Results, inputs: Inputs) -> str:
    """Successes, and steps where all succeed."""
    names = list(next(iter(found.values())))
    solved = [shape for shape in found.values() if all(shape[name].success for name in names)]
    if not solved:
        return ""
    told = [
        f"{name} {count(found, name)}, {statistics.mean(shape[name].flow_steps for shape in solved):.1f} steps"
        for name in names
    ]
    excess = [[shape[name].excess for name in methods.QUADRATURES] for shape in solved]
    spreads = [max(values) - min(values) for values in excess]
    return (
        "**Quadratures.** Successes, and mean number of flow steps on the "
        f"{len(solved)} shapes that all solve: "
        + "; ".join(told)
        + f". Between the rules the excess differs by {statistics.median(spreads):.2f} points in the median and "
        f"{max(spreads):.2f} at most: the rule matters little compared with the flow itself, as the two-sided flow "
        "gets inside in a few steps with none."
    )
