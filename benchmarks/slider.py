"""A hand on a slider: one drawing of 500 vertices, and its cage for every number of vertices from 16 to 64.

    python benchmarks/slider.py [--step 1] [--vertices 500]

Dragged up and down once, with what earlier positions have left for reuse and without. CPU milliseconds per position.
The cages of both must be the same to the last bit: exit status 1 if they are not.
"""

from __future__ import annotations

import argparse
import sys
import time

import numpy as np

import clone  # noqa: F401 - puts the core of this clone on the path
from data.drawn import blob
from nestedcages_core import Mesh, nested_cages
from nestedcages_core.decimation import remembered

FEWEST, MOST = 16, 64
"""Ends of the slider."""


def dragged(fine: Mesh, counts: list[int], *, reuse: bool) -> tuple[list[float], list[np.ndarray]]:
    """CPU seconds and the cage's vertices at each position."""
    remembered.forget()
    seconds, cages = [], []
    for count in counts:
        if not reuse:
            remembered.forget()
        began = time.process_time()
        cages.append(nested_cages(fine, [count]).cages[0].vertices)
        seconds.append(time.process_time() - began)
    return seconds, cages


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--step", type=int, default=1, help="vertices between positions (%(default)s)")
    parser.add_argument("--vertices", type=int, default=500, help="of the drawing (%(default)s)")
    options = parser.parse_args()
    fine = blob(options.vertices)
    up = list(range(FEWEST, MOST + 1, options.step))
    counts = up + up[-2::-1]
    nested_cages(fine, [FEWEST])  # everything is imported
    print(f"{options.vertices} vertices, cages of {FEWEST} to {MOST}, up and down: milliseconds per position\n")
    print("| | median | worst | first position |\n|---|---|---|---|")
    found = {}
    for name, reuse in (("alone", False), ("with reuse", True)):
        seconds, found[name] = dragged(fine, counts, reuse=reuse)
        median, worst, first = 1e3 * np.median(seconds), 1e3 * max(seconds), 1e3 * seconds[0]
        print(f"| {name} | {median:.0f} | {worst:.0f} | {first:.0f} |", flush=True)
    same = all((one == other).all() for one, other in zip(*found.values(), strict=True))
    print("\nThe cages are the same to the last bit." if same else "\nThe cages differ.")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
