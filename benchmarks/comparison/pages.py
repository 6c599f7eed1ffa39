"""The pages, from the file of runs and what is said of the machine: nothing here runs a method."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from comparison import conclusions, methods, tables
from comparison.conclusions import Verdict
from comparison.figures import FIGURES
from comparison.held_out import sources as held_out_sources
from comparison.measure import CLEARANCE, LIMIT, REPEATS, SHORT
from comparison.runs import Run
from comparison.statistics import LEVEL, RESAMPLES
from comparison.tables import table
from data import HELD_OUT_SHAPES, PROGRAM, read_table1

Judged = dict[conclusions.Conclusion, tuple[Verdict, Verdict]]
"""Verdicts on known and held-out shapes."""
COMMAND = "python benchmarks/compare.py"
RUNS, RECORD = "runs.csv", "results.json"

QUOTE = (
    "*The main limitation of our work is a lack of critical comparison of the performance and robustness differences "
    "between our method and the original method*, Gurditta and Jacobson (2022) write. This page compares their method, "
    "that of Sacht et al. (2015), IPC as published (Li et al. 2020) and ours, with one exact certificate for all."
)
DESIGN = (
    "Every method and contact gets the same coarse meshes of three kinds, *starts*: edge collapse, as in 2015; evenly "
    "spaced vertices; and our line cycles put on the curve. Barriers have several ranges d̂. Tests are paired by "
    "shape and "
    "corrected for their number (Holm); a conclusion has to pass all of its gates, from each start, on both sets of "
    "shapes."
)
CHOOSE = (
    ("cages for use, or from a coarse mesh of your own", "the default"),
    ("an animation that keeps its distance throughout", "`IPC()`: the largest gaps among the fast ones"),
    ("a symmetric or evenly deformed cage", "another energy, such as `ShapeKeeping()`"),
    ("the paper's method", "`AUGMENTED_2022`, `AUGMENTED_2022_REPAIRED`; the others' are in `benchmarks/published`"),
)
LIMITS = (
    "In the plane. In space, broad phases and collision detection cost more, and impulses meet harder cases.",
    "One code base in Python for all: times compare algorithms. Only the discs have times of the authors' program.",
    "Where El Topo gives up, the original goes on with asynchronous contact mechanics and rigid impact zones; here the "
    "run counts as a failure. Its descent has 100 steps here, and no cap there.",
    "All shapes are chosen by us: ten random generators and three fonts; the held-out ones at random from packages. "
    "Where "
    "runs are few, a gate that is not passed says little.",
    "The method of 2022 by gradient descent, as written, runs from one start and with its own range alone.",
)


def write(runs: Sequence[Run], record: dict[str, Any], out: Path) -> None:
    """All pages into a folder."""
    (out / "comparison").mkdir(parents=True, exist_ok=True)
    for name, text in pages(runs, record).items():
        (out / name).write_text(text, encoding="utf-8")


def pages(runs: Sequence[Run], record: dict[str, Any]) -> dict[str, str]:
    """File name -> text."""
    judged = conclusions.verdicts(runs)
    return {
        "comparison.md": front(judged, record),
        "comparison/contacts.md": _page("Contacts from the same starts", record, _contacts(runs, judged)),
        "comparison/methods.md": _page("Whole methods", record, _methods(runs, judged)),
        "comparison/as-published.md": _page("The paper's program, figures and table", record, _published(runs)),
        "comparison/flows.md": _page("Flows and energies", record, _flows(runs)),
        "comparison/measured.md": _page("How it was measured", record, _measured(runs, record)),
    }


def front(judged: Judged, record: dict[str, Any]) -> str:
    """Three conclusions, a picture each, and what to choose."""
    parts = ["# The methods compared", QUOTE, DESIGN]
    for k, (conclusion, (known, held_out)) in enumerate(judged.items(), 1):
        parts += [
            f"## {k}. {conclusion.claim}",
            said(known, held_out),
            f"![{conclusion.caption}](comparison/{conclusion.picture})",
            f"[All tables and tests](comparison/{conclusion.page})",
        ]
    parts += [
        "## What to choose",
        table(["for", "choose"], CHOOSE),
        "## Limits",
        _list(LIMITS),
        "## More",
        "[Contacts](comparison/contacts.md) · [whole methods](comparison/methods.md) · [the paper's program, figures "
        "and table](comparison/as-published.md) · [flows and energies](comparison/flows.md) · [how it was measured]"
        f"(comparison/measured.md) · [every run](comparison/{RUNS}). References: [Method](method.md). {stamp(record)}.",
    ]
    return "\n\n".join(parts) + "\n"


def said(known: Verdict, held_out: Verdict) -> str:
    """The numbers on both kinds of shapes, and the gates that contradict the claim."""
    numbers = [(name, value, held_out.numbers.get(name, "")) for name, value in known.numbers.items()]
    gates = (
        "yes" if verdict.holds else "**not shown by these runs**: " + "; ".join(verdict.failed)
        for verdict in (known, held_out)
    )
    return table(["", "known shapes", "held-out shapes"], [*numbers, ("holds", *gates)])


def stamp(record: dict[str, Any]) -> str:
    """What all numbers are of."""
    return f"Measured at commit {record['commit']}, {record['date']}"


def _page(title: str, record: dict[str, Any], parts: Sequence[str]) -> str:
    links = f"[The methods compared](../comparison.md). {stamp(record)}."
    return "\n\n".join([f"# {title}", links, *(part for part in parts if part)]) + "\n"


def _contacts(runs: Sequence[Run], judged: Judged) -> list[str]:
    return [
        "Every contact gets the same coarse mesh and the same steps of the two-sided flow, lowers the area as it goes "
        "(sequential QPs have no energy), and then gets the same tightening at the same clearance. Medians and "
        "quartiles "
        "of the shapes that all solve; time of the reinflation alone. *Distance left*: median of the smallest distance "
        "after reinflation.",
        *(f"## From {start}\n\n{tables.contacts(runs, start)}" for start in methods.STARTS),
        "The barrier of 2020 adapts its stiffness, so the fine mesh comes close whatever the range. The energy of 2022 "
        "has fixed weights, so its range is its distance.",
        "*IPC, ours*, unlike that of 2020: ranges are local, at most half of the gaps; λ_R grows fourfold where the "
        "fine mesh rests short of its target, and d̂ shrinks to a quarter where a solve is blocked; the block of the "
        "fine mesh is lumped.",
        *_tests(judged, "ranges", "starts"),
    ]


def _methods(runs: Sequence[Run], judged: Judged) -> list[str]:
    return [
        "One coarse mesh and one attempt for every method; *nested_cages* is the default with its fallbacks. Lengths "
        "are "
        "relative to the drawing as on the discs of Table 1. A success is a certified cage, an exact return and a "
        "motion "
        "free of crossings. Excess and time: median and quartiles of the shapes that all methods of a table solve.",
        *(f"## From {start}\n\n{tables.whole(runs, start)}" for start in methods.STARTS),
        *_tests(judged, "original"),
        "*All shapes*: a failure loses against a success. *Both solve*: the shapes that both solve.",
        "## Our drawings of the figures",
        "Rows of methods, excess and time or what failed. *Simple cages* make their own mesh of as many vertices. "
        "*2022 as "
        "written* never returns exactly: the fine mesh ends this many diagonals *short*.",
        tables.by_drawing(runs, "methods"),
        "## From 2022 to ours, one change at a time",
        "Each line includes those above it.",
        tables.by_drawing(runs, "ladder"),
    ]


def _tests(judged: Judged, *names: str) -> list[str]:
    chosen = {c: both for c, both in judged.items() if c.name in names}
    found = {name: [known, held_out.tests.get(name)] for known_, held_out in chosen.values()
             for name, known in known_.tests.items()}  # fmt: skip
    return [
        "## Paired tests",
        "p is corrected for all tests of a conclusion on one set of shapes.",
        tables.tests(found),
    ]


def _published(runs: Sequence[Run]) -> list[str]:
    return [
        "The compiled program of 2022 next to `as_published`, on the meshes of its figures 1 and 2 and on discs of its "
        "Table 1. Lengths are absolute, so excess depends on size. `python benchmarks/paper_program.py` makes the "
        f"table ({PROGRAM.name}), {program_rows()[0]['stamp']}.",
        program_table(),
        "## Table 1",
        "Seconds of flow and reinflation: *paper*, in its Table 1, on a MacBook Air with an M2; *C++*, its program on "
        "one "
        "of our machines; *as written*, `as_published`. The optimum is that for 16 vertices per loop without "
        "clearance, "
        "[proposition 7](../method.md).",
        tables.table_1(runs, read_table1()),
        "## Figures",
        "Start, flow and end by `as_published`, and the end by ours, of our drawings of the figures; `python "
        "benchmarks/paper_pdf.py --meshes FOLDER` draws the paper's own meshes where its program brings them.",
        table(["figure", "what the paper says"], [(figure.title, figure.said) for figure in FIGURES]),
        "![Figures 1 to 5 in three panes by the program, and by ours](figures.png)",
        "## Differences from the programs",
        _list((
            "2022: after 100 steps of the flow the program goes on from an infinite energy; here that is an error.",
            "2015: its samples keep the weights of the undeformed mesh; here they follow the moving one.",
            "Simple cages: 250 cells along the diagonal instead of 50; offsets grow from half a cell, then six "
            "bisections, instead of ten of [0, 0.5]; edge collapse keeps contours simple, instead of a self-union.",
            "IPC 2020 minimises the area of a cage without mass; the Hessian of the area takes its place.",
        )),
    ]  # fmt: skip


def program_rows() -> list[dict[str, str]]:
    """The lines that paper_program.py wrote."""
    with PROGRAM.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def program_table() -> str:
    """The program of 2022 beside `as_published`."""
    lines = []
    for row in program_rows():
        program, ours = float(row["program_excess_percent"]), float(row["ours_excess_percent"])
        lines.append([row["mesh"], f"{program:.3f}", f"{ours - program:+.3f}", f"{float(row['short_diagonals']):.0e}"])
    return table(["mesh", "program %", "difference", "short of home"], lines)


def _flows(runs: Sequence[Run]) -> list[str]:
    return [
        "Algorithm 2 of 2022 weights both edges of a vertex alike; its program divides by their lengths. "
        "*2015* takes up to 1,000 steps of a thousandth. Steps: median and quartiles where every flow gets inside.",
        tables.flows(runs),
        "## Energies",
        "Ours, with another energy in reinflation and tightening. Asymmetry: largest distance of a cage vertex from "
        "the nearest mirrored one, in diagonals.",
        tables.energies(runs),
    ]


def _measured(runs: Sequence[Run], record: dict[str, Any]) -> list[str]:
    return [
        f"`{COMMAND}` made these pages from {len(runs):,} runs in {record['minutes']:.1f} minutes; every number is "
        f"from [runs.csv]({RUNS}). {record['machine']}.",
        _list((
            f"**Time** is CPU time, the median of {REPEATS} runs if below {SHORT:g} s. A run is ended after {LIMIT:g} "
            "s. Certificates are not timed.",
            "**Excess** is area(cage) / area(fine) − 1. Lengths are in bounding-box diagonals of the fine mesh; the "
            f"clearance is {CLEARANCE:.0e} for all.",
            f"**Intervals** in square brackets: {LEVEL:.0f} %, percentile bootstrap over shapes, {RESAMPLES:,} "
            "resamples. **Paired tests**: two-sided sign tests, for flags McNemar's exact test; p after Holm (1979). "
            "Round "
            "brackets: quartiles.",
            "**Families**: *random* (ten kinds, gaps down to a millionth, any size), *glyphs* (three fonts) and *held "
            "out*, which took no part in tuning.",
            f"**Check**: `{COMMAND} --check`, part of `make lint`, compares the pages with runs.csv and repeats a "
            "sample of the runs, on shapes with one optimum.",
        )),
        "## Held-out shapes",
        f"In `benchmarks/data/{HELD_OUT_SHAPES.name}`, each with source and licence, chosen at random by "
        "`benchmarks/held_out_shapes.py`. They keep these licences.",
        table(["package", "family", "shapes", "licence"], held_out_sources()),
    ]  # fmt: skip


def _list(items: Sequence[str]) -> str:
    return "\n".join(f"* {item}" for item in items)


def read_record(folder: Path) -> dict[str, Any]:
    """What is said of the machine and the commit."""
    record: dict[str, Any] = json.loads((folder / RECORD).read_text(encoding="utf-8"))
    return record
