"""Which of the shapes of the paper's figures does each method solve, and how does it fail on the others?"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from comparison import methods, plots
from comparison.bench import Bench
from comparison.cases import Inputs
from comparison.drawings import drawings
from comparison.measure import DEFAULT, Measurement, Method, Results, Wanted, measure, measure_default
from comparison.tables import count, excess_and_time, matrix
from nestedcages_core import Mesh
from nestedcages_core.published.settings import SIMPLE_2022


def run(inputs: Inputs, bench: Bench) -> Results:
    """Everything on our drawings of them."""
    return bench.compare("figures", drawings(), whole_methods())


def whole_methods() -> dict[str, Method]:
    """Published methods, ours with every contact, and the program as it is."""
    ours = {name: methods.with_contact(name) for name in methods.CONTACTS}
    return {methods.LEVEL_SETS: measure_level_set} | methods.PUBLISHED | ours | {DEFAULT: measure_default}


def measure_level_set(fine: Mesh, coarse: Wanted) -> Measurement:
    """Simple nested cages, which makes its own coarse mesh, of as many vertices."""
    assert isinstance(coarse, Mesh)
    return measure(SIMPLE_2022, fine, len(coarse.vertices))


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """A picture of every run."""
    names = list(next(iter(found.values())))
    plots.gallery(found, names, pictures / "figures.png")
    return "\n\n".join([
        "## The shapes of the paper's figures",
        "Our own drawings of them: a letter A, an octagon with a hole in a square with a hole, discs in coarser and "
        "coarser annuli, a hole that the coarse mesh does not have, two components in one loop. "
        "`--paper FOLDER` does the same for the paper's own meshes, elsewhere.",
        matrix("shape", names, found, excess_and_time),
        "Fine mesh (filled), coarse mesh (dashed), cage:",
        "![Figures](figures.png)",
    ])  # fmt: skip


def kind_of_failure(result: Measurement) -> str:
    """What went wrong in words that several runs can share."""
    if result.success:
        return "succeeds"
    if result.out_of_time:
        return "out of time"
    if result.failed == "flow":
        return "the flow does not end (the program loops)"
    if "infinite" in result.problem or result.excess is None:
        return "an infinite energy throws the meshes (the program crashes or goes on)"
    if result.failed == "reinflation":
        if result.certified:
            return "the fine mesh rests short of its target (the program does not notice)"
        return "the fine mesh rests short of its target and sticks out of the cage (the program does not notice)"
    return "the animation is not free of crossings" if result.certified else "the cage does not enclose the shape"


def failures(found: Results, name: str) -> str:
    """How often a method ends in which way."""
    kinds = Counter(kind_of_failure(shape[name]) for shape in found.values())
    return "; ".join(f"{kind}: {times}" for kind, times in kinds.most_common())


def finding(found: Results, inputs: Inputs) -> str:
    """Robustness on the figures, and the ways of failing."""
    return (
        f"**Robustness on the figures.** Of the {len(found)} shapes the paper as written: "
        f"{failures(found, 'paper as written')}. Repaired: {failures(found, 'paper repaired')}. "
        + "; ".join(f"{name} succeeds on {count(found, name)}" for name in methods.CONTACTS)
        + "."
    )
