"""How do time and memory of each contact grow with the fine and the coarse mesh?"""

from __future__ import annotations

import multiprocessing
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

from comparison import methods, plots
from comparison.bench import Bench
from comparison.cases import Inputs
from comparison.measure import Measurement, Results, measure
from comparison.starts import Start, start_in
from comparison.tables import number, table
from growth import peak_memory
from nestedcages_core import Mesh, OnCurve, Settings

LIMIT = 15.0  # CPU seconds of a run; a contact that takes longer gets no larger meshes
MEMORY_LIMIT = 6.0  # gigabytes of a process; the same
FINE_PER_COARSE = 50
FIXED_FINE, COARSE = 3000, (20, 60, 180, 540)
"""Fine vertices where the coarse ones vary."""
WAVES, STEEPNESS, SEED = 30, 0.25, 1
MEGABYTE = 2.0**20
OUT_OF_MEMORY = f"ended by its limit of {MEMORY_LIMIT:.0f} GB"


def curve(count: int) -> Mesh:
    """A wavy outline, of the same waves for every number of vertices."""
    random = np.random.default_rng(SEED)
    angle = 2.0 * np.pi * np.arange(count) / count
    radius = np.ones(count)
    for frequency in np.unique(np.geomspace(2, 60, WAVES).astype(int)):
        radius += STEEPNESS * random.normal() / frequency * np.cos(frequency * angle + random.uniform(0.0, 7.0))
    return Mesh.from_loops([radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)])


def run(inputs: Inputs, bench: Bench) -> Results:
    """Every contact, with area descent where it has one, from small to large. Each run has a process of its own."""
    sizes = [(n, max(16, n // FINE_PER_COARSE)) for n in inputs.sizes.scaling] + [(FIXED_FINE, m) for m in COARSE]
    made = bench.each("scaling starts", start_of_size, {size: size for size in sizes})
    found: Results = {}
    late: set[str] = set()
    for n, m in sizes:
        if (n, m) == sizes[len(inputs.sizes.scaling)]:
            late.clear()
        start = made[n, m]
        if start is None:
            continue
        chosen = {
            name: methods.alone(contact.descent or contact.clearing)
            for name, contact in methods.ALONE.items()
            if name not in late
        }
        tasks = {(n, m, name): (settings, *start) for name, settings in chosen.items()}
        runs = bench.each("scaling", in_own_process, tasks, lambda run: run.problem[:60] or f"{run.megabytes:.0f} MB")
        found[f"{n} in {m}"] = {name: result for (_, _, name), result in runs.items()}
        late |= {name for name, result in found[f"{n} in {m}"].items() if result.out_of_time or _too_large(result)}
    return found


def start_of_size(n: int, m: int) -> Start | None:
    """The outline with n vertices in a coarse mesh of m on it."""
    fine = curve(n)
    return start_in(fine, OnCurve().decimate(fine, m))


def in_own_process(settings: Settings, fine: Mesh, wanted: object) -> Measurement:
    """A run, with the megabytes that it adds to the peak memory of a fresh process."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as alone:
        return alone.submit(_with_memory, settings, fine, wanted).result()


def _with_memory(settings: Settings, fine: Mesh, wanted: object) -> Measurement:
    if sys.platform == "linux":  # no other system keeps to it
        import resource

        most = int(1024.0 * MEGABYTE * MEMORY_LIMIT)
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
    before = peak_memory()
    try:
        result = measure(settings, fine, wanted, 1, LIMIT)  # type: ignore[arg-type]
    except MemoryError:
        result = Measurement(fine, failed="reinflation", problem=OUT_OF_MEMORY)
    result.megabytes = peak_memory() - before
    return result


def _too_large(run: Measurement) -> bool:
    return run.problem == OUT_OF_MEMORY


def slope(found: Results, name: str) -> float | None:
    """Exponent of the growth of time with n, from the second size on, in which a coarse vertex stands for as many."""
    rows = [(len(run.fine.vertices), run.seconds["reinflation"]) for run in series(found, name)]
    if len(rows) < 3:
        return None
    size, seconds = np.log(np.array(rows[1:])).T
    return float(np.polyfit(size, seconds, 1)[0])


def series(found: Results, name: str) -> list[Measurement]:
    """Successful runs at the fixed ratio of fine and coarse vertices, by size."""
    runs = [runs[name] for shape, runs in found.items() if name in runs and _is_ratio(shape)]
    return sorted((run for run in runs if run.success), key=lambda run: len(run.fine.vertices))


def _is_ratio(shape: str) -> bool:
    n, m = (int(part) for part in shape.split(" in "))
    return m == max(16, n // FINE_PER_COARSE)


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """Seconds and megabytes by size."""
    names = list(methods.ALONE)
    plots.scaling(found, names, pictures / "scaling.png")

    def cell(runs: dict[str, Measurement], name: str) -> str:
        run = runs.get(name)
        if run is None:
            return "left out"
        if not run.success:
            if _too_large(run):
                return f"✗ over {MEMORY_LIMIT:.0f} GB"
            return f"✗ over {LIMIT:.0f} s" if run.out_of_time else f"✗ {run.failed or 'not certified'}"
        return f"{number(run.seconds['reinflation'], '.3g')} s · {run.megabytes:.0f} MB"

    lines = [[shape, *(cell(runs, name) for name in names)] for shape, runs in found.items()]
    growth = ["growth with n", *(number(slope(found, name)) for name in names)]
    return "\n\n".join([
        "## Time and memory over the number of vertices",
        "One wavy outline with more and more vertices, a coarse vertex for every "
        f"{FINE_PER_COARSE}, and {FIXED_FINE} vertices in coarser and finer meshes; area descent where a contact has "
        "one. Seconds of the reinflation, and what it adds to the peak memory of a process of its own. A contact that "
        f"takes more than {LIMIT:.0f} s or {MEMORY_LIMIT:.0f} GB gets no larger meshes. *Growth*: exponent of the time "
        "with n, from the second size on. Memory of the barriers is that of their lists of pairs, which are as wide as "
        "the longest motion of a Newton step.",
        table(["n in m", *names], [*lines, growth]),
        "![Scaling](scaling.png)",
    ])  # fmt: skip


def finding(found: Results, inputs: Inputs) -> str:
    """What grows how."""
    told = []
    for name in methods.ALONE:
        good = series(found, name)
        if good:
            last = good[-1]
            grows = slope(found, name)
            told.append(
                f"{name} up to {len(last.fine.vertices):,} in {last.seconds['reinflation']:.2f} s and "
                f"{last.megabytes:.0f} MB" + (f" (n^{grows:.1f})" if grows is not None else "")
            )
    return "**Growth.** " + "; ".join(told) + "."
