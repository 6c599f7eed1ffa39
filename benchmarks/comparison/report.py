"""The comparison written down: a page for people, and a page of tables for every experiment."""

from __future__ import annotations

import json
import os
import platform
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from comparison import conclusions, methods
from comparison.cases import Inputs
from comparison.conclusions import Conclusion, Found, Trial, Verdict
from comparison.experiments import EXPERIMENTS
from comparison.measure import CLEARANCE, DEFAULT, LIMIT, REPEATS, SHORT
from comparison.tables import table
from nestedcages_core import __version__

COMMAND = "python benchmarks/compare.py"
RESULTS = "results.json"
"""What the report is made of."""

INTRODUCTION = (
    "*The main limitation of our work is a lack of critical comparison of the performance and robustness differences "
    "between our method and the original method*, Gurditta and Jacobson (2022) say of their augmentation of nested "
    "cages with IPC. This is that comparison: their method, Sacht et al.'s (2015), IPC as published (Li et al. 2020), "
    "and ours, behind one interface, from the same starts, judged by one exact certificate."
)

PLOTS = (
    ("contacts.png", "Contacts from the same starts: medians and quartiles of excess over time"),
    ("pareto.png", "Every setting of every contact, and those that no other beats"),
    ("scaling.png", "Time and memory over the number of vertices"),
    ("figures-1-5.png", "Figures 1 to 5 of the paper, drawn again"),
)

WHAT = (
    "*IPC 2020* has one range d̂ for all pairs, adaptive stiffness, an augmented Lagrangian for the moving fine mesh, "
    "and Newton steps on the full Hessian with eigenvalues clamped; its potential, derivatives and times of impact "
    "equal those of IPC Toolkit to 1e-12 (`tests/core/test_original_ipc.py`). *IPC*, ours, differs: ranges are local, "
    "at most half of the gaps; λ_R grows fourfold when the fine mesh rests short of its target, and d̂ shrinks to a "
    "quarter when a solve is blocked; the block of the fine mesh is lumped; Hessians are projected in closed form.",
    "*El Topo* keeps the order of the library that the original calls: pairs that are too close, geometric impulses "
    "one after the other, then inelastic impact zones with equalities (Harmon et al. 2008), then half the time. "
    "*Velocity filter* is a simplification: one quadratic program over all impacts.",
    "*Paper's energy, Newton* is the potential of 2022 with its faults repaired and Newton in place of gradient "
    "descent. *Nested Cages 2015*, *paper as written* and *paper repaired* are whole methods, the same as the add-on's "
    "presets (`published/settings.py`).",
)

LIMITS = (
    "In the plane. In space, broad phases and collision detection weigh more, and impulses meet harder cases.",
    "All methods share one code base in Python, its predicates and its collision detection: times compare algorithms. "
    "Only Table 1 has times of a program of the authors.",
    "Where El Topo gives up, the original calls asynchronous contact mechanics; that and rigid impact zones are left "
    "out, and such a run counts as a failure.",
    "Random shapes come from ten generators and glyphs from three fonts; both are chosen by us.",
)
MORE_LIMITS = (
    "El Topo's descent has no cap in the original; here it has 100 steps.",
    "IPC 2020 minimises the area of a cage without mass: the Hessian of the area, of order one, stands for the mass. "
    "Placing the fine mesh exactly, in place of within a thousandth of its step, is ours.",
    "The paper's lengths are absolute; here they are those of its Table 1 relative to the diagonal.",
    "With one vertex count per cage, tightness is decided by how many vertices stand where: every contact ends, after "
    "the tightening, in the local optimum that its start leads to. Area as energy buys tightness with symmetry.",
)

DIFFERENCE = (
    "Our *IPC* is not that of 2020: ranges are local, λ_R grows fourfold where the fine mesh rests short of its "
    "target, d̂ shrinks to a quarter where a solve is blocked, and the block of the fine mesh is lumped. "
    "[What each name stands for](comparison/method.md#what-is-compared)."
)

