"""Tightness and time on shapes kept as CSV files, beside what is on record and what others make of them.

    python benchmarks/shapes.py --data ../shared/data/shapes

For every shape at 16, 32 and 64 vertices: our excess from outer-hull starts beside the record (the least excess of the
methods ``best_known`` and ``prototype`` in peers.csv), and our time beside the recorded one of the prototype. Then,
from resampled starts, the share of cage edges that show the sign of a local optimum of the area: flush with the fine
mesh around their middle, or touched at it. Last, what shapely's buffer + simplify and GEOS's polygon hull make of the
same shapes in the same run. Exit status 1 when an excess is above the allowed multiple of its record.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from data import read_shape
from nestedcages_core import ArcLength, Mesh, NestedCagesError, Settings, nested_cages
from nestedcages_core.broad_phase import near_pairs
from nestedcages_core.distance import point_edge
from peers import buffer_and_simplify, polygon_hull

COUNTS = (16, 32, 64)

CLEARANCE_ALLOWANCE = 0.03
"""Points of excess that the clearance may cost: the records were set without one."""

ALLOWED = 1.03
"""Multiple of the record above which the run fails."""

NEGLIGIBLE = 0.01
"""Records below this many per cent count as this: a ratio to nothing says nothing."""

TOUCHING = 1.2
"""Multiple of the clearance up to which a fine vertex counts as touching an edge."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=Path("../shared/data/shapes"), help="folder of the shapes")
    parser.add_argument("--shapes", nargs="*", help="only these")
    parser.add_argument("--repeats", type=int, default=3, help="runs of which the fastest counts")
    options = parser.parse_args()
    try:
        records, seconds = read_records(options.data / "peers.csv")
    except OSError as error:
        print(f"There are no shapes to measure: {error}. Name their folder with --data.", file=sys.stderr)
        return 2
    shapes = options.shapes or sorted({shape for shape, _ in records})
    ratios = hull_starts(options.data, shapes, records, seconds, options.repeats)
    resampled_starts(options.data, shapes)
    peers(options.data, shapes)
    return 1 if max(ratios) > ALLOWED else 0


def read_records(path: Path) -> tuple[dict[tuple[str, int], float], dict[tuple[str, int], float]]:
    """Least recorded excess (%) and the prototype's seconds, by shape and vertex count."""
    records: dict[tuple[str, int], float] = {}
    seconds: dict[tuple[str, int], float] = {}
    with path.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            key = row["shape"], int(row["m_target"])
            if row["method"] in ("best_known", "prototype"):
                records[key] = min(records.get(key, np.inf), float(row["excess_percent"]))
            if row["method"] == "prototype" and row["seconds"]:
                seconds[key] = float(row["seconds"])
    return records, seconds


def hull_starts(
    folder: Path,
    shapes: list[str],
    records: dict[tuple[str, int], float],
    seconds: dict[tuple[str, int], float],
    repeats: int,
) -> list[float]:
    """The table of outer-hull starts; returns the ratios of our excess to the record."""
    columns = ("fine", "cage", "excess %", "record %", "ratio", "CPU s", "recorded s", "new record")
    print("Outer-hull starts\n" + f"{'shape':10}" + heading(columns))
    ratios = []
    for name in shapes:
        fine = read_shape(folder, name)
        for count in COUNTS:
            excess, ours = fastest(fine, count, Settings(), repeats)
            record = records[name, count]
            ratio = max(excess - CLEARANCE_ALLOWANCE, NEGLIGIBLE) / max(record, NEGLIGIBLE)
            ratios.append(ratio)
            print(
                f"{name:10}{len(fine.vertices):11d}{count:11d}{excess:11.3f}{record:11.3f}{ratio:11.3f}{ours:11.3f}"
                f"{seconds.get((name, count), np.nan):11.2f}{'yes' if excess < record else '':>11}"
            )
    print(f"ratio to the record: median {np.median(ratios):.3f}, largest {max(ratios):.3f} (allowed {ALLOWED})")
    return ratios


def fastest(fine: Mesh, count: int, settings: Settings, repeats: int) -> tuple[float, float]:
    """Excess in per cent, and CPU seconds of the fastest of several runs."""
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        hierarchy = nested_cages(fine, [count], settings)
        times.append(time.process_time() - begin)
    return 100.0 * hierarchy.levels[0].report.excess, min(times)


def peers(folder: Path, shapes: list[str]) -> None:
    """The table of what others make of the same shapes, in the same run."""
    columns = ("cage", "buffer s", "excess %", "vertices", "verdict", "hull s", "excess %", "vertices", "verdict")
    print("\nshapely's buffer and simplify, and GEOS's polygon hull\n" + f"{'shape':10}" + heading(columns))
    for name in shapes:
        fine = read_shape(folder, name)
        for count in COUNTS:
            line = f"{name:10}{count:11d}"
            for peer in (buffer_and_simplify(fine, count), polygon_hull(fine, count)):
                if peer is None:
                    line += f"{'-':>11}" * 4
                else:
                    line += f"{peer.seconds:11.4f}{peer.excess:11.3f}{peer.vertices:11d}{peer.verdict:>11}"
            print(line)


def heading(columns: Sequence[str]) -> str:
    return "".join(f"{name:>11}" for name in columns)


def resampled_starts(folder: Path, shapes: list[str]) -> None:
    """The table of resampled starts with the sign of a local optimum."""
    columns = ("cage", "excess %", "optimal edges %")
    print("\nResampled starts\n" + f"{'shape':10}" + "".join(f"{name:>17}" for name in columns))
    for name in shapes:
        fine = read_shape(folder, name)
        for count in COUNTS:
            try:
                level = nested_cages(fine, [count], Settings(decimation=ArcLength())).levels[0]
            except NestedCagesError as error:
                print(f"{name:10}{count:17d}  {error}")
                continue
            share = 100.0 * optimal_edges(level.cage, fine, level.report.wanted_clearance)
            print(f"{name:10}{count:17d}{100.0 * level.report.excess:17.3f}{share:17.1f}")


def optimal_edges(cage: Mesh, fine: Mesh, clearance: float) -> float:
    """Share of the cage's edges whose middle lies between contacts: turning such an edge about any point costs area."""
    ends = cage.vertices[cage.successor]
    point, edge = near_pairs(fine.vertices, cage.vertices, ends, TOUCHING * clearance)
    where = point_edge(fine.vertices[point], cage.vertices[edge], ends[edge]).parameter
    first, last = np.full(len(ends), np.inf), np.full(len(ends), -np.inf)
    np.minimum.at(first, edge, where)
    np.maximum.at(last, edge, where)
    middle = 0.5
    near_middle = 0.02
    return float(np.mean((first <= middle + near_middle) & (last >= middle - near_middle)))


if __name__ == "__main__":
    sys.exit(main())
