"""Time and tightness of the working tree compared with another commit, on the same shapes in the same run.

    python benchmarks/speed.py --against 6c1f498
    python benchmarks/speed.py --against main --cases 48 --seed 1000 --data SHAPES

Each commit runs in a process of its own. They take turns case by case, so that whatever else the machine does slows
both. Random shapes of all kinds have 100 to 1,000 vertices, the cages 16 to 64. Times are CPU seconds, the least of the
repeats. Exit status 1 when a cage is lost. Needs git and shapely.
"""

from __future__ import annotations

import argparse
import inspect
import os
import pickle
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from select import select
from typing import Any

import numpy as np

from clone import ROOT
from data import read_shape
from random_shapes import KINDS, random_shape

FEWEST, MOST = 100, 1000
"""Vertices of the random shapes."""

COUNTS = (16, 24, 32, 48, 64)
"""Cage vertices."""

FLOOR = 3e-4
"""Added to both excesses: below that the clearance decides, not the method."""

LARGEST_SHARE = 0.5
"""Cage vertices per vertex of the shape, at most."""


@dataclass(frozen=True)
class Case:
    """A shape and the vertex count of its cage."""

    name: str
    loops: list[np.ndarray]
    count: int


@dataclass(frozen=True)
class Run:
    """What one commit made of a case; infinite excess where it has no cage."""

    seconds: float
    excess: float
    start: str
    message: str = ""


