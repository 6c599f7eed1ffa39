"""How time and memory grow from 3,000 to 100,000 fine vertices, with a hundredth as many cage vertices.

    python benchmarks/growth.py [--sizes 3000 100000] [--start default|hull|curve] [--plot docs/growth.png]
    python benchmarks/growth.py --sizes 1000000 --cage 1000 --kinds smooth

Three kinds of shapes: a fractal coast, a smooth blob and a rough one. Every case runs in a process of its own, whose
peak memory the operating system tells. Prints seconds per phase and the slope of the total time on a log-log scale (1
is linear).
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np

import clone  # noqa: F401
from nestedcages_core import Mesh, OuterHull, Settings, nested_cages
from table1 import PhaseClock

SIZES = (3_000, 10_000, 30_000, 100_000)

FINE_PER_CAGE_VERTEX = 100


def smooth(count: int) -> Mesh:
    """Twelve waves."""
    return waves(count, np.arange(2, 14), 0.3)


def rough(count: int) -> Mesh:
    """Waves down to a few vertices long, each as steep as the others."""
    return waves(count, np.unique(np.geomspace(2, count / 8, 60).astype(int)), 0.25)


def waves(count: int, frequencies: np.ndarray, steepness: float) -> Mesh:
    random = np.random.default_rng(1)
    angle = 2.0 * np.pi * np.arange(count) / count
    radius = np.ones(count)
    for frequency in frequencies:
        radius += steepness * random.normal() / frequency * np.cos(frequency * angle + random.uniform(0.0, 7.0))
    return Mesh.from_loops([np.maximum(radius, 0.2)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)])


def fractal(count: int) -> Mesh:
    """A hexagon whose edges are broken at displaced midpoints until there are enough, then thinned evenly."""
    random = np.random.default_rng(2)
    angle = 2.0 * np.pi * np.arange(6) / 6
    outline = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    while len(outline) < count:
        following = np.roll(outline, -1, axis=0)
        edge = following - outline
        normal = np.stack([-edge[:, 1], edge[:, 0]], axis=1)
        middle = 0.5 * (outline + following) + 0.14 * random.uniform(-1.0, 1.0, (len(outline), 1)) * normal
        outline = np.stack([outline, middle], axis=1).reshape(-1, 2)
    keep = np.unique(np.linspace(0, len(outline), count, endpoint=False).astype(int))
    return Mesh.from_loops([outline[keep]])


KINDS = {"fractal": fractal, "smooth": smooth, "rough": rough}
STARTS = {
    "default": Settings(),
    "hull": Settings(decimation=OuterHull()),
    "curve": Settings(fallback=None),
}


def run_one(kind: str, count: int, cage: int, start: str) -> dict[str, float]:
    """Measure one case in this very process."""
    fine = KINDS[kind](count)
    clock = PhaseClock()
    hierarchy = nested_cages(fine, [cage], STARTS[start], progress=clock)
    clock()
    excess = 100.0 * hierarchy.levels[0].report.excess
    return {"total": clock.last - clock.began, "memory": peak_memory(), "excess": excess, **clock.seconds}


def peak_memory() -> float:
    """Peak memory of this process in megabytes; nan on Windows, where Python does not tell."""
    try:
        import resource
    except ImportError:
        return math.nan
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (2.0**20 if sys.platform == "darwin" else 2.0**10)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="fine vertices (default: 3,000 to 100,000)")
    parser.add_argument("--cage", type=int, help="cage vertices (default: a hundredth)")
    parser.add_argument("--start", choices=STARTS, default="default")
    parser.add_argument("--kinds", nargs="*", choices=sorted(KINDS), default=list(KINDS))
    parser.add_argument("--plot", type=Path, help="write a log-log plot here (needs matplotlib)")
    parser.add_argument("--one", nargs=3, metavar=("KIND", "COUNT", "CAGE"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        kind, count, cage = options.one
        print(json.dumps(run_one(kind, int(count), int(cage), options.start)))
        return 0
    columns = ("fine", "decimation", "flow", "reinflation", "tightening", "verification", "total s", "MB", "excess %")
    print(f"{'kind':8}" + "".join(f"{name:>13}" for name in columns))
    totals: dict[str, list[tuple[int, float]]] = {}
    for kind in options.kinds:
        for count in options.sizes:
            cage = str(options.cage or count // FINE_PER_CAGE_VERTEX)
            command = [sys.executable, __file__, "--one", kind, str(count), cage, "--start", options.start]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode:
                print(f"{kind:8}{count:13d}  {done.stderr.strip().splitlines()[-1]}")
                continue
            row = json.loads(done.stdout)
            print(f"{kind:8}{count:13d}" + "".join(f"{row.get(name, 0.0):13.2f}" for name in columns[1:6]), end="")
            print(f"{row['total']:13.2f}{row['memory']:13.0f}{row['excess']:13.3f}", flush=True)
            totals.setdefault(kind, []).append((count, row["total"]))
    for kind, points in totals.items():
        if len(points) > 1:
            size, seconds = np.log(np.array(points)).T
            print(f"{kind}: time grows as n^{np.polyfit(size, seconds, 1)[0]:.2f}")
    if options.plot:
        plot(totals, options.plot)
    return 0


def plot(totals: dict[str, list[tuple[int, float]]], path: Path) -> None:
    """Seconds over fine vertices, log-log, with a line of slope 1."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(7, 5))
    for kind, points in totals.items():
        axes.loglog(*np.array(points).T, "o-", label=kind)
    first = next(iter(totals.values()))[0]
    sizes = np.array([SIZES[0], SIZES[-1]])
    axes.loglog(sizes, first[1] * sizes / first[0], "k:", label="linear")
    axes.set_xlabel("fine vertices")
    axes.set_ylabel("CPU seconds")
    axes.legend()
    axes.grid(alpha=0.3, which="both")
    figure.tight_layout()
    figure.savefig(path, dpi=120)


if __name__ == "__main__":
    sys.exit(main())
