"""What does each repair and each improvement do, when the paper is turned into ours one step at a time?"""

from __future__ import annotations

import statistics
from itertools import pairwise
from pathlib import Path

from comparison import methods, plots
from comparison.bench import Bench
from comparison.cases import COUNT, Inputs, disc, on_curve
from comparison.drawings import drawings
from comparison.measure import Measurement, Results
from comparison.tables import excess_and_time, number, table

DISCS = (32, 128)
LIMIT = 10.0  # CPU seconds of a run: most of the paper's come to their end
SHAPES = ("disc_64", "glyph_g", "blob_500", "glyph_B")
DRAWINGS = {
    "octagon": "octagon with a hole in a square with a hole",
    "pentagon": "disc with a hole in a pentagon",
    "letter A": "letter A",
}
"""Short name -> drawing."""


def run(inputs: Inputs, bench: Bench) -> Results:
    """Every step on discs, drawings and a few shapes of the folder."""
    cases = {f"annulus {n}": disc(n) for n in DISCS}
    cases |= {name: drawings()[drawing] for name, drawing in DRAWINGS.items()}
    cases |= on_curve(inputs.shapes, SHAPES)
    chosen = {method.name: method.settings for method in methods.LADDER}
    return bench.compare("staircase", cases, chosen, limit=LIMIT)


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """The staircase over all shapes, then shape by shape."""
    plots.staircase(found, pictures / "staircase.png")
    names = [method.name for method in methods.LADDER]
    solved = [shape for shape in found if all(found[shape][name].ended for name in names)]
    lines = []
    for place, name in enumerate(names):
        runs = [shape[name] for shape in found.values()]
        gone = [found[shape][name] for shape in solved]
        lines.append([
            str(place), name, f"{sum(run.success for run in runs)} of {len(runs)}",
            f"{sum(run.certified for run in runs)}", f"{sum(run.short == 0.0 for run in runs)}",
            f"{sum(run.failed == 'flow' for run in runs)}",
            number(statistics.geometric_mean(run.total for run in gone) if gone else None, ".3f"),
            number(statistics.mean(run.excess for run in gone) if gone else None),
            str(sum(run.iterations for run in gone)),
        ])  # fmt: skip
    by_shape = [[name, *(excess_and_time(found[shape][name]) for shape in found)] for name in names]
    return "\n\n".join([
        "## From the paper to ours, one improvement at a time",
        "Every row keeps the changes of those above it; all are objects in `Settings`, listed in "
        "`benchmarks/comparison/methods.py`. *Certified*: cages that strictly enclose the fine mesh at home, whether "
        "or not that returned. Times, excess and iterations are over the "
        f"{len(solved)} shapes on which every row ends with such a cage in time: {', '.join(solved) or 'none'}; the "
        "times are geometric means.",
        table(["", "method", "success", "certified", "returned", "flow stuck", "s", "mean excess %", "iterations"],
              lines),
        "Excess and time where a row succeeded; otherwise ✗ and the phase that failed, and in brackets the excess of "
        "the cage that it left, if that encloses the fine mesh:",
        table(["method", *found], by_shape),
        "![From the paper to ours](staircase.png)",
        f"Shapes of the folder have {COUNT} coarse vertices on their curves; a run is ended after {LIMIT:.0f} s. "
        "Without a safe step filter nothing bounds what happens between two steps; the certificate of the motion says "
        "whether it went well.",
    ])  # fmt: skip


def finding(found: Results, inputs: Inputs) -> str:
    """What every row changes, where it and the row before succeeded or at least ended with a cage."""
    changes: dict[str, list[tuple[Measurement, Measurement]]] = {}
    for shape in found.values():
        for (_, before), (name, after) in pairwise(shape.items()):
            changes.setdefault(name, []).append((before, after))
    told = []
    for name, pairs in changes.items():
        both = [(a, b) for a, b in pairs if a.ended and b.ended]
        gained = sum(b.success and not a.success for a, b in pairs)
        lost = sum(a.success and not b.success for a, b in pairs)
        parts = [f"{gained} more succeed" if gained else "", f"{lost} no longer succeed" if lost else ""]
        if both:
            parts.append(f"time × {statistics.geometric_mean(b.total / a.total for a, b in both):.2g}")
            same = all(a.excess == b.excess for a, b in both)
            points = statistics.mean(b.excess - a.excess for a, b in both)
            parts.append(f"the same excess on all {len(both)}" if same else f"excess {points:+.2f} points")
        told.append(f"*{name.removeprefix('+ ')}*: " + ", ".join(part for part in parts if part))
    return (
        "**Each improvement**, against the row before it, where both end in time with a cage that encloses the shape, "
        "home or not (geometric mean of the times, "
        "mean of the changes of excess): "
        + "; ".join(told)
        + ". Exact return turns almost every failure of the reinflation into a success, the two-sided flow those "
        "of the flow; projected Newton gives most of the speed, local ranges and the tightening most of the tightness. "
        "Infinite energies matter only where a reinflation begins with a contact or a crossing, or parity takes its "
        "start for one; a flow that ends by the test that the energy begins with does not lead there."
    )
