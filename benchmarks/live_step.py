"""Time of one live step: a drawing of 500 vertices is edited in place, and its cage of 32 follows.

python benchmarks/live_step.py
"""

from __future__ import annotations

import time

import numpy as np

import clone  # noqa: F401 - puts the core of this clone on the path
from nestedcages_core import Mesh, followed, nested_cages

VERTICES, LEVEL, STEPS = 500, 32, 20
# What is pulled, in radians around the drawing, and how far by each step, as a fraction of its radius.
WIDTH, PULL = 0.2, (0.005, 0.011)


def steps() -> list[tuple[float, float]]:
    """Wall-clock and processor seconds of each step. Every cage is certified, or the step counts as failed."""
    angle = np.linspace(0.0, 2.0 * np.pi, VERTICES, endpoint=False)
    radius = 1.6 + 0.4 * np.cos(6.0 * angle)
    fine = Mesh.from_loops([radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])])
    cage, clearance = nested_cages(fine, [LEVEL]).levels[0].cage, 1e-5 * fine.diagonal
    pulled = np.exp(-(((angle - 0.5) / WIDTH) ** 2))[:, None] * 1.6 * np.array(PULL)
    seconds = []
    for _ in range(STEPS):
        after = fine.moved(fine.vertices + pulled).validated()
        wall, processor = time.perf_counter(), time.process_time()
        found = followed(cage, fine, after, clearance)
        seconds.append((time.perf_counter() - wall, time.process_time() - processor))
        if found is None:
            raise SystemExit("A step failed: the cage could not follow")
        fine, cage = after, found
    return seconds


if __name__ == "__main__":
    wall, processor = 1e3 * np.array(steps()).T
    print(f"{VERTICES} vertices under {LEVEL}, {STEPS} steps")
    for name, times in (("wall clock", wall), ("processor", processor)):
        print(f"{name}: median {np.median(times):.0f} ms, maximum {times.max():.0f} ms")
