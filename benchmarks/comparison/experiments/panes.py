"""The paper's figures 1 to 5 drawn again: input, end of the flow, result."""

from __future__ import annotations

from pathlib import Path

from comparison import methods, plots
from comparison.bench import Bench
from comparison.cases import Inputs, Pair
from comparison.drawings import caught_hole, drawings
from comparison.measure import Results
from comparison.tables import excess_and_time, matrix

OURS, PAPERS, ORIGINAL = "IPC", "paper repaired", "Nested Cages 2015"

VERY_COARSE = "5: a very coarse mesh"
FIGURES = {
    "1: the A": "letter A",
    "2: a square with a hole": "octagon with a hole in a square with a hole",
    "3: a disc with a hole": "disc with a hole in an octagon",
    "4: a hole left out": "disc with two holes, one covered",
}
"""Figure -> our drawing of it; the fifth has one of its own."""

PAPERS_OWN = {
    "1: the A": "the paper's A",
    "2: a square with a hole": "the paper's octagon",
    "4: a hole left out": "the paper's octagon in a full square",
}
"""Figure -> the paper's meshes, as far as they are published with its program."""


def run(inputs: Inputs, bench: Bench) -> Results:
    """On our drawings."""
    drawn = drawings()
    cases = {figure: drawn[name] for figure, name in FIGURES.items()} | {VERY_COARSE: caught_hole()}
    return run_on(cases, "figures 1 to 5", bench)


def run_on(cases: dict[str, Pair], experiment: str, bench: Bench) -> Results:
    """The paper repaired, the original, and ours."""
    chosen = {
        PAPERS: methods.PUBLISHED[PAPERS],
        ORIGINAL: methods.PUBLISHED[ORIGINAL],
        OURS: methods.with_contact(OURS),
    }
    return bench.compare(experiment, cases, chosen)


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """The panes, and what became of each."""
    plots.panes(found, pictures / "figures-1-5.png")
    return "\n\n".join([
        "## Figures 1 to 5 of the paper",
        "Our drawings of the same situations; `--paper FOLDER` draws the paper's own meshes, elsewhere. Fine mesh "
        "(filled), coarse mesh (dashed), cage. The paper's figure 5 shows a flow that does not get inside a very "
        "coarse mesh, as its own may not and that of 2015.",
        "![Figures 1 to 5](figures-1-5.png)",
        matrix("figure", list(next(iter(found.values()))), found, excess_and_time),
    ])  # fmt: skip


def finding(found: Results, inputs: Inputs) -> str:
    """How many each method solves."""
    told = [f"{name} {sum(runs[name].success for runs in found.values())}" for name in (PAPERS, ORIGINAL, OURS)]
    stuck = [name for name in (PAPERS, ORIGINAL, OURS) if found[VERY_COARSE][name].failed == "flow"]
    return (
        f"**Figures 1 to 5.** Solved of {len(found)}: {', '.join(told)}. On figure 5 the flow does not get inside "
        f"with: {', '.join(stuck) or 'none'}."
    )
