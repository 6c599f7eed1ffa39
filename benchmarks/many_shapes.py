"""Cages for many shapes: one process, all cores, all of which one is killed, and Dask's executor.

    python benchmarks/many_shapes.py [--sets font icons] [--count 1000] [--jobs 2] [--dask]

Three sets: the first 500 glyphs of DejaVu Sans, 1,000 icons of a package that npm fetches once, and 1,000 random shapes
like glyphs. Needs matplotlib, shapely, tinycss2 and cssselect2; Dask only with --dask. Times are wall-clock seconds, so
run it on a machine that has nothing else to do. How much faster the machine itself is with so many processes is printed
too: cores may share what makes them fast.
"""

from __future__ import annotations

import argparse
import os
import shutil
import threading
import time
from collections.abc import Callable
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import suppress

for library in ("OMP", "OPENBLAS", "MKL", "VECLIB"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")  # before numpy loads them: processes share the work instead

import numpy as np  # noqa: E402

import clone  # noqa: E402, F401
from data.drawn import glyph as letter  # noqa: E402
from nestedcages_core import Hierarchy, InvalidMeshError, Mesh, NestedCagesError, Outcome, nested_cages_many  # noqa: E402
from painted import NPM, chosen, fetched  # noqa: E402
from random_shapes import glyph  # noqa: E402

VERTICES = 10  # per loop of each cage
KILL_AFTER = 0.3  # of the shapes
STEPS = 2_000_000  # of plain arithmetic per task, some tenths of a second
PER_CURVE = 4  # edges per curve of a font's outlines
ICONS = "bootstrap-icons"  # on npm


def glyphs(count: int) -> list[Mesh]:
    """So many valid shapes."""
    found: list[Mesh] = []
    seed = 0
    while len(found) < count:
        with suppress(InvalidMeshError):
            found.append(Mesh.from_geometry(glyph(np.random.default_rng(seed))))
        seed += 1
    return found


def letters(count: int) -> list[Mesh]:
    """The first characters of DejaVu Sans whose outlines do not cross themselves."""
    from matplotlib.font_manager import findfont
    from matplotlib.ft2font import FT2Font

    found: list[Mesh] = []
    for code in sorted(FT2Font(findfont("DejaVu Sans")).get_charmap()):
        if len(found) == count:
            break
        with suppress(InvalidMeshError, ValueError, AttributeError):  # the last two where nothing is drawn
            found.append(letter(chr(code), per_curve=PER_CURVE))
    return found


def icons(count: int) -> list[Mesh]:
    """Icons of a package, chosen by chance; those that cannot be read are left out."""
    from nestedcages_core.exchange import svg_drawing

    if shutil.which("npm") is None:
        print("The icons are left out: npm is not installed")
        return []
    found: list[Mesh] = []
    for path in chosen(fetched(ICONS, NPM), 2 * count, seed=0):
        if len(found) == count:
            break
        with suppress(NestedCagesError):
            found.append(svg_drawing(path.read_bytes()).mesh)
    return found


SETS = {"font": (letters, 500), "icons": (icons, 1000), "random": (glyphs, 1000)}
"""What makes the shapes, and how many."""


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
    for outcome in [each for each in outcomes if each.error is not None][:3] if workers == 1 else ():
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
    options.add_argument("--sets", nargs="+", choices=SETS, default=list(SETS), help="(default: all)")
    options.add_argument("--count", type=int, help="shapes of each set at most (default: 500 glyphs, 1000 others)")
    options.add_argument("--jobs", type=int, default=os.cpu_count() or 2, help="processes (default: one per core)")
    options.add_argument("--dask", action="store_true", help="also over a local cluster of Dask")
    given = options.parse_args()
    for name in given.sets:
        make, count = SETS[name]
        shapes = make(min(count, given.count or count))
        if shapes:
            compare(name, shapes, given.jobs, dask=given.dask)


def compare(name: str, shapes: list[Mesh], jobs: int, *, dask: bool) -> None:
    """One set by one process, by several, by several of which one is killed, and by Dask."""
    sizes = [len(mesh.vertices) for mesh in shapes]
    print(f"{name}: {len(shapes)} shapes of {min(sizes)} to {max(sizes)} vertices, {VERTICES} per loop of their cages")
    machine = machine_gain(jobs)
    with ProcessPoolExecutor(1) as pool:
        one = timed("one process", shapes, pool, 1)
    with ProcessPoolExecutor(jobs) as pool:
        many = timed(f"{jobs} processes", shapes, pool, jobs)
    print(f"{one / many:.2f} times as fast as one", end="; ")
    print(f"plain arithmetic before and after: {machine:.2f} and {machine_gain(jobs):.2f} times")
    with ProcessPoolExecutor(jobs) as pool:
        timed(f"{jobs} processes, one killed", shapes, pool, jobs, lambda: kill_one(pool))
    if dask:
        from dask.distributed import Client, LocalCluster

        workers = LocalCluster(n_workers=jobs, threads_per_worker=1, dashboard_address=None)
        with workers as cluster, Client(cluster) as client:
            by_dask = timed(f"Dask, {jobs} local workers", shapes, client.get_executor(), jobs)
        print(f"Dask: {one / by_dask:.2f} times as fast as one process")
    print(flush=True)


if __name__ == "__main__":
    main()
