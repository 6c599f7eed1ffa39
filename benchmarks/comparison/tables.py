"""Tables in Markdown, every number from the file of runs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from comparison import methods
from comparison.runs import Run, by_shape, methods_of, of, shared
from comparison.shapes import FIGURES, GLYPHS, HELD_OUT, RANDOM
from comparison.statistics import Paired
from data import Table1Row

FAMILIES = (RANDOM, GLYPHS, HELD_OUT)


def table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def number(value: float | None, form: str = ".2f") -> str:
    """A number, or a dash where there is none."""
    return "–" if value is None or not np.isfinite(value) else format(value, form)


def quartiles(values: Iterable[float | None], form: str = ".1f") -> str:
    """Median, and in brackets both quartiles, of those that are there."""
    known = [value for value in values if value is not None]
    if not known:
        return "–"
    low, middle, high = np.percentile(known, [25.0, 50.0, 75.0])
    return f"{middle:{form}} ({low:{form}}–{high:{form}})"


def solved(runs: Sequence[Run], flag: str = "success") -> str:
    """How many runs succeed, or enclose."""
    return f"{sum(getattr(run, flag) for run in runs)} of {len(runs)}"


def contacts(runs: Sequence[Run], start: str) -> str:
    """Contacts and ranges from a start: medians and quartiles of the shapes that all contacts solve."""
    own = of(runs, "contacts", start=start)
    rows = [row for row in shared(own, methods.CELLS) if all(run.tightened is not None for run in row.values())]
    lines = []
    for name in methods.CELLS:
        mine = [row[name] for row in rows]
        lines.append([
            name, *(solved([run for run in own if run.method == name and run.family == family]) for family in FAMILIES),
            quartiles(run.excess for run in mine), quartiles((run.tightened for run in mine), ".2f"),
            quartiles(1e3 * run.seconds for run in mine if run.seconds is not None),
            number(float(np.median([run.distance or 0.0 for run in mine])) if mine else None, ".0e"),
        ])  # fmt: skip
    return table(["contact, d̂", *FAMILIES, "excess %", "tightened %", "ms", "distance left"], lines)


def whole(runs: Sequence[Run], start: str) -> str:
    """Whole methods from a start by family; excess and time of the shapes that all solve."""
    own = of(runs, "methods", start=start)
    names = methods_of(own)
    rows = shared(own, names)
    lines = []
    for name in names:
        mine = [run for run in own if run.method == name]
        lines.append([
            name, *(solved([run for run in mine if run.family == family]) for family in FAMILIES),
            solved(mine, "encloses"), quartiles(row[name].excess for row in rows),
            quartiles((row[name].seconds for row in rows), ".3f"),
        ])  # fmt: skip
    return table(["method", *FAMILIES, "cage encloses", f"excess %, {len(rows)} shapes", "s"], lines)


def tests(found: dict[str, list[Paired | None]]) -> str:
    """Paired tests on both kinds of shapes."""
    rows = [(name, *("" if test is None else test.text for test in both)) for name, both in found.items()]
    return table(["", "known shapes", "held-out shapes"], rows)


def table_1(runs: Sequence[Run], reference: Sequence[Table1Row]) -> str:
    """Table 1: excess and seconds of the paper, its program on our machine, and others; next to the optimum."""
    rows = {run.shape: by_shape([r for r in of(runs, "table 1") if r.shape == run.shape]).popitem()[1]
            for run in of(runs, "table 1")}  # fmt: skip
    names = methods_of(of(runs, "table 1"))
    lines = []
    for known in reference:
        found = rows.get(str(known.fine_vertices))
        if found is not None:
            lines.append([
                str(known.fine_vertices), number(known.optimum_excess), number(known.reference_excess, ".1f"),
                *(number(found[name].excess) for name in names), number(known.paper_seconds),
                number(known.reference_seconds), *(number(found[name].seconds, ".3f") for name in names),
            ])  # fmt: skip
    heads = ["fine", "optimum %", "C++ %", *(f"{name} %" for name in names), "paper s", "C++ s"]
    return table([*heads, *(f"{name} s" for name in names)], lines)


def by_drawing(runs: Sequence[Run], experiment: str, *, family: str = FIGURES) -> str:
    """Rows of methods, columns of drawings: excess and time, how far F ends from home, or the phase that failed."""
    own = of(runs, experiment, family)
    drawings = list(dict.fromkeys(run.shape for run in own))
    found = {(run.method, run.shape): run for run in own}
    lines = [[name, *(_cell(found[name, drawing]) for drawing in drawings)] for name in methods_of(own)]
    return table(["", *drawings], lines)


def flows(runs: Sequence[Run]) -> str:
    """Flows that get inside, and their steps on the shapes that all enter."""
    own = of(runs, "flows")
    rows = shared(own, methods_of(own))
    lines = []
    for name in methods_of(own):
        mine = [run for run in own if run.method == name]
        lines.append([name, *(solved([run for run in mine if run.family == family]) for family in FAMILIES),
                      quartiles((float(row[name].flow_steps) for row in rows), ".0f")])  # fmt: skip
    return table(["flow", *FAMILIES, "steps"], lines)


def energies(runs: Sequence[Run]) -> str:
    """Excess and asymmetry of the final cage by energy."""
    rows = by_shape(of(runs, "energies"))
    lines = []
    for name in methods_of(of(runs, "energies")):
        mine = {row[name].shape: row[name] for row in rows.values() if name in row}
        mirrored = [number(run.asymmetry, ".0e") for run in mine.values() if run.asymmetry is not None]
        lines.append([name, *(number(run.excess, ".1f") for run in mine.values()), *mirrored])
    drawn = [run.shape for run in of(runs, "energies") if run.method == "area"]
    return table(["energy", *(f"{name} %" for name in drawn), "asymmetry: letter A", "star"], lines)


def _cell(run: Run) -> str:
    left = f"{number(run.excess, '.1f')} %"
    if run.success:
        return f"{left} · {number(run.seconds)} s"
    if run.encloses and run.short:
        return f"{left}, {run.short:.0e} short"
    return f"✗ {run.failed or 'not certified'}" + (f" ({left})" if run.encloses else "")
