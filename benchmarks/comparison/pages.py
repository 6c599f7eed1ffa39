"""The pages, from the file of runs and what is said of the machine: nothing here runs a method."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from comparison import conclusions, methods, tables
from comparison.conclusions import Verdict
from comparison.measure import CLEARANCE, LIMIT, REPEATS, SHORT
from comparison.runs import Run
from comparison.statistics import LEVEL, RESAMPLES
from comparison.tables import table
from data import PROGRAM, read_table1

COMMAND = "python benchmarks/compare.py"
RUNS, RECORD = "runs.csv", "results.json"

QUOTE = (
    "*The main limitation of our work is a lack of critical comparison of the performance and robustness differences "
    "between our method and the original method*, Gurditta and Jacobson (2022) say of their augmentation of nested "
    "cages with IPC. This is that comparison: their method, that of Sacht et al. (2015), IPC as published (Li et al. "
    "2020) and ours, behind one interface, judged by one exact certificate."
)
CHOOSE = (
    ("cages for use", "the default: line cycles or hulls as starts, sequential QP as contact, the tightening after it"),
    ("a coarse mesh of your own", "the default too: sequential QP, then IPC where that is blocked"),
    ("an animation that keeps its distance on the way", "`IPC()`: it leaves the largest gaps of those that are fast"),
    (
        "a symmetric or evenly deformed cage",
        "another energy, such as `ShapeKeeping()`",
    ),
    ("the papers' methods", "`AUGMENTED_2022`, `AUGMENTED_2022_REPAIRED`, `NESTED_CAGES_2015`, `SIMPLE_2022`"),
)
LIMITS = (
    "In the plane. In space, broad phases and collision detection weigh more, and impulses meet harder cases.",
    "All methods share one code base in Python, its predicates and its collision detection: times compare algorithms. "
    "Only the discs have times of a program of the authors.",
    "Where El Topo gives up, the original calls asynchronous contact mechanics; that and rigid impact zones are left "
    "out, and such a run counts as a failure. Its descent has no cap in the original; here it has 100 steps.",
    "Random shapes come from ten generators, held-out ones from six that no method was tuned on, glyphs from three "
    "fonts; all are chosen by us.",
)


def write(runs: Sequence[Run], record: dict[str, Any], out: Path) -> None:
    """All pages into a folder."""
    (out / "comparison").mkdir(parents=True, exist_ok=True)
    for name, text in pages(runs, record).items():
        (out / name).write_text(text, encoding="utf-8")


def pages(runs: Sequence[Run], record: dict[str, Any]) -> dict[str, str]:
    """File name -> text."""
    return {
        "comparison.md": front(runs, record),
        "comparison/contacts.md": _page("Contacts from the same starts", _contacts(runs)),
        "comparison/methods.md": _page("Whole methods", _methods(runs)),
        "comparison/as-published.md": _page("The paper's program, figures and table", _published(runs)),
        "comparison/flows.md": _page("Flows and energies", _flows(runs)),
        "comparison/measured.md": _page("How it was measured", _measured(runs, record)),
    }


def front(runs: Sequence[Run], record: dict[str, Any]) -> str:
    """Three conclusions, a picture each, and what to choose."""
    parts = ["# The methods compared", QUOTE]
    for k, (conclusion, (known, held_out)) in enumerate(conclusions.verdicts(runs).items(), 1):
        parts += [
            f"## {k}. {conclusion.claim}", said(known),
            f"On held-out families of shapes: {said(held_out)} ([tables](comparison/{conclusion.page}))",
            f"![{conclusion.caption}](comparison/{conclusion.picture})",
        ]  # fmt: skip
    parts += [
        "## What to choose", table(["for", "choose"], CHOOSE),
        "## Limits", _list(LIMITS),
        "## The rest",
        "[Contacts](comparison/contacts.md) · [whole methods](comparison/methods.md) · [the paper's program, figures "
        "and "
        "table](comparison/as-published.md) · [flows and energies](comparison/flows.md) · [how it was measured]"
        f"(comparison/measured.md) · every run is a line of [runs.csv](comparison/{RUNS}). The methods and the "
        f"references are in [Method](method.md). Measured at commit {record['commit']}.",
    ]  # fmt: skip
    return "\n\n".join(parts) + "\n"


def said(verdict: Verdict) -> str:
    """The numbers, and whether they contradict the claim."""
    return verdict.numbers + ("" if verdict.holds else " **Contradicted by these runs.**")


def _page(title: str, parts: Sequence[str]) -> str:
    links = "[The methods compared](../comparison.md)"
    return "\n\n".join([f"# {title}", links, *(part for part in parts if part)]) + "\n"


def _contacts(runs: Sequence[Run]) -> list[str]:
    return [
        "Every contact gets the same coarse mesh on the curve and the same steps of the two-sided flow, lowers the "
        "area "
        "on the way (sequential QPs have no energy), and is judged when the fine mesh is back. Then all get the same "
        "tightening, at the same clearance. Medians and quartiles of the shapes that all contacts solve, tightening "
        "included; time of the reinflation, median of three runs. *Distance left*: median of the smallest one after "
        "reinflation.",
        tables.contacts(runs),
        "## At equal ranges",
        "The barrier of 2020 adapts its stiffness and lets the fine mesh approach whatever its range; the energy of "
        "2022 "
        "has fixed weights, so that its range is its distance. Clearances before the tightening are not equal for that "
        "reason; after it they are.",
        tables.ranges(runs),
        "*IPC, ours* differs from that of 2020: ranges are local, at most half of the gaps; λ_R grows fourfold where "
        "the "
        "fine mesh rests short of its target, and d̂ shrinks to a quarter where a solve is blocked; the block of the "
        "fine "
        "mesh is lumped. The default contact is sequential QP, since it takes least time and the tightening follows.",
    ]  # fmt: skip


def _methods(runs: Sequence[Run]) -> list[str]:
    return [
        "One coarse mesh and one attempt for every method; *simple cages* make their own mesh, of as many vertices, "
        "and "
        "may change loops; *nested_cages* is the program without settings, fallbacks and all. *2022 as written* has "
        "its "
        "lengths relative to the size of its Table 1, since random shapes have any size. A success is a certified "
        "cage, "
        "the fine mesh at home to the last bit and a motion free of crossings: the method as written never returns "
        "exactly, so it has none, but *cage encloses* says how often its cage encloses the shape. Excess and time: "
        "median and quartiles where every cage encloses.",
        tables.whole(runs),
        "## From 2022 to ours, one change at a time",
        "Every line keeps those above it. *Short*: the cage encloses, but the fine mesh ends so many diagonals from "
        "home.",
        tables.by_drawing(runs, "ladder"),
    ]  # fmt: skip


def _published(runs: Sequence[Run]) -> list[str]:
    return [
        "The program of 2022, compiled, beside `as_published` on the same meshes: the meshes of its figures 1 and 2, "
        "and "
        "discs of Table 1 at three sizes. Its lengths are absolute: h = 0.01 and d̂ = 0.1, so excess depends on the "
        "size "
        f"of the drawing. `python benchmarks/paper_program.py` makes the table ({PROGRAM.name}).",
        program_table(),
        "Figure 1 is a case in which the paper's own method succeeds: its cage encloses, and its fine mesh stops 2e-4 "
        "diagonals short.",
        "## Table 1",
        "*2022 as written* runs on the discs as they are. The optimum is that for 16 vertices per loop, without "
        "clearance: the least 16-gon around the outer ring has its edges flush with edges of the ring, and the largest "
        "in the hole has its vertices on those of the hole. It is known in closed form where 16 divides the vertices "
        "of a "
        "ring.",
        tables.table_1(runs, read_table1()),
        "## Figures",
        "Our drawings of the situations of figures 1 to 5; `make paper MESHES=FOLDER` draws the paper's own meshes. "
        "*Short*: the cage encloses, but the fine mesh ends so many diagonals from home, which the program accepts.",
        "![Figures 1 to 5](figures.png)",
        tables.by_drawing([run for run in runs if run.method != methods.SIMPLE], "methods"),
        "## What differs from the programs",
        _list((
            "2022: after 100 steps of the flow the program goes on from an infinite energy; here that is an error.",
            "2015: its samples keep the weights of the undeformed mesh; here they follow the moving one.",
            "Simple cages: a grid of 250 cells along the diagonal in place of 50; offsets grow from half a cell and "
            "six "
            "bisections follow, in place of ten bisections of [0, 0.5]; contours cannot cross themselves and the edge "
            "collapse keeps that, in place of a self-union. Holes may close and parts merge, as there.",
            "IPC 2020 minimises the area of a cage without mass: the Hessian of the area, of order one, stands for it.",
        )),
    ]  # fmt: skip


def program_table() -> str:
    """The program of 2022 beside `as_published`."""
    with PROGRAM.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    lines = []
    for row in rows:
        program, ours = float(row["program_excess_percent"]), float(row["ours_excess_percent"])
        encloses = "yes" if row["encloses"] == "True" else "no"
        lines.append([row["mesh"], f"{program:.3f}", f"{ours:.3f}", f"{ours - program:+.3f}",
                      encloses, f"{float(row['short_diagonals']):.0e}"])  # fmt: skip
    return table(["mesh", "program %", "as_published %", "difference", "cage encloses", "short of home"], lines)


def _flows(runs: Sequence[Run]) -> list[str]:
    return [
        "Algorithm 2 of 2022 gives both edges of a vertex the same weight; its program divides by their lengths; an "
        "integral along the edges would multiply. The paper suggests new samples at each step: `RandomSamples()`. "
        "*2015* "
        "has steps of a thousandth and up to 1,000 of them. Steps: median and quartiles where every flow gets inside.",
        tables.flows(runs),
        "## Energies",
        "Ours, with another energy on the way and in the tightening. Asymmetry: largest distance of a cage vertex from "
        "the nearest mirrored one, in diagonals, on two drawings with a mirror symmetry.",
        tables.energies(runs),
    ]


def _measured(runs: Sequence[Run], record: dict[str, Any]) -> list[str]:
    return [
        f"`{COMMAND}` made these pages from {len(runs):,} runs in {record['minutes']:.1f} minutes: every number, "
        "verdict "
        f"and picture is from [runs.csv]({RUNS}) (figures: drawn live). {record['machine']}. Commit "
        f"{record['commit']}.",
        _list((
            f"**Time** is CPU time; runs of less than {SHORT:g} s are repeated {REPEATS} times and the median counts. "
            f"A whole run is ended after {LIMIT:g} s. Certificates are not timed.",
            "**Excess** is area(cage) / area(fine) − 1. Lengths are in bounding-box diagonals of the fine mesh; the "
            f"clearance is {CLEARANCE:.0e} for all.",
            f"**Intervals** in square brackets: {LEVEL:.0f} %, percentile bootstrap over shapes, {RESAMPLES:,} "
            "resamples. "
            "**Paired tests**: two-sided sign tests over shapes that both methods solve. Spreads in round brackets are "
            "quartiles.",
            "**Families**: *random* (ten kinds, gaps down to a millionth, any size), *glyphs* (three fonts) and *held "
            "out* (gears, rosettes, ribbons, plates, puzzle pieces, crystals), which took no part in tuning. Numbers "
            "that give no valid shape of at most 400 vertices are passed over; no parameter was changed for any shape.",
            f"**Check**: `{COMMAND} --check`, part of `make lint`, writes the pages anew from runs.csv and compares "
            "them, and makes a sample of the runs again, on shapes with one optimum: success and excess must be as "
            "recorded. Unrelated changes of "
            "the code leave it green; a change of results does not.",
        )),
    ]  # fmt: skip


def _list(items: Sequence[str]) -> str:
    return "\n".join(f"* {item}" for item in items)


def read_record(folder: Path) -> dict[str, Any]:
    """What is said of the machine and the commit."""
    record: dict[str, Any] = json.loads((folder / RECORD).read_text(encoding="utf-8"))
    return record
