"""Which of the shapes of the paper's figures does each method solve, and how does it fail on the others?"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from comparison import methods, plots
from comparison.cases import Inputs
from comparison.measure import DEFAULT, Measurement, Results, compare, measure, measure_default
from comparison.tables import count, excess_and_time, folded, matrix


def run(inputs: Inputs) -> Results:
    """The paper as written, repaired, and ours with every contact."""
    chosen = methods.PUBLISHED | {name: methods.with_contact(name) for name in methods.CONTACTS}
    found = compare("figures", inputs.figures, chosen)
    for shape, pair in inputs.figures.items():
        fine, coarse = pair
        level_set = measure(methods.SIMPLE, fine, len(coarse.vertices))
        found[shape] = {methods.LEVEL_SETS: level_set, **found[shape], DEFAULT: measure_default(*pair)}
    return found


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """A picture of every run."""
    names = list(next(iter(found.values())))
    plots.gallery(found, names, pictures / "figures.png")
    return "\n\n".join([
        "## The shapes of the paper's figures",
        "Our own drawings of them: a letter A, an octagon with a hole in a square with a hole, discs in coarser and "
        "coarser annuli, a hole that the coarse mesh does not have, two components in one loop; and, where the folder "
        "has them, the paper's own A and octagon.",
        matrix("shape", names, found, excess_and_time),
        "Fine mesh (filled), coarse mesh (dashed), cage:",
        "![Figures](comparison/figures.png)", folded(found),
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
