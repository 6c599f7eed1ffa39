"""The comparison written down: how it was measured, what was found, and every experiment's own part."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import scipy

from comparison.measure import CLEARANCE, DEFAULT, LIMIT, REPEATS, SHORT, Results
from comparison.methods import LEVEL_SETS
from comparison.tables import count, median, number, table
from nestedcages_core import __version__

COMMAND = "python benchmarks/compare.py"

REFERENCES = (
    "R. Gurditta and A. Jacobson. *Augmenting Nested Cages with IPC.* 2022. (“The paper”, with its C++ program.)",
    "L. Sacht, E. Vouga and A. Jacobson. *Nested Cages.* ACM Transactions on Graphics 34 (6), 2015, article 170.",
    "T. Brochu and R. Bridson. *Robust Topological Operations for Dynamic Explicit Surfaces.* SIAM Journal on "
    "Scientific Computing 31 (4), 2009. (El Topo.)",
    "D. Harmon, E. Vouga, R. Tamstorf and E. Grinspun. *Robust Treatment of Simultaneous Collisions.* ACM Transactions "
    "on Graphics 27 (3), 2008.",
    "M. Li, Z. Ferguson, T. Schneider, T. Langlois, D. Zorin, D. Panozzo, C. Jiang and D. M. Kaufman. *Incremental "
    "Potential Contact.* ACM Transactions on Graphics 39 (4), 2020, article 49.",
    "J. Smith and S. Schaefer. *Bijective Parameterization with Free Boundaries.* ACM Transactions on Graphics 34 (4), "
    "2015, article 70.",
    "S. Sellán et al., 2022, for *simple nested cages* from level sets.",
    "I. Chao, U. Pinkall, P. Sanan and P. Schröder. *A Simple Geometric Model for Elastic Deformations.* ACM "
    "Transactions on Graphics 29 (4), 2010. (Spokes and rims.)",
    "L. Liu, L. Zhang, Y. Xu, C. Gotsman and S. J. Gortler. *A Local/Global Approach to Mesh Parameterization.* "
    "Computer Graphics Forum 27 (5), 2008.",
)

OPEN = (
    "With one vertex count per cage, tightness is decided by how many vertices stand where. The contacts end, after "
    "the same tightening, in the local optimum that the start leads to; none of them moves a vertex from one side of a "
    "shape to where it is needed more.",
    "Area as energy buys tightness with symmetry: of two mirrored optima it takes one. Who wants the drawing's shape "
    "has to choose another energy, and pays with excess; there is no energy here that gives both everywhere.",
    "IPC and sequential QPs lock on some coarse meshes that cut across narrow slits, as on the comb below; "
    "`nested_cages` then goes on with the other contact and at last with the outer hull, which hides that, but the "
    "cage is then not the user's own.",
    "The paper's program has lengths in absolute units; here they are those of its Table 1 relative to the diagonal, "
    "so that on other shapes its range and its flow's step are our reading. Its times here are those of Python: "
    "compare the paper as written with ours in this program, and ours with the C++ program in Table 1 only.",
    "Sacht et al. fall back on asynchronous contact mechanics where their filter makes no progress; here single "
    "vertices are slowed down instead, and impulses are soft by a ten-thousandth so that every program has a solution. "
    "El Topo's rounds of single impulses before its impact zones are left out: a program over all impacts at once "
    "gives the velocity they aim at. Their own program was not run.",
    "Curves in the plane say little about the cost of contact in space, where a broad phase and collision detection "
    "weigh more.",
    "The fine meshes are small, for the sake of the paper as written; `benchmarks/growth.py` and "
    "`benchmarks/stress.py` measure ours alone on large ones and on many more random ones.",
)


SUMMARY = (
    LEVEL_SETS, "Nested Cages 2015", "paper as written", "paper repaired", "IPC", "sequential QP", "velocity filter",
    DEFAULT,
)  # fmt: skip
"""Methods that run on the figures and on random shapes alike."""


def summary(found: dict[str, Results]) -> str:
    """The methods in a line each, where the experiments they come from were run."""
    if not {"table 1", "figures", "random shapes"} <= found.keys():
        return ""
    shared = [shape for shape in found["figures"].values() if all(shape[name].certified for name in SUMMARY)]
    lines = []
    for name in SUMMARY:
        rows = [shape[name] for shape in found["table 1"].values() if name in shape]
        lines.append([
            name, count(found["figures"], name), count(found["random shapes"], name),
            number(median(shape[name].excess for shape in shared)),
            number(median(shape[name].total for shape in shared), ".3f"),
            number(median(run.excess for run in rows)), number(median(run.total for run in rows), ".3f"),
        ])  # fmt: skip
    heading = f"{len(shared)} figures"
    return table(
        ["method", "figures: success", "random shapes: success", f"{heading}: excess %", f"{heading}: s",
         "Table 1: excess %", "Table 1: s"], lines,
    )  # fmt: skip


def _original(found: dict[str, Results]) -> str:
    """The comparison that the paper lacks: with the method that it augments."""
    if not {"table 1", "figures", "random shapes"} <= found.keys():
        return ""
    first, second = "Nested Cages 2015", "paper repaired"
    both = [
        (shape[first], shape[second])
        for name in ("figures", "random shapes")
        for shape in found[name].values()
        if shape[first].success and shape[second].success
    ]
    success = {name: [count(found[of], name) for of in ("figures", "random shapes")] for name in (first, second)}
    rows = list(found["table 1"].values())
    tighter = sum(one.excess < other.excess for one, other in both)
    ratio = median(other.total / one.total for one, other in both)
    return (
        "**The original against its augmentation.** With its three repairs, without which the fine mesh never quite "
        f"returns, the paper's method succeeds on {success[second][0]} figures and {success[second][1]} random shapes; "
        f"the method of 2015, with the exact signs and the collision detection of this program, on "
        f"{success[first][0]} and {success[first][1]}. Where both succeed, the original is the tighter one on "
        f"{tighter} of {len(both)} and {number(ratio, '.0f')} times faster in the median. On Table 1 its excess is "
        f"{number(median(row[first].excess for row in rows), '.1f')} % in the median, the paper's "
        f"{number(median(row['paper as written'].excess for row in rows), '.1f')} %. What loses is not the barrier but "
        "what is around it: the same barrier with local ranges, projected Newton and a flow that gets inside is as "
        "robust as the filter and faster, as the tables below show."
    )


def _verdict(found: dict[str, Results]) -> str:
    """What the paper's idea becomes."""
    if not {"table 1", "figures"} <= found.keys():
        return ""
    faster = [
        shape["paper repaired"].total / shape["IPC"].total
        for shape in found["figures"].values()
        if shape["paper repaired"].success and shape["IPC"].success
    ]
    before, after = (
        median(row[name].excess for row in found["table 1"].values()) for name in ("paper as written", "IPC")
    )
    return (
        "The method of the paper is right in its idea and loses in its details. With its flow, its descent and its one "
        f"range replaced and a tightening at the end, the same idea is {median(faster) or 0.0:.0f} times faster on the "
        f"figures and leaves {number(after, '.1f')} % of excess instead of {number(before, '.1f')} % on Table 1, and "
        "with exact predicates and collision detection it can vouch for its result. Which contact then does the work "
        "matters little; which energy and which start do."
    )


