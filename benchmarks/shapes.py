"""Tightness and time on eight shapes, compared with the records and with what other programs make of them.

    python benchmarks/shapes.py
    python benchmarks/shapes.py --data FOLDER    # your own shapes

For every shape at 16, 32 and 64 vertices: our excess and time next to those on record (data/records.csv), and the
excess of the line cycles before tightening next to that of a strict progressive hull. Then five nested levels. Last,
what shapely's buffer + simplify, GEOS's polygon hull and shortcut hulls make of the same shapes in the same run.
Exit status 1 if a cage is not certified, an excess is above the allowed multiple of its record, or half of the line
cycles are looser than the progressive hull.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import clone  # noqa: F401
from data import Record, read_records, shape, shape_names
from nestedcages_core import Level, LineCycles, Mesh, Settings, nested_cages, verify
from nestedcages_core.cache import forget
from peers import PEERS

COUNTS = (16, 32, 64)

FIVE_LEVELS = (64, 48, 32, 24, 16)
"""Vertices of cages around each other."""

CLEARANCE_ALLOWANCE = 0.03
"""Points of excess that the clearance may cost: the records were set without one."""

ALLOWED = 1.03
"""Multiple of the record above which the run fails."""

NEGLIGIBLE = 0.01
"""Records below this many per cent count as this: a ratio to nothing says nothing."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="folder of your own shapes (name_V.csv, name_E.csv)")
    parser.add_argument("--shapes", nargs="*", help="only these")
    parser.add_argument("--repeats", type=int, default=3, help="runs of which the fastest counts")
    options = parser.parse_args()
    shapes = {name: shape(name, options.data) for name in shape_names(options.data, options.shapes)}
    good = records_and_starts(shapes, {} if options.data else read_records(), options.repeats)
    good = five_levels(shapes) and good
    peers(shapes)
    return 0 if good else 1


def records_and_starts(shapes: dict[str, Mesh], records: dict[tuple[str, int], Record], repeats: int) -> bool:
    """The table of records and starts; whether all is as good as it should be."""
    columns = "fine", "cage", "certified", "excess %", "record %", "ratio", "start %", "peer's %", "CPU s", "recorded s"
    print("Records and starts\n" + f"{'shape':10}" + heading((*columns, "new record")))
    ratios, start_ratios, certified = [], [], True
    for name, fine in shapes.items():
        for count in COUNTS:
            level, ours = fastest(fine, count, Settings(), repeats)
            areas = level.cage.area, LineCycles().decimate(fine, count).area
            excess, start = (100.0 * (area / fine.area - 1.0) for area in areas)
            record = records.get((name, count), Record())
            ratios.append(max(excess - CLEARANCE_ALLOWANCE, NEGLIGIBLE) / max(record.excess, NEGLIGIBLE))
            start_ratios.append(start / record.hull)
            certified &= is_certified(level)
            print(
                f"{name:10}{len(fine.vertices):12d}{count:12d}{yes(is_certified(level))}{excess:12.3f}"
                f"{record.excess:12.3f}{ratios[-1]:12.3f}{start:12.3f}{record.hull:12.3f}{ours:12.3f}"
                f"{record.seconds:12.2f}{'yes' if excess < record.excess else '':>12}"
            )
    if not records:
        return certified
    print(f"ratio to the record: median {np.median(ratios):.3f}, largest {max(ratios):.3f} (allowed {ALLOWED})")
    print(f"start, to the peer's hull: median {np.median(start_ratios):.3f}, largest {max(start_ratios):.3f}")
    return certified and max(ratios) <= ALLOWED and bool(np.median(start_ratios) <= 1.0)


def is_certified(level: Level) -> bool:
    """Whether a new look at a cage finds all that its level promises."""
    return verify(level.cage, level.fine, level.report.wanted_clearance).holds


def yes(good: bool) -> str:
    return f"{'yes' if good else 'NO':>12}"


def fastest(fine: Mesh, count: int, settings: Settings, repeats: int) -> tuple[Level, float]:
    """The level, and CPU seconds of the fastest of several runs, none of which knows of the others."""
    times = []
    for _ in range(repeats):
        forget()
        begin = time.process_time()
        hierarchy = nested_cages(fine, [count], settings)
        times.append(time.process_time() - begin)
    return hierarchy.levels[0], min(times)


def peers(shapes: dict[str, Mesh]) -> None:
    """The table of what others make of the same shapes, in the same run."""
    columns = "cage", *(name for recipe in ("buffer", "hull", "shortcut")
                        for name in (f"{recipe} s", "excess %", "vertices", "verdict"))  # fmt: skip
    print("\nshapely's buffer and simplify, GEOS's polygon hull, shortcut hulls\n" + f"{'shape':10}" + heading(columns))
    for name, fine in shapes.items():
        for count in COUNTS:
            line = f"{name:10}{count:12d}"
            for peer in (recipe(fine, count) for recipe in PEERS.values()):
                if peer is None:
                    line += f"{'-':>12}" * 4
                else:
                    line += f"{peer.seconds:12.4f}{peer.excess:12.3f}{peer.vertices:12d}{peer.verdict:>12}"
            print(line)


def heading(columns: Sequence[str]) -> str:
    return "".join(f"{name:>12}" for name in columns)


def five_levels(shapes: dict[str, Mesh]) -> bool:
    """The table of cages around each other, each with its area beyond the shape's; whether all are certified."""
    columns = *(f"{count} v. %" for count in FIVE_LEVELS), "certified"
    print("\nFive levels\n" + f"{'shape':10}" + heading(columns))
    certified = True
    for name, fine in shapes.items():
        levels = nested_cages(fine, FIVE_LEVELS).levels
        good = all(is_certified(level) and verify(level.cage, fine).holds for level in levels)
        certified &= good
        excess = [100.0 * (level.cage.area / fine.area - 1.0) for level in levels]
        print(f"{name:10}" + "".join(f"{number:12.3f}" for number in excess) + yes(good))
    return certified


if __name__ == "__main__":
    sys.exit(main())
