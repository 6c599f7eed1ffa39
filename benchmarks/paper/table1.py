"""The eight discs of the paper's Table 1: ours, its C++ program and the optimum, and other methods."""

from __future__ import annotations

import csv
import statistics
import time

import numpy as np

from common import DETAILS, FAILED, Options, forget, table
from nestedcages_core import FlowError, as_published, nested_cages, verify
from paper.methods import WHOLE, measured
from shapes import DATA, annulus

COARSE, REPEATS = 16, 5
"""Vertices of each of the coarse annulus' rings; runs of which the median counts, after one that does not."""
OTHERS = ("Nested Cages 2015", "2022 by Newton", "ours")


def optimum(points: int) -> float:
    """Excess in per cent of the tightest annulus of 16 + 16 vertices around that of Table 1, for at least as many.

    The edges of the outer 16-gon are flush with edges of the ring: area cos²(π/k) Σ tan(θ/2). The one in the hole has
    its vertices on those of the ring: area ½ r² Σ sin θ. Angles θ between neighbours are multiples of 2π/k that add up
    to 2π; tan is convex and sin concave, so they are as equal as possible. Proof: docs/method.md.
    """
    steps, longer = divmod(points, COARSE)
    angles = 2.0 * np.pi / points * np.array([steps + 1] * longer + [steps] * (COARSE - longer))
    outer = np.cos(np.pi / points) ** 2 * np.tan(0.5 * angles).sum()
    return 100.0 * (float(outer - 0.125 * np.sin(angles).sum()) / annulus(points).area - 1.0)


def ours(points: int, repeats: int) -> tuple[float, float, bool]:
    """CPU seconds and excess of a default cage, and whether it is certified when looked at again."""
    fine, seconds = annulus(points), []
    for _ in range(repeats + 1):
        forget()
        begin = time.process_time()
        cage = nested_cages(fine, [annulus(COARSE)])[0].cage
        seconds.append(time.process_time() - begin)
    certificate = verify(cage, fine)
    return statistics.median(seconds[1:]), 100.0 * certificate.excess, certificate.holds


def written(points: int) -> tuple[float, float]:
    """Excess and CPU seconds of the paper's method as written, whose fine mesh never quite comes home."""
    try:
        result = as_published(annulus(points), annulus(COARSE))
    except FlowError:
        return np.nan, np.nan
    return 100.0 * (result.cage.area / annulus(points).area - 1.0), sum(result.seconds)


def run(options: Options) -> str:
    with (DATA / "table1.csv").open(newline="", encoding="utf-8") as file:
        known = list(csv.DictReader(file))
    rows, more, ratio, excesses, good = [], [], [], [], True
    for row in known[:2] if options.quick else known:
        points = int(row["fine_vertices"]) // 2
        program, its = float(row["reference_cpp_cpu_s"]), float(row["reference_cpp_excess_percent"])
        paper = float(row["paper_flow_s"]) + float(row["paper_reinflation_s"])
        seconds, excess, holds = ours(points, 1 if options.quick else REPEATS)
        good, ratio = good and holds, [*ratio, program / seconds]
        excesses.append((excess, its))
        rows.append((2 * points, f"{optimum(points):.2f}", f"{excess:.2f}", f"{its:.1f}", f"{seconds:.3f}",
                     f"{program:.2f}", f"{paper:.2f}", f"{ratio[-1]:.0f}"))  # fmt: skip
        runs = [measured(WHOLE[name], annulus(points), annulus(COARSE), 60.0) for name in OTHERS]
        runs_told = [one.failed or f"{one.excess:.2f} %, {one.seconds:.2f} s" for one in runs]
        as_is = () if options.quick else written(points)
        more.append((2 * points, *runs_told, f"{as_is[0]:.2f} %, {as_is[1]:.1f} s" if as_is else None))
    heads = ("points", "optimum %", "ours %", "C++ %", "ours s", "C++ s", "paper s", "C++ s / ours")
    here, there = (statistics.median(each) for each in zip(*excesses, strict=True))
    mean = statistics.geometric_mean(ratio)
    lines = [table(heads, rows), "" if good else f"{FAILED}: not certified\n"]
    lines += [
        f"On the {len(rows)} discs of the paper's Table 1, cages are {here:.1f} % larger than the discs (median), and "
        f"those of the paper's C++ program {there:.1f} %; the C++ program takes {mean:.0f} times as long (its times: "
        "recorded on another machine).",
        DETAILS,
        table(("points", *OTHERS, "2022 as written"), more),
    ]
    return "\n".join(lines)
