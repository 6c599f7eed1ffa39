"""Whether a cage depends on position, size and numbering, and whether more vertices are ever worse.

    python benchmarks/positions.py
    python benchmarks/positions.py --cases 60 --seed 7000 --clearance 0.01

Each random shape gets cages in several positions: turned, moved, scaled, with other first vertices. *spread* is the
largest excess over the smallest, less 1. Then counts grow from a first one by 1, 1, 2, 4 and 8: *worse* is the
largest increase of the excess from one count to the next. Needles are told apart: the clearance decides their excess.
Exit status 1 if a cage is lost, or a spread or an increase of any other shape exceeds 1 %.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np

import clone  # noqa: F401
from nestedcages_core import Mesh, NestedCagesError, nested_cages
from nestedcages_core.cache import forget
from speed import FLOOR, random_cases

POSES = ((0.0, 1.0, 0.0), (0.1, 1.0, 0.0), (1.0, 1e3, 5.0), (2.0, 1e-3, 0.0), (np.pi / 2.0, 1.0, 30.0))
"""Angle in radians, scale, and shift in sizes of the shape along both axes; the first vertex differs in each."""

ALLOWED = 0.01
"""Relative difference of excess."""

MORE = (0, 1, 2, 4, 8, 16)
"""Vertices beyond those of the first cage."""


def posed(loops: list[np.ndarray], number: int) -> Mesh:
    """The shape in one of the positions."""
    angle, scale, shift = POSES[number]
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    size = np.ptp(np.concatenate(loops), axis=0).max()
    return Mesh.from_loops([np.roll(scale * (loop @ turn + shift * size), 7 * number, axis=0) for loop in loops])


def excess(fine: Mesh, count: int, clearance: float) -> float:
    """The excess of a cage at a clearance, 0: the default one; infinite where there is none."""
    forget()
    try:
        return nested_cages(fine, count, clearance=clearance or None)[0].report.excess + FLOOR
    except NestedCagesError:
        return np.inf


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=30, help="random shapes (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (%(default)s)")
    parser.add_argument("--clearance", type=float, default=0.0, help="in diagonals of each shape (the default one)")
    options = parser.parse_args()
    print(f"{'case':22}{'count':>6}{'excess %':>11}{'spread %':>10}{'worse %':>9}")
    found: list[tuple[bool, float, float]] = []
    for case in random_cases(options.cases, options.seed):
        first = posed(case.loops, 0)
        room = options.clearance * first.diagonal
        placed = np.array([excess(posed(case.loops, k), case.count, POSES[k][1] * room) for k in range(len(POSES))])
        if not np.isfinite(placed).any():
            continue  # impossible
        size = sum(map(len, case.loops))
        counts = sorted({min(size, case.count + more) for more in MORE})
        grown = np.array([placed[0], *(excess(first, count, room) for count in counts[1:])])
        spread, worse = placed.max() / placed.min() - 1.0, max(0.0, (grown[1:] / grown[:-1] - 1.0).max(initial=0.0))
        found.append((case.name.startswith("needles"), spread, worse))
        print(
            f"{case.name:22}{case.count:6d}{100 * (placed[0] - FLOOR):11.3f}{100 * spread:10.3f}{100 * worse:9.3f}",
            flush=True,
        )
    good = True
    for name, needles in (("needles", True), ("all others", False)):
        rows = np.array([row[1:] for row in found if row[0] == needles])
        if len(rows):
            print(
                f"{name}: {len(rows)} shapes, spread above 1 %: {(rows[:, 0] > ALLOWED).sum()}, largest "
                f"{100 * rows[:, 0].max():.2f} %; more vertices worse by above 1 %: {(rows[:, 1] > ALLOWED).sum()}, "
                f"largest {100 * rows[:, 1].max():.2f} %"
            )
            good &= needles or bool((rows <= ALLOWED).all())
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
