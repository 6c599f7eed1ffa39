"""Cages for a thousand glyph-like shapes: one process, two, two of which one is killed, and Dask's executor.

    python benchmarks/many_shapes.py --count 1000 --jobs 2

Needs shapely; Dask only with --dask. Times are wall-clock seconds, so run it on a machine that has nothing else to do.
How much faster the machine itself is with so many processes is printed beside: cores may share what makes them fast.
"""

from __future__ import annotations

import argparse
import os
import threading
import time
from collections.abc import Callable
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import suppress

for library in ("OMP", "OPENBLAS", "MKL", "VECLIB"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")  # before numpy loads them: processes share the work instead

import numpy as np  # noqa: E402

import clone  # noqa: E402, F401
from nestedcages_core import Hierarchy, InvalidMeshError, Mesh, Outcome, nested_cages_many  # noqa: E402
from random_shapes import glyph  # noqa: E402

VERTICES = 10  # per loop of each cage
KILL_AFTER = 0.3  # of the shapes
STEPS = 2_000_000  # of plain arithmetic per task, some tenths of a second


def glyphs(count: int) -> list[Mesh]:
    """So many valid shapes."""
    found: list[Mesh] = []
    seed = 0
    while len(found) < count:
        with suppress(InvalidMeshError):
            found.append(Mesh.from_geometry(glyph(np.random.default_rng(seed))))
        seed += 1
    return found


def level(mesh: Mesh) -> list[int]:
    return [min(VERTICES * len(mesh.loops), len(mesh.vertices))]


def cage(hierarchy: Hierarchy) -> Mesh:
    return hierarchy.cages[0]


def kill_one(pool: ProcessPoolExecutor) -> None:
    """End one worker the hard way."""
    next(iter(pool._processes.values())).kill()


def timed(
    name: str, shapes: list[Mesh], executor: Executor, workers: int, during: Callable[[], None] | None = None
) -> float:
    """Make all cages, say how long it took, which share of it the workers worked, and what was lost; seconds."""
    killed = threading.Event()

    def watch(progress: object) -> None:
        if during is not None and progress.fraction > KILL_AFTER and not killed.is_set():
            killed.set()
            during()

    began, own = time.perf_counter(), time.process_time()
    outcomes: list[Outcome] = nested_cages_many(shapes, level, executor=executor, progress=watch, keep=cage)
    seconds, own = time.perf_counter() - began, time.process_time() - own
    lost = sum(outcome.error is not None for outcome in outcomes)
    print(f"{name:32s} {seconds:8.1f} s, {1000 * seconds / len(shapes):6.1f} ms per shape,", end=" ")
    busy = sum(outcome.seconds for outcome in outcomes) / (workers * seconds)
    print(f"{1000 * own / len(shapes):5.2f} ms to hand one out, workers busy {100 * busy:.0f} %,", end=" ")
    print(f"{lost} lost", flush=True)
    for outcome in [each for each in outcomes if each.error is not None][:3]:
        print(f"    shape {outcome.key}: {outcome.error}")
    return seconds


def arithmetic(_: int) -> int:
    """Work that needs neither memory nor other processes."""
    return sum(i * i % 7 for i in range(STEPS))


def machine_gain(jobs: int) -> float:
    """How much faster so many processes do plain arithmetic than one: what the machine can give at the time."""
    seconds = []
    for workers in (1, jobs):
        with ProcessPoolExecutor(workers) as pool:
            list(pool.map(arithmetic, range(workers)))  # they have started
            began = time.perf_counter()
            list(pool.map(arithmetic, range(8 * jobs)))
            seconds.append(time.perf_counter() - began)
    return seconds[0] / seconds[1]


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--count", type=int, default=1000, help="shapes (default: 1000)")
    options.add_argument("--jobs", type=int, default=2, help="processes (default: 2)")
    options.add_argument("--dask", action="store_true", help="also over a local cluster of Dask")
    given = options.parse_args()

    shapes = glyphs(given.count)
    sizes = [len(mesh.vertices) for mesh in shapes]
    print(f"{given.count} shapes of {min(sizes)} to {max(sizes)} vertices, {VERTICES} vertices per loop of their cages")
    machine = machine_gain(given.jobs)
    with ProcessPoolExecutor(1) as pool:
        one = timed("one process", shapes, pool, 1)
    with ProcessPoolExecutor(given.jobs) as pool:
        many = timed(f"{given.jobs} processes", shapes, pool, given.jobs)
    print(f"{one / many:.2f} times as fast as one", end="; ")
    print(f"plain arithmetic before and after: {machine:.2f} and {machine_gain(given.jobs):.2f} times")
    with ProcessPoolExecutor(given.jobs) as pool:
        timed(f"{given.jobs} processes, one killed", shapes, pool, given.jobs, lambda: kill_one(pool))
    if given.dask:
        from dask.distributed import Client, LocalCluster

        workers = LocalCluster(n_workers=given.jobs, threads_per_worker=1, dashboard_address=None)
        with workers as cluster, Client(cluster) as client:
            timed("Dask, local cluster", shapes, client.get_executor(), given.jobs)


if __name__ == "__main__":
    main()
