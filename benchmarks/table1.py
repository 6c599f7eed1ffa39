"""The eight discs of the paper's Table 1: our time and tightness beside those of the paper's own C++ program.

Run as ``python benchmarks/table1.py`` from the project's root, or ``make bench``. Times are CPU seconds of one thread.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import time
from pathlib import Path
from typing import NamedTuple

for library in ("OMP", "OPENBLAS", "MKL", "VECLIB"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")  # before numpy loads them: one thread, as the reference

import clone  # noqa: E402, F401
from data import COARSE_RING_VERTICES, TABLE_1, Table1Row, annulus, read_table1  # noqa: E402
from nestedcages_core import Mesh, NestedCagesError, Progress, nested_cages, verify  # noqa: E402
from nestedcages_core.cache import forget  # noqa: E402

REPEATS = 5  # the median of so many runs is printed, after one that is not counted


class Measurement(NamedTuple):
    """Median CPU seconds in all and per phase, excess in per cent, and whether the cage is certified."""

    seconds: float
    phases: dict[str, float]
    excess: float
    certified: bool


class PhaseClock:
    """CPU seconds per phase, told by the progress of a run; the report of a level holds wall-clock times."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.began = self.last = time.process_time()
        self.phase = "decimation"

    def __call__(self, progress: Progress | None = None) -> None:
        now = time.process_time()
        self.seconds[self.phase] = self.seconds.get(self.phase, 0.0) + now - self.last
        self.phase, self.last = progress.stage if progress else self.phase, now


def measure(fine: Mesh, coarse: Mesh, repeats: int) -> Measurement:
    """Times the cage of `fine` that starts from `coarse`."""
    totals: list[float] = []
    phases: dict[str, list[float]] = {}
    for turn in range(repeats + 1):
        forget()
        clock = PhaseClock()
        (level,) = nested_cages(fine, [coarse], progress=clock).levels
        clock()
        if turn == 0:
            continue
        totals.append(clock.last - clock.began)
        for phase, seconds in clock.seconds.items():
            phases.setdefault(phase, []).append(seconds)
    certified = verify(level.cage, fine).holds
    excess = 100 * (level.cage.area / fine.area - 1)
    medians = {phase: statistics.median(seconds) for phase, seconds in phases.items()}
    return Measurement(statistics.median(totals), medians, excess, certified)


def cells(row: Table1Row, ours: Measurement) -> dict[str, str]:
    """One line of the printed table: heading -> text."""
    ratio = row.reference_seconds / ours.seconds if row.reference_seconds else None
    return {
        "fine": str(row.fine_vertices),
        **{f"{phase} s": f"{seconds:.4f}" for phase, seconds in ours.phases.items()},
        "total s": f"{ours.seconds:.4f}",
        "C++ s": text(row.reference_seconds, ".2f"),
        "ratio": text(ratio, ".0f"),
        "excess %": f"{ours.excess:.3f}",
        "C++ %": text(row.reference_excess, ".1f"),
        "optimum %": text(row.optimum_excess, ".2f"),
        "certified": "yes" if ours.certified else "NO",
    }


def text(value: float | None, form: str) -> str:
    """A figure, or a dash where there is none."""
    return "-" if value is None else format(value, form)


def table(lines: list[dict[str, str]]) -> str:
    """Lines under their headings, columns aligned to the right."""
    headings = list(dict.fromkeys(heading for line in lines for heading in line))
    rows = [headings, *([line.get(heading, "-") for heading in headings] for line in lines)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join("  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Times the eight discs of the paper's Table 1.")
    parser.add_argument("--data", type=Path, default=TABLE_1, help="another reference table, a CSV file")
    parser.add_argument("--repeats", type=int, default=REPEATS, help="runs of which the median counts (%(default)s)")
    options = parser.parse_args(arguments)
    try:
        rows = read_table1(options.data)
    except (OSError, KeyError, ValueError) as error:
        print(f"{options.data} is no reference table: {error}.", file=sys.stderr)
        return 2

    coarse = annulus(COARSE_RING_VERTICES)
    lines: list[dict[str, str]] = []
    ratios: list[float] = []
    excesses: list[tuple[float, float]] = []
    failed = False
    for row in rows:
        try:
            ours = measure(annulus(row.fine_ring_vertices), coarse, max(1, options.repeats))
        except NestedCagesError as error:
            lines.append({"fine": str(row.fine_vertices), "certified": "NO"})
            print(f"{row.fine_vertices} fine vertices: {error}", file=sys.stderr)
            failed = True
            continue
        failed |= not ours.certified
        lines.append(cells(row, ours))
        if row.reference_seconds:
            ratios.append(row.reference_seconds / ours.seconds)
        if row.reference_excess is not None:
            excesses.append((ours.excess, row.reference_excess))
    print(table(lines))
    where = "recorded on another machine" if options.data == TABLE_1 else "measured on the same machine"
    print(f"\nC++: {where}")
    if ratios and excesses:
        mean, (here, there) = statistics.geometric_mean(ratios), map(statistics.median, zip(*excesses, strict=True))
        print(f"ratio of times, C++ to ours: geometric mean {mean:.0f}, least {min(ratios):.0f}")
        print(
            f"On the {len(lines)} discs of the paper's Table 1, cages are {here:.1f} % larger than the discs (median), "
            f"and those of the paper's C++ program {there:.1f} %; the C++ program takes {mean:.0f} times as long "
            f"(its times: {where})."
        )
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