REFERENCES = (
    "R. Gurditta and A. Jacobson. *Augmenting Nested Cages with IPC.* 2022.",
    "L. Sacht, E. Vouga and A. Jacobson. *Nested Cages.* ACM Transactions on Graphics 34 (6), 2015, article 170.",
    "T. Brochu and R. Bridson. *Robust Topological Operations for Dynamic Explicit Surfaces.* SIAM Journal on "
    "Scientific Computing 31 (4), 2009. (El Topo.)",
    "D. Harmon, E. Vouga, R. Tamstorf and E. Grinspun. *Robust Treatment of Simultaneous Collisions.* ACM Transactions "
    "on Graphics 27 (3), 2008.",
    "M. Li, Z. Ferguson, T. Schneider, T. Langlois, D. Zorin, D. Panozzo, C. Jiang and D. M. Kaufman. *Incremental "
    "Potential Contact.* ACM Transactions on Graphics 39 (4), 2020, article 49.",
    "J. Smith and S. Schaefer. *Bijective Parameterization with Free Boundaries.* ACM Transactions on Graphics 34 (4), "
    "2015, article 70.",
    "S. Sellán et al. *Breaking Good: Fracture Modes for Realtime Destruction.* ACM Transactions on Graphics, 2022. "
    "(Simple nested cages.)",
    "I. Chao, U. Pinkall, P. Sanan and P. Schröder. *A Simple Geometric Model for Elastic Deformations.* ACM "
    "Transactions on Graphics 29 (4), 2010. (Spokes and rims.)",
    "L. Liu, L. Zhang, Y. Xu, C. Gotsman and S. J. Gortler. *A Local/Global Approach to Mesh Parameterization.* "
    "Computer Graphics Forum 27 (5), 2008.",
)

CONTACT_HEADINGS = (
    "contact", "excess %: area descent", "no energy", "tightened", "ms", "fail",
)  # fmt: skip
METHOD_HEADINGS = (
    "method", "figures", "random shapes", "excess %", "s", "Table 1: excess %", "s",
)  # fmt: skip


def slug(name: str) -> str:
    """File name of an experiment's page."""
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def write(
    found: Found, inputs: Inputs, out: Path, runs: int, seconds: float, jobs: int, tried: Trial | None
) -> dict[Conclusion, Verdict]:
    """All pages into a folder; returns the conclusions."""
    pictures = out / "comparison"
    pages: dict[str, str] = {}
    for name, results in found.items():
        experiment = EXPERIMENTS[name]
        body = experiment.section(results, inputs, pictures)
        heading, _, rest = body.removeprefix("## ").partition("\n\n")
        rest = re.sub(r"^### ", "## ", rest, flags=re.MULTILINE)
        parts = [f"# {heading}", back(), experiment.finding(results, inputs), rest]
        (pictures / f"{slug(name)}.md").write_text("\n\n".join(part for part in parts if part) + "\n", encoding="utf-8")
        pages[name] = heading
    if tried is not None:
        lines = [f"* {line}" for line in str(tried).splitlines()[1:]]
        parts = ["# Conclusions tried on other shapes", back(), str(tried).splitlines()[0], "\n".join(lines)]
        (pictures / "confirmed.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")
    (pictures / "method.md").write_text(_method(inputs, runs, seconds, jobs), encoding="utf-8")
    verdicts = conclusions.verdicts(found)
    (out / "comparison.md").write_text(_page(found, verdicts, pages, tried), encoding="utf-8")
    (pictures / RESULTS).write_text(
        json.dumps(_results(found, verdicts, runs, seconds, jobs, tried), indent=1, ensure_ascii=False) + "\n",
        encoding="utf-8",
    )
    return verdicts


def back() -> str:
    """Where a page of tables belongs."""
    return "[The methods compared](../comparison.md) · [how it was measured](method.md)"


def said(verdict: Verdict) -> str:
    """A conclusion, marked where the runs contradict it."""
    return verdict.text if verdict.holds else f"**Contradicted by these runs:** {verdict.text}"


def _page(found: Found, verdicts: dict[Conclusion, Verdict], pages: dict[str, str], tried: Trial | None) -> str:
    links = {c: f" ([tables](comparison/{c.page}))" for c in verdicts}
    parts = [
        "# The methods compared", INTRODUCTION,
        "## Conclusions",
        "\n".join(f"{k}. {said(verdict)}{links[c]}" for k, (c, verdict) in enumerate(verdicts.items(), 1)),
    ]  # fmt: skip
    if tried is not None:
        parts.append(f"{tried.outcome} ([with numbers](comparison/confirmed.md))")
    parts.append(DIFFERENCE)
    if "contacts" in found:
        parts += [
            "Contacts from the same starts, medians; failures and time with area descent, where a contact has it:",
            table(CONTACT_HEADINGS, conclusions.contact_rows(found)),
        ]
    if {"figures", "random shapes", "table 1"} <= found.keys():
        parts += [
            "Whole methods: successes; excess and seconds where all of them leave a cage; and on the discs of Table 1:",
            table(METHOD_HEADINGS, conclusions.summary_rows(found)),
        ]
    parts += [f"![{title}](comparison/{name})" for name, title in PLOTS if _drawn(name, found)]
    parts += [
        "## Limits", "\n".join(f"* {text}" for text in LIMITS),
        "## Everything else",
        "\n".join(f"* [{title}](comparison/{slug(name)}.md)" for name, title in pages.items()),
        "[How it was measured](comparison/method.md), with the references. Every run is a line of "
        f"[runs.csv](comparison/runs.csv). `{COMMAND}` writes these pages, `{COMMAND} --check` says whether they are "
        f"of this code, `{COMMAND} --confirm` tries three conclusions on other shapes, and `python "
        "benchmarks/report.py` makes a report of them as PDF.",
    ]  # fmt: skip
    return "\n\n".join(parts) + "\n"


