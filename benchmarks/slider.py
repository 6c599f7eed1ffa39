"""A hand on a slider: one drawing of 500 vertices, and its cage for every position of a number.

    python benchmarks/slider.py [--positions 49] [--vertices 500]

The number is that of vertices from 16 to 64, the clearance from 1e-5 to 1e-2 of the diagonal, or the strength of
`ShapeKeeping` from 0.1 to 10, the latter two with 32 vertices. Each is dragged up and down once, with what earlier
positions have left for reuse and without. CPU milliseconds per position. The cages of both must be the same to the last
bit: exit status 1 if they are not.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence

import numpy as np

import clone  # noqa: F401 - puts the core of this clone on the path
from data.drawn import blob
from nestedcages_core import Mesh, Settings, ShapeKeeping, nested_cages
from nestedcages_core.cache import forget

COUNTS = 16, 64
CLEARANCES = 1e-5, 1e-2
STRENGTHS = 0.1, 10.0
"""Ends of the sliders."""

COUNT = 32
"""Vertices where another number is dragged."""


def positions(fine: Mesh, number: int) -> dict[str, list[tuple[int, Settings]]]:
    """Numbers of vertices and settings, up and down, by slider."""
    up: dict[str, list[tuple[int, Settings]]] = {
        "vertices": [(round(count), Settings()) for count in np.linspace(*COUNTS, number)],
        "clearance": [
            (COUNT, Settings(clearance=share * fine.diagonal)) for share in np.geomspace(*CLEARANCES, number).tolist()
        ],
        "energy": [
            (COUNT, Settings(energy=ShapeKeeping(strength))) for strength in np.geomspace(*STRENGTHS, number).tolist()
        ],
    }
    return {name: [*there, *there[-2::-1]] for name, there in up.items()}


def dragged(
    fine: Mesh, requests: Sequence[tuple[int, Settings]], *, reuse: bool
) -> tuple[list[float], list[np.ndarray]]:
    """CPU seconds and the cage's vertices at each position."""
    forget()
    seconds, cages = [], []
    for count, settings in requests:
        if not reuse:
            forget()
        began = time.process_time()
        cages.append(nested_cages(fine, [count], settings).cages[0].vertices)
        seconds.append(time.process_time() - began)
    return seconds, cages


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--positions", type=int, default=49, help="of each slider (%(default)s)")
    parser.add_argument("--vertices", type=int, default=500, help="of the drawing (%(default)s)")
    options = parser.parse_args()
    fine = blob(options.vertices)
    nested_cages(fine, [COUNT])  # everything is imported
    print(f"{options.vertices} vertices, {options.positions} positions up and down: milliseconds per position\n")
    print("| slider | | median | worst | first position |\n|---|---|---|---|---|")
    same = True
    for slider, requests in positions(fine, options.positions).items():
        found = {}
        for name, reuse in (("alone", False), ("with reuse", True)):
            seconds, found[name] = dragged(fine, requests, reuse=reuse)
            median, worst, first = 1e3 * np.median(seconds), 1e3 * max(seconds), 1e3 * seconds[0]
            print(f"| {slider} | {name} | {median:.0f} | {worst:.0f} | {first:.0f} |", flush=True)
        same = same and all((one == other).all() for one, other in zip(*found.values(), strict=True))
    print("\nThe cages are the same to the last bit." if same else "\nThe cages differ.")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