def document(
    found: dict[str, Results], findings: Sequence[str], sections: Sequence[str], runs: int, seconds: float, jobs: int
) -> str:
    """The whole document from measurements, sentences and parts."""
    parts = [
        "# The methods side by side",
        "*The main limitation of our work is a lack of critical comparison of the performance and robustness "
        "differences between our method and the original method* — Gurditta and Jacobson (2022). Here is one, of "
        "everything that their method builds on: their own method as written, each repair and improvement in turn, "
        "Sacht et al.'s velocity filter, incremental potentials, sequential quadratic programs, level sets, energies, "
        "decimations, quadratures, step filters and broad phases, behind one interface and judged by one certificate.",
        "## In short",
        summary(found),
        f"*{LEVEL_SETS}* makes its own coarse mesh, of as many vertices, and has no reinflation; all others are given "
        "one. *Nested Cages 2015* is the flow down the signed distance and the velocity filter, with no tightening but "
        "its own descent on the area. *IPC*, *sequential QP* and *velocity filter* stand for ours with that contact: "
        f"two-sided flow, the contact, and the tightening. *{DEFAULT}* is the program without settings, which tries "
        "several contacts and several starts. Excess and seconds are medians, of the figures over those on which all "
        "these methods leave a cage that encloses the shape.",
        _original(found),
        _verdict(found),
        *_method(runs, seconds, jobs),
        "## What was found",
        *findings,
        "## Where ours loses, and what remains open",
        "\n".join(f"* {text}" for text in OPEN),
        *sections,
        "## References",
        "\n".join(f"* {text}" for text in REFERENCES),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _processor() -> str:
    """The model of the processor, where the system says."""
    path = Path("/proc/cpuinfo")
    lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()


def _method(runs: int, seconds: float, jobs: int) -> list[str]:
    remarks = [
        f"* **Time** is CPU time of the process. Runs of less than {SHORT} s in Table 1 and in the tables of "
        f"energies and step filters are repeated {REPEATS} times, and the fastest counts; all others are run once. "
        "The machine had other work to do: differences below a third mean nothing, and ratios say more than "
        "seconds. Certificates are not timed.",
        "* **Success** means all of it: the cage strictly encloses the fine mesh, by exact predicates, is simple "
        "and keeps its loops; the fine mesh stands at home to the last bit; and the animation is certified free of "
        "crossings at every instant between any two of its steps. *Certified* and *encloses* mean the first part. "
        "*Distance* is the smallest one between cage and fine mesh; only the tightening knows which is wanted.",
        "* **Excess** is area(cage) / area(fine) − 1. Lengths are in bounding-box diagonals of the fine mesh; the "
        f"clearance asked for is {CLEARANCE:.0e}. Where a phase fails, the excess is that of the last cage "
        "reached; it may be negative.",
        "* **Iterations** are those of the reinflation, or of the systems solved within quadratic programs.",
        "* **Fairness.** One coarse mesh and one attempt for every method, the same for all: the fallback and the "
        "several starts of `nested_cages` are off, but for the method of that name. All methods share one code "
        "base, its predicates and its "
        "collision detection, so times compare algorithms, not programmers. A run is ended after "
        f"{LIMIT:.0f} s where nothing else is said. No parameter was changed for any shape; random shapes come "
        "from fixed seeds. What is compared is listed in `benchmarks/comparison/methods.py`, on what in "
        "`benchmarks/comparison/cases.py`.",
    ]
    return [
        "## How it was measured",
        f"`{COMMAND}{f' --jobs {jobs}' if jobs > 1 else ''}`, from the project's root, wrote this page: every number, "
        f"verdict, table and plot, from {runs:,} runs in {seconds / 60.0:.1f} minutes. "
        "[comparison/runs.csv](comparison/runs.csv) has every run in a line. "
        f"Nested Cages {__version__}, Python {platform.python_version()}, numpy {np.__version__}, scipy "
        f"{scipy.__version__}, {sys.platform}, {_processor()}, {os.cpu_count()} cores, {jobs} of them in use, "
        "one thread each.",
        "\n".join(remarks),
    ]