def _drawn(name: str, found: Found) -> bool:
    of = {
        "contacts.png": "contacts",
        "pareto.png": "sweeps",
        "scaling.png": "scaling",
        "figures-1-5.png": "figures 1 to 5",
    }
    return of[name] in found


def _results(
    found: Found,
    verdicts: dict[Conclusion, Verdict],
    runs: int,
    seconds: float,
    jobs: int,
    tried: Trial | None,
) -> dict[str, Any]:
    """What the report tells."""
    made: dict[str, Any] = {
        "conclusions": {c.name: {"text": v.text, "holds": v.holds} for c, v in verdicts.items()},
        "machine": _machine(jobs), "runs": runs, "minutes": round(seconds / 60.0, 1),
        "tried": tried.outcome if tried else "",
    }  # fmt: skip
    if "contacts" in found:
        made["contacts"] = [list(CONTACT_HEADINGS), *conclusions.contact_rows(found)]
        made["starts"] = len(found["contacts"])
    if {"figures", "random shapes", "table 1"} <= found.keys():
        made["methods"] = [list(METHOD_HEADINGS), *conclusions.summary_rows(found)]
    return made


def _machine(jobs: int) -> str:
    return (
        f"Nested Cages {__version__}, Python {platform.python_version()}, numpy {np.__version__}, scipy "
        f"{scipy.__version__}, {sys.platform}, {_processor()}, {os.cpu_count()} cores, {jobs} of them in use, one "
        "thread each"
    )


def _processor() -> str:
    """The model of the processor, where the system says."""
    path = Path("/proc/cpuinfo")
    lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()


def _method(inputs: Inputs, runs: int, seconds: float, jobs: int) -> str:
    remarks = [
        f"**Time** is CPU time of the process. Runs of less than {SHORT} s in Table 1 and in the tables of energies "
        f"and step filters are repeated {REPEATS} times, and the fastest counts; all others are run once. Differences "
        "below a third mean nothing, and ratios say more than seconds. Certificates are not timed.",
        "**Success** means all of it: the cage strictly encloses the fine mesh, by exact predicates, is simple and "
        "keeps its loops; the fine mesh stands at home to the last bit; and the animation is certified free of "
        "crossings at every instant between any two of its steps. *Certified* and *encloses* mean the first part.",
        "**Excess** is area(cage) / area(fine) − 1. Lengths are in bounding-box diagonals of the fine mesh; the "
        f"clearance asked for is {CLEARANCE:.0e}. Where a phase fails, the excess is that of the last cage reached; it "
        "may be negative.",
        "**Iterations** and **systems** are those of the reinflation, or of the systems solved within quadratic "
        "programs; of El Topo, passes over the impulses and projections of zones.",
        "**Fairness.** One coarse mesh and one attempt for every method, the same for all: the fallback and the "
        f"several starts of `nested_cages` are off, but for *{DEFAULT}*, which is the program without settings. "
        f"*{methods.LEVEL_SETS}* makes its own coarse mesh, of as many vertices, and has no reinflation. A run is "
        f"ended after {LIMIT:.0f} s where nothing else is said. No parameter was changed for any shape; random shapes "
        "come from fixed seeds. What is compared is listed in `benchmarks/comparison/methods.py`, on what in "
        "`benchmarks/comparison/cases.py` and `starts.py`.",
    ]
    return "\n\n".join([
        "# How it was measured",
        "[The methods compared](../comparison.md)",
        f"`{COMMAND}`, from the project's root, wrote these pages: every number, verdict, table and plot, from "
        f"{runs:,} runs in {seconds / 60.0:.1f} minutes. {_machine(jobs)}. [digest.json](digest.json) names the files "
        "that the results depend on, with a digest of the syntax of each.",
        "\n".join(f"* {text}" for text in remarks),
        "## What is compared", "\n".join(f"* {text}" for text in WHAT),
        "## Further limits", "\n".join(f"* {text}" for text in MORE_LIMITS),
        "## References",
        "\n".join(f"* {text}" for text in REFERENCES),
    ]) + "\n"  # fmt: skip
