"""The comparison written down: tables and sentences, every number from the measurements."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Iterable, Sequence

import numpy as np
import scipy

from comparison.discussion import discussion
from comparison.experiments import COUNT, TABLE_1_LIMIT
from comparison.findings import Findings, share
from comparison.measure import CLEARANCE, LIMIT, Measurement
from data import Table1Row

COMMAND = "python benchmarks/compare.py --data ../shared/data"


def table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def number(value: float | None, form: str = ".2f") -> str:
    """A number, or a dash where there is none."""
    return "–" if value is None or not np.isfinite(value) else format(value, form)


def answer(value: bool | None) -> str:
    """Yes, no, or a dash."""
    return "–" if value is None else ("yes" if value else "**no**")


def row(name: str, result: Measurement) -> list[str]:
    """One run in the columns of COLUMNS."""
    home = "–" if result.short is None else ("yes" if result.short == 0.0 else f"**{result.short:.0e} short**")
    phases = [number(result.seconds.get(phase), ".3f") for phase in PHASES]
    return [
        name, answer(result.success), number(result.excess), number(result.smallest, ".0e"), home,
        answer(result.free), answer(result.certified) if result.cage is not None else "–",
        str(result.flow_steps), str(result.iterations), *phases, number(result.total, ".3f"),
    ]  # fmt: skip


PHASES = ("flow", "reinflation", "tightening")
COLUMNS = (
    "method", "success", "excess %", "distance", "fine home", "crossing-free", "encloses", "flow steps",
    "iterations", *(f"{phase} s" for phase in PHASES), "total s",
)  # fmt: skip


def runs(results: dict[str, Measurement]) -> str:
    """The table of one shape, with what went wrong below it."""
    problems = [f"* {name}, {result.failed}: {result.problem}" for name, result in results.items() if result.problem]
    return "\n".join([table(COLUMNS, (row(*item) for item in results.items())), "", *problems, ""])


def document(found: Findings, rows: tuple[Table1Row, ...]) -> str:
    """The whole document."""
    parts = [
        *_preface(found), *_table1(found, rows), *_ladder(found), *_figures(found), *_starts(found), *_alone(found),
        *_filters(found), *_energies(found), *discussion(found, rows),
    ]  # fmt: skip
    return "\n\n".join(parts) + "\n"


def _preface(found: Findings) -> list[str]:
    return [
        "# The methods side by side",
        f"Everything here was printed by `{COMMAND}`, from the project's root, in {found.seconds / 60.0:.1f} minutes: "
        f"every number, table and plot. Python {platform.python_version()}, numpy {np.__version__}, scipy "
        f"{scipy.__version__}, {os.cpu_count()} cores, one thread, {sys.platform}. Times are CPU seconds; compare "
        "ratios. The methods are objects in `Settings`; the table of them is `benchmarks/comparison/methods.py`.",
        "**Success** means all of it: the cage encloses the fine mesh strictly, by exact predicates, does not touch "
        "itself and keeps its loops; the fine mesh stands at home to the last bit; and the animation is certified free "
        "of crossings between any two of its steps. *Excess* is area(cage) / area(fine) - 1. Lengths are in "
        f"bounding-box diagonals of the fine mesh; the clearance asked for is {CLEARANCE:.0e}. Where a phase fails, "
        f"the excess is that of the last cage reached. A run is ended after {LIMIT:.0f} s ({TABLE_1_LIMIT:.0f} s on "
        "Table 1). *Iterations* are those of the reinflation: descent or Newton steps, or systems solved within "
        "quadratic programs.",
    ]


def _table1(found: Findings, rows: tuple[Table1Row, ...]) -> list[str]:
    names = list(next(iter(found.table1.values())))
    headings = ["fine", "C++ excess %", "C++ s"]
    for name in names:
        headings += [f"{name} %", "s"]
    lines = []
    for line in rows:
        cells = [str(line.fine_vertices), number(line.reference_excess, ".1f"), number(line.reference_seconds)]
        for name in names:
            result = found.table1[str(line.fine_vertices)][name]
            cells += [number(result.excess), number(result.total, ".3f")]
        lines.append(cells)
    return ["## Table 1 of the paper", table(headings, lines), "![Table 1](comparison/table1.png)"]


def _ladder(found: Findings) -> list[str]:
    parts = [
        "## From the paper to ours, one improvement at a time",
        "Every line keeps the changes of those above it. Without a safe step filter nothing bounds what happens "
        "between two steps; the certificate says whether it went well.",
        "![From the paper to ours](comparison/ladder.png)",
    ]
    for shape, results in found.ladder.items():
        parts += [f"### {shape}", runs(results)]
    return parts


def _figures(found: Findings) -> list[str]:
    parts = [
        "## The shapes of the paper's figures",
        "Our own drawings of them: a letter A, an octagon with a hole in a square with a hole, discs in coarser and "
        "coarser annuli, a hole that the coarse mesh does not have, two components in one loop.",
        "![Figures](comparison/figures.png)",
    ]
    for shape, results in found.figures.items():
        parts += [f"### {shape}", runs(results)]
    return parts


def _starts(found: Findings) -> list[str]:
    if not found.starts:
        return []
    parts = [
        f"## Contacts and starts, {COUNT} vertices",
        "*flow* starts from vertices on the curve and needs the flow; *outer hull* and *level set* enclose the shape "
        "already, so that only the tightening works. The velocity filter expands without an energy. Decimation is "
        "part of the total.",
        "![Contacts and starts](comparison/starts.png)",
    ]
    for shape, results in found.starts.items():
        parts += [f"### {shape}", runs(results)]
    return parts


def _alone(found: Findings) -> list[str]:
    parts = [
        "## What each contact reaches by itself",
        "The same, with the area as energy all the way and no tightening afterwards. Sequential QPs do not know an "
        "energy: they only clear the way. The velocity filter stops at its proximity, IPC where its barrier balances "
        "the area.",
    ]
    for shape, results in found.alone.items():
        parts += [f"### {shape}", runs(results)]
    return parts


def _filters(found: Findings) -> list[str]:
    parts = ["## Step filters, broad phases, and reuse", "IPC with each of them."]
    for shape, results in found.filters.items():
        parts += [f"### {shape}", runs(results)]
    lines = [
        [shape, str(cost.builds), number(cost.building, ".4f"), number(cost.reinflation, ".4f"), f"{share(cost):.0f}"]
        for shape, cost in found.reuse.items()
    ]
    parts += [
        "The paper suggests to reuse the structure of a flow step when reinflation returns to it. What that could save "
        "at the most is the building of lists of pairs:",
        table(["shape", "lists built", "building s", "reinflation s", "share %"], lines),
    ]
    return parts


def _energies(found: Findings) -> list[str]:
    parts = [
        "## Energies",
        "On the way home and in the final pass, on the letter A.",
        "![Energies](comparison/energies.png)",
    ]
    for results in found.energies.values():
        parts.append(runs(results))
    return parts
