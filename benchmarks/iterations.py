"""One run step by step: the area of the cage, its distance to the fine mesh, and how far that still has to go.

    python benchmarks/iterations.py --shape glyph_g --count 32 --plot docs/iterations.png

Prints a line per recorded step of reinflation and tightening.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

import clone  # noqa: F401
from data import shape, shape_names
from nestedcages_core import Level, Settings, nested_cages
from nestedcages_core.energies import signed_area
from nestedcages_core.geometry.predicates import BoxTree
from nestedcages_core.geometry.smallest_gap import smallest_gap


def measures(level: Level) -> np.ndarray:
    """(K + 1, 3): excess in per cent; smallest distance and largest distance to go, as fractions of the diagonal."""
    fine, cage, way = level.fine, level.cage, level.reinflation
    rows = []
    for inner, outer in zip(way.fine_steps, way.cage_steps, strict=True):
        excess = 100.0 * (signed_area(outer, cage.successor) / fine.area - 1.0)
        gap = smallest_gap(BoxTree(inner, inner[fine.successor]), BoxTree(outer, outer[cage.successor]))
        left = np.hypot(*(fine.vertices - inner).T).max()
        rows.append((excess, gap / fine.diagonal, left / fine.diagonal))
    return np.array(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="folder of your own shapes (name_V.csv, name_E.csv)")
    parser.add_argument("--shape", default="glyph_g")
    parser.add_argument("--count", type=int, default=32)
    parser.add_argument("--plot", type=Path, help="write a plot here (needs matplotlib)")
    options = parser.parse_args()
    (name,) = shape_names(options.data, [options.shape])
    fine = shape(name, options.data)
    level = nested_cages(fine, [options.count], Settings()).levels[0]
    rows = measures(level)
    start = level.reinflation.tightening_start
    print(f"{'step':>5}{'phase':>13}{'excess %':>12}{'distance':>12}{'to go':>12}")
    for step, (excess, gap, left) in enumerate(rows):
        phase = "reinflation" if step <= start else "tightening"
        print(f"{step:5d}{phase:>13}{excess:12.4f}{gap:12.2e}{left:12.2e}")
    if options.plot:
        plot(rows, start, level.report.wanted_clearance / fine.diagonal, options.plot)


def plot(rows: np.ndarray, start: int, clearance: float, path: Path) -> None:
    import matplotlib.pyplot as plt

    figure, (area, lengths) = plt.subplots(2, 1, figsize=(7, 6), sharex=True)
    steps = np.arange(len(rows))
    area.plot(steps, rows[:, 0], "o-")
    area.set_ylabel("excess of the cage's area, %")
    lengths.semilogy(steps, rows[:, 1], "o-", label="smallest distance, cage to fine mesh")
    lengths.semilogy(steps, np.where(rows[:, 2] > 0.0, rows[:, 2], np.nan), "s-", label="largest distance to go")
    lengths.axhline(clearance, color="k", linestyle=":", label="wanted clearance")
    lengths.set_ylabel("fraction of the diagonal")
    lengths.set_xlabel("recorded step")
    lengths.legend()
    for axes in (area, lengths):
        axes.axvline(start, color="0.6")
        axes.grid(alpha=0.3)
    beside = {"xytext": (6, 0), "textcoords": "offset points", "va": "top", "color": "0.4"}
    area.annotate("fine mesh is back", (start, 0.98), xycoords=area.get_xaxis_transform(), **beside)
    figure.tight_layout()
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
