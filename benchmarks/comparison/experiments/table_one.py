"""Does the paper as written do what the paper's program did, and how far from it are the contacts?"""

from __future__ import annotations

import statistics
from pathlib import Path

from comparison import methods, plots
from comparison.bench import Bench
from comparison.cases import Inputs, disc
from comparison.measure import REPEATS, Results
from comparison.tables import number, table

PUBLISHED = ("Nested Cages 2015", "2015 by programs", "paper as written")
LIMIT = 60.0  # CPU seconds: the paper as written is to come to its end here


def run(inputs: Inputs, bench: Bench) -> Results:
    """The paper as written and ours with every contact, on the discs of Table 1."""
    chosen = {name: methods.PUBLISHED[name] for name in PUBLISHED}
    chosen |= {name: methods.with_contact(name) for name in methods.CONTACTS}
    cases = {str(row.fine_vertices): disc(row.fine_vertices) for row in inputs.table1}
    return bench.compare("table 1", cases, chosen, repeats=REPEATS, limit=LIMIT)


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """The table beside the paper's own."""
    plots.table1(found, inputs.table1, pictures / "table1.png")
    names = list(next(iter(found.values())))
    headings = ["fine", "C++ excess %", "C++ s"]
    for name in names:
        headings += [f"{name} %", "s"]
    lines = []
    for row in inputs.table1:
        cells = [str(row.fine_vertices), number(row.reference_excess, ".1f"), number(row.reference_seconds)]
        for name in names:
            result = found[str(row.fine_vertices)][name]
            mark = "" if result.success else " ✗"
            cells += [number(result.excess) + mark, number(result.total, ".3f")]
        lines.append(cells)
    return "\n\n".join([
        "## Table 1 of the paper",
        "Annuli in an annulus of 16 + 16 vertices. ✗: no success, though there may be a cage; the reasons are in "
        "runs.csv.",
        table(headings, lines), "![Table 1](table1.png)",
    ])  # fmt: skip


def finding(found: Results, inputs: Inputs) -> str:
    """Fidelity, speed, tightness."""
    runs = [(row, found[str(row.fine_vertices)]) for row in inputs.table1]
    known = [(row, run) for row, run in runs if row.reference_excess]
    gaps = [
        abs(run["paper as written"].excess - row.reference_excess)
        for row, run in known
        if run["paper as written"].excess is not None
    ]
    short = [run["paper as written"].short for _, run in runs if run["paper as written"].short is not None]
    certified = [sum(run[name].success for _, run in runs) for name in methods.CONTACTS]
    text = (
        "**Fidelity.** "
        + (
            f"On {len(gaps)} of {len(runs)} rows of Table 1 the paper as written ends with a cage, and its excess is "
            f"within {max(gaps):.2f} points of the C++ program's. "
            if gaps
            else ""
        )
        + f"As there, the fine mesh never quite returns: it rests {min(short):.0e} to {max(short):.0e} diagonals "
        "short of it, which the C++ program passes over and which is an error here. Certified of the "
        f"{len(runs)} rows: "
        + ", ".join(f"{name} {count}" for name, count in zip(methods.CONTACTS, certified, strict=True))
        + "."
    )
    faster = [row.reference_seconds / run["IPC"].total for row, run in known]
    above = [run["IPC"].excess - row.optimum_excess for row, run in known if row.optimum_excess]
    if faster and above:
        text += (
            f" Ours with IPC takes {statistics.geometric_mean(faster):.0f} times less time than the C++ program in the "
            f"geometric mean and {min(faster):.0f} times at the least, without the certificate, which "
            f"`benchmarks/table1.py` counts; it ends {min(above):+.2f} to {max(above):+.2f} points from the "
            "optimum on record for this split of the vertices (negative: tighter)."
        )
    return text
