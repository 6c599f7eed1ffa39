"""How time and memory grow with points, loops and cage vertices; each case in a process of its own."""

from __future__ import annotations

import math
import sys
import time

import numpy as np

from common import DETAILS, Options, Server, ServerError, table
from nestedcages_core import nested_cages
from shapes import GROWING

PATIENCE = 300.0
"""Seconds after which a case is given up."""
SERIES = {
    "points, cage of a hundredth": [
        (kind, n, n // 100) for kind in ("fractal", "smooth", "rough") for n in (3_000, 10_000, 30_000, 100_000)
    ],
    "points at 32": [("smooth", n, 32) for n in (1_000, 10_000, 100_000, 1_000_000)],
    "points at 1,000": [("smooth", n, 1_000) for n in (10_000, 100_000, 1_000_000)],
    "loops of 24, 6 vertices each": [("islands", 24 * n, 6 * n) for n in (10, 30, 100, 300, 1_000)],
    "cage vertices": [("smooth", 10_000, n) for n in (16, 64, 256, 1_024)],
}
QUICK = {"points, cage of a hundredth": [("smooth", n, n // 100) for n in (1_000, 3_000)],
         "loops of 24, 6 vertices each": [("islands", 24 * n, 6 * n) for n in (4, 12)]}  # fmt: skip


def measure(kind: str, points: int, count: int) -> dict[str, float]:
    """In a server: CPU seconds and peak megabytes of a cage, and its excess."""
    fine = GROWING[kind](points // 24 if kind == "islands" else points)
    nested_cages(GROWING["smooth"](100), [8])  # what the first cage of a process imports
    begin = time.process_time()
    report = nested_cages(fine, [count])[0].report
    return {"seconds": time.process_time() - begin, "memory": peak_memory(), "excess": 100.0 * report.excess}


def peak_memory() -> float:
    """Peak memory of this process in megabytes; nan on Windows, where Python does not tell."""
    try:
        import resource
    except ImportError:
        return math.nan
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (2.0**20 if sys.platform == "darwin" else 2.0**10)


def run(options: Options) -> str:
    rows, growth = [], []
    for series, cases in (QUICK if options.quick else SERIES).items():
        if not options.wants(series):
            continue
        for kind in dict.fromkeys(case[0] for case in cases):
            powers = []
            for name, tree in options.trees().items():
                points = []
                for _, size, count in (case for case in cases if case[0] == kind):
                    with Server(tree, "scaling:measure") as server:
                        try:
                            found = server(kind, size, count, patience=PATIENCE)
                        except ServerError as error:
                            rows.append((f"{series}: {kind}", name, size, count, None, None, str(error)[:40]))
                            continue
                    points.append((size if series != "cage vertices" else count, found["seconds"]))
                    rows.append((f"{series}: {kind}", name, size, count, found["seconds"], round(found["memory"]),
                                 f"{found['excess']:.3f}"))  # fmt: skip
                power = np.polyfit(*np.log(np.array(points)).T, 1)[0] if len(points) > 1 else math.nan
                powers.append(f"n^{power:.2f}")
            growth.append((f"{series}: {kind}", *powers))
    return (
        table(("CPU seconds grow with", *options.trees()), growth)
        + f"\n{DETAILS}\n"
        + table(("series", "of", "points", "cage", "CPU s", "MB", "excess %"), rows)
    )
