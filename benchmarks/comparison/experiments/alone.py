"""What does each contact reach by itself, without the tightening?"""

from __future__ import annotations

import statistics
from pathlib import Path

from comparison import methods
from comparison.cases import Inputs, flow_cases
from comparison.measure import Results, compare
from comparison.tables import count, folded, matrix, number


def run(inputs: Inputs) -> Results:
    """Energy of all: area."""
    return compare("alone", flow_cases(inputs.shapes), {name: methods.alone(name) for name in methods.CONTACTS})


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """Excess, distance and iterations."""
    return "\n\n".join([
        "## What each contact reaches by itself",
        "The same, with the area as energy all the way and no tightening afterwards. Sequential QPs do not know an "
        "energy: they only clear the way. The velocity filter stops at its proximity, IPC where its barrier balances "
        "the area. Excess, smallest distance, systems solved:",
        matrix(
            "shape", list(methods.CONTACTS), found,
            lambda run: f"{number(run.excess)} % · {number(run.smallest, '.0e')} · {run.iterations}"
            + ("" if run.success else f" **{run.failed}**"),
        ),
        folded(found),
    ])  # fmt: skip


def finding(found: Results, inputs: Inputs) -> str:
    """Tightness and price."""
    told = []
    for name in methods.CONTACTS:
        good = [shape[name] for shape in found.values() if shape[name].success]
        if good:
            excess = statistics.mean(run.excess for run in good)
            systems = statistics.mean(run.iterations for run in good)
            told.append(f"{name} {excess:.2f} % after {systems:.0f} systems ({count(found, name)} succeed)")
    return (
        "**Without the tightening** the mean excess is: " + "; ".join(told) + ". The filter descends on the area at "
        "every step of the flow, which makes it the tightest by itself and the slowest; IPC is left where its barrier "
        "balances the area, and sequential QPs where they cleared the way. After the tightening these differences are "
        "gone, so it is the tightening, not the contact, that makes cages tight."
    )
