"""How robust are the methods on shapes that nobody chose?"""

from __future__ import annotations

import re
import statistics
from pathlib import Path

from comparison import methods, plots
from comparison.bench import Bench
from comparison.cases import MOST_RANDOM_VERTICES, VERTICES_PER_COARSE, Inputs, random_cases
from comparison.experiments.figures import failures, whole_methods
from comparison.measure import DEFAULT, Results
from comparison.tables import count, median, number, table

LIMIT = 6.0  # CPU seconds of a run
SHOWN = 8  # shapes in the picture


def run(inputs: Inputs, bench: Bench) -> Results:
    """Published methods, the paper with Newton, ours with every contact, and the program as it is."""
    chosen = whole_methods() | {"paper, Newton": methods.NEWTON}
    cases = random_cases(inputs.sizes.random, inputs.sizes.first_seed)
    return bench.compare("random shapes", cases, chosen, limit=LIMIT)


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """How every method ends, and the shapes on which one of ours does not succeed."""
    names = list(next(iter(found.values())))
    solved = [run for run in found.values() if all(run[name].certified for name in names)]
    hardest = sorted(found, key=lambda shape: sum(run.success for run in found[shape].values()))
    plots.gallery({shape: found[shape] for shape in hardest[:SHOWN]}, names, pictures / "random.png")
    lines = []
    for name in names:
        runs = [shape[name] for shape in found.values()]
        good = [run for run in runs if run.success]
        lines.append([
            name, count(found, name), str(sum(run.failed in ("decimation", DEFAULT) for run in runs)),
            str(sum(run.failed == "flow" for run in runs)), str(sum(run.failed == "reinflation" for run in runs)),
            str(sum(run.out_of_time for run in runs)), str(sum(not run.failed and not run.success for run in runs)),
            number(median(run.total for run in good), ".3f"), number(median(run.excess for run in good)),
            number(median(run[name].total for run in solved), ".3f"),
            number(median(run[name].excess for run in solved)),
        ])  # fmt: skip
    lost = [
        f"* {shape}, {name}: {run[name].problem}"
        for shape, run in found.items()
        for name in (*methods.CONTACTS, DEFAULT)
        if not run[name].success
    ]
    seeds = ", ".join(re.sub(r"\D", "", shape) for shape in found)
    return "\n\n".join([
        "## Random shapes",
        f"{len(found)} shapes of ten kinds (stars, blobs, combs, spirals, coasts, glyphs, discs, islands, needles, "
        f"slits) from `benchmarks/random_shapes.py`, with at most {MOST_RANDOM_VERTICES} vertices, gaps down to a "
        "millionth of their size, turned and scaled by up to a million; coarse meshes on the curve with a vertex for "
        f"every {VERTICES_PER_COARSE}. Seeds from {inputs.sizes.first_seed} on, those that draw no valid shape of "
        f"this size passed over: {seeds}. A run is ended after {LIMIT:.0f} s. No method falls back on another start, "
        f"but *{DEFAULT}*: that is the program as it is, without settings, which tries contacts in turn and the outer "
        "hull at last.",
        table(["method", "success", "no start", "flow fails", "reinflation fails", "of these out of time", "refuted",
               "median s", "median excess %", "shared: s", "shared: excess %"], lines),
        "*No start*: refused before anything moved; *refuted*: the run ended well, but a certificate says no. Medians "
        "are over a method's own successes, and, as *shared*, over the "
        f"{len(solved)} shapes on which every method leaves a cage that encloses the shape, home or not. "
        + ("Where one of ours did not succeed:\n\n" + "\n".join(lost) if lost else "Ours always succeeded."),
        f"The {min(SHOWN, len(found))} shapes that fewest methods solve:",
        "![Random shapes](random.png)",
    ])  # fmt: skip


def finding(found: Results, inputs: Inputs) -> str:
    """Who survives what."""
    both = [s for s in found.values() if s["paper repaired"].success and s["IPC"].success]
    text = f"**Robustness on {len(found)} random shapes.** " + "; ".join(
        f"{name} succeeds on {count(found, name)}" for name in next(iter(found.values()))
    )
    text += f". The paper as written: {failures(found, 'paper as written')}."
    if both:
        ratio = statistics.geometric_mean(s["paper repaired"].total / s["IPC"].total for s in both)
        text += (
            f" Where both the repaired paper and ours with IPC succeed ({len(both)} shapes), ours takes {ratio:.0f} "
            f"times less time, and its excess is {median(s['IPC'].excess for s in both):.1f} % instead of "
            f"{median(s['paper repaired'].excess for s in both):.1f} % in the median."
        )
    return text