def random_cases(number: int, seed: int) -> Iterator[Case]:
    """Random shapes from the seed on, about as many of each kind."""
    most = -(-number // len(KINDS))
    kinds: Counter[str] = Counter()
    while kinds.total() < number:
        drawn = random_shape(seed)
        seed += 1
        if drawn is None or not FEWEST <= len(drawn[1].vertices) <= MOST:
            continue
        kind, fine = drawn
        fits = [c for c in COUNTS if 4 * len(fine.loops) <= c <= LARGEST_SHARE * len(fine.vertices)]
        # kinds that seldom have so many vertices must not hold up the others
        if fits and (kinds[kind] < most or seed % (10 * len(KINDS)) == 0):
            kinds[kind] += 1
            count = int(np.random.default_rng([seed, 2]).choice(fits))
            yield Case(f"{kind} {seed - 1}", [fine.vertices[loop] for loop in fine.loops], count)


def folder_cases(folder: Path) -> Iterator[Case]:
    """The shapes kept in a folder as two CSV files each."""
    for path in sorted(folder.glob("*_V.csv")):
        fine = read_shape(folder, path.name.removesuffix("_V.csv"))
        loops = [fine.vertices[loop] for loop in fine.loops]
        for count in (16, 32, 64):
            if 4 * len(loops) <= count <= LARGEST_SHARE * len(fine.vertices):
                yield Case(path.name.removesuffix("_V.csv"), loops, count)


@contextmanager
def checkout(commit: str) -> Iterator[Path]:
    """A temporary work tree of a commit."""
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "tree"
        git = ["git", "-C", str(ROOT), "worktree"]
        subprocess.run([*git, "add", "--detach", "--quiet", str(tree), commit], check=True)
        try:
            yield tree
        finally:
            subprocess.run([*git, "remove", "--force", str(tree)], check=True)


class Worker:
    """A process that runs a function of this file or another with the package of one work tree."""

    def __init__(self, tree: Path, function: Callable[..., None], *arguments: object) -> None:
        source = f"{inspect.getsource(forgetting)}\n{inspect.getsource(function)}\n"
        # the matrices here are small: threads of the linear algebra would only wait for each other
        self.process = subprocess.Popen(
            [sys.executable, "-c", source + f"{function.__name__}{arguments!r}"],  # of the folder it runs in
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
            cwd=tree,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )

    def run(self, request: object, patience: float | None = None) -> Any:
        """The answer to a request; None if it takes longer than the patience, in seconds."""
        assert self.process.stdin is not None and self.process.stdout is not None
        pickle.dump(request, self.process.stdin)
        self.process.stdin.flush()
        if not select([self.process.stdout], [], [], patience)[0]:
            return None
        return pickle.load(self.process.stdout)

    def close(self) -> None:
        self.process.kill()
        self.process.wait()


def forgetting():  # type: ignore[no-untyped-def]
    """In a worker: what makes this commit, or an earlier one, forget what it remembers."""
    import importlib
    from pathlib import Path

    memory = ("cache", "memory", "decimation.remembered")  # others remember nothing
    # By files: an installed package would offer its own module to a commit that has none of that name.
    found = [name for name in memory if Path("nestedcages_core", *name.split(".")).with_suffix(".py").exists()]
    module = importlib.import_module(f"nestedcages_core.{found[0]}") if found else None
    return getattr(module, "forget", lambda: None)


def work() -> None:
    """In a worker: a cage for every case that comes in, without anything remembered from the repeat before."""
    import pickle
    import sys
    import time

    from nestedcages_core import Mesh, NestedCagesError, nested_cages

    forget = forgetting()
    while True:
        forget()
        try:
            loops, count = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        fine = Mesh.from_loops(loops)
        began = time.process_time()
        try:
            report = nested_cages(fine, [count]).levels[0].report
            answer = time.process_time() - began, report.excess, report.start
        except NestedCagesError as error:
            answer = time.process_time() - began, float("inf"), "", str(error)
        pickle.dump(answer, sys.stdout.buffer)
        sys.stdout.buffer.flush()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--against", default="HEAD", help="the other commit (%(default)s)")
    parser.add_argument("--cases", type=int, default=30, help="random shapes (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (%(default)s)")
    parser.add_argument("--data", type=Path, help="a folder with more shapes, name_V.csv and name_E.csv")
    parser.add_argument("--repeats", type=int, default=2, help="runs of each case (%(default)s)")
    options = parser.parse_args()
    cases = list(random_cases(options.cases, options.seed))
    if options.data is not None:
        cases += folder_cases(options.data)
    with checkout(options.against) as tree:
        workers = Worker(tree, work), Worker(ROOT, work)
        try:
            return compare(cases, workers, options.repeats, options.against)
        finally:
            for worker in workers:
                worker.close()


def compare(cases: list[Case], workers: tuple[Worker, Worker], repeats: int, against: str) -> int:
    """The table, one line per case and a summary; 1 if a case has lost its cage."""
    print(f"{'case':22}{'n':>6}{'loops':>6}{'count':>6}{'before s':>10}{'now s':>8}{'ratio':>7}{'before %':>10}"
          f"{'now %':>9}{'ratio':>8}  start")  # fmt: skip
    times, sizes, lost = [], [], 0
    for case in cases:
        runs = [[Run(*worker.run((case.loops, case.count))) for worker in workers] for _ in range(repeats)]
        before, now = runs[0]
        before_s, now_s = (min(run[k].seconds for run in runs) for k in (0, 1))
        size = float("nan")
        if np.isfinite(now.excess) and np.isfinite(before.excess):
            times.append(now_s / before_s)
            size = (now.excess + FLOOR) / (before.excess + FLOOR)
            sizes.append(size)
        elif np.isfinite(before.excess):
            lost += 1
        vertices = sum(map(len, case.loops))
        print(f"{case.name:22}{vertices:6d}{len(case.loops):6d}{case.count:6d}{before_s:10.3f}{now_s:8.3f}"
              f"{now_s / before_s:7.2f}{100 * before.excess:10.3f}{100 * now.excess:9.3f}{size:8.4f}  "
              f"{now.start}{now.message[:60]}", flush=True)  # fmt: skip
    time_ratio, size_ratio = np.array(times), np.array(sizes)
    print(f"\n{len(times)} cases against {against}, {lost} lost")
    print(f"time    geometric mean {np.exp(np.log(time_ratio).mean()):.3f}, median {np.median(time_ratio):.3f}, "
          f"worst {time_ratio.max():.2f}")  # fmt: skip
    print(f"excess  geometric mean {np.exp(np.log(size_ratio).mean()):.4f}, median {np.median(size_ratio):.4f}, "
          f"worst {size_ratio.max():.4f}, above 1.02: {(size_ratio > 1.02).sum()}")  # fmt: skip
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
