"""Cages with a least edge or a least angle compared with those of another commit: kept how often, excess, and time.

    python benchmarks/limits.py edge 0.6 --against 837f1d56
    python benchmarks/limits.py angle 55 --against 837f1d56 --cases 300

An edge is a fraction of the mean edge of a cage of that many vertices as long as the shape's outline; an angle is in
degrees. Both commits make each case in turn, in processes of their own. Times are CPU seconds. Needs git and shapely.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from clone import ROOT
from nestedcages_core import Mesh
from random_shapes import random_shape
from speed import Worker, checkout, forgetting

FEWEST, MOST, MOST_LOOPS = 30, 500, 4
"""Vertices and loops of the random shapes."""

COUNTS = (12, 16, 24, 32)
"""Vertices of the cages: one that is at least four times the number of loops and at most half of the vertices."""

FLOOR = 1e-4
"""Added to both excesses."""


@dataclass(frozen=True)
class Made:
    """What one commit made; an infinite excess is an error."""

    excess: float
    kept: bool
    seconds: float
    message: str


def cases(number: int, seed: int, kind: str, value: float) -> Iterator[tuple[int, Mesh, int, dict[str, float]]]:
    """(seed, shape, count, settings)."""
    done = 0
    while done < number:
        seed += 1
        drawn = random_shape(seed)
        if drawn is None or not FEWEST <= len(drawn[1].vertices) <= MOST or len(drawn[1].loops) > MOST_LOOPS:
            continue
        fine = drawn[1]
        fits = [count for count in COUNTS if 4 * len(fine.loops) <= count <= 0.5 * len(fine.vertices)]
        if not fits:
            continue
        done += 1
        count = int(np.random.default_rng([seed, 5]).choice(fits))
        mean = float(fine.edge_lengths.sum()) / count
        yield seed, fine, count, {"min_edge": value * mean} if kind == "edge" else {"min_angle": value}


def work() -> None:
    """In a worker: a cage for every case that comes in, without anything remembered."""
    import pickle
    import sys
    import time

    from nestedcages_core import Mesh, NestedCagesError, nested_cages

    forget = forgetting()
    while True:
        forget()
        try:
            loops, count, settings = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        fine = Mesh.from_loops(loops)
        began = time.process_time()
        try:
            report = nested_cages(fine, [count], **settings).levels[0].report
            kept = not any(note.code in ("note.edge", "note.angle") for note in report.notes)
            answer = report.excess, kept, time.process_time() - began, report.start
        except NestedCagesError as error:
            answer = float("inf"), False, time.process_time() - began, str(error)
        pickle.dump(answer, sys.stdout.buffer)
        sys.stdout.buffer.flush()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=("edge", "angle"))
    parser.add_argument("value", type=float)
    parser.add_argument("--against", default="HEAD", help="the other commit (%(default)s)")
    parser.add_argument("--cases", type=int, default=40, help="random shapes (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the seed before the first (%(default)s)")
    options = parser.parse_args()
    rows: list[tuple[int, int, Made, Made]] = []
    with checkout(options.against) as tree:
        workers = Worker(tree, work), Worker(ROOT, work)
        try:
            for seed, fine, count, settings in cases(options.cases, options.seed, options.kind, options.value):
                loops = [fine.vertices[loop] for loop in fine.loops]
                before, now = (Made(*worker.run((loops, count, settings))) for worker in workers)
                rows.append((seed, count, before, now))
        finally:
            for worker in workers:
                worker.close()
    both = [row for row in rows if row[2].kept and row[3].kept]
    ratio = np.array([(FLOOR + now.excess) / (FLOOR + before.excess) for _, _, before, now in both])
    seconds = [sum(row[k].seconds for row in rows) for k in (2, 3)]
    kept, made = ([sum(each) for each in zip(*pairs, strict=True)] for pairs in (
        [(row[2].kept, row[3].kept) for row in rows],
        [(bool(np.isfinite(row[2].excess)), bool(np.isfinite(row[3].excess))) for row in rows],
    ))  # fmt: skip
    print(f"{len(rows)} cases: kept {kept}, made {made} before and now; CPU ratio {seconds[1] / seconds[0]:.3f}")
    print(f"excess now / before where both keep it: median {np.median(ratio):.4f}, best {ratio.min():.3f}, worst "
          f"{ratio.max():.3f}; above 1.1: {(ratio > 1.1).sum()}, above 1.02: {(ratio > 1.02).sum()}, "
          f"below 0.98: {(ratio < 0.98).sum()}")  # fmt: skip
    for (seed, count, before, now), each in sorted(zip(both, ratio, strict=True), key=lambda row: -row[1])[:12]:
        print(f"  {seed:6d} {count:3d} {before.excess:.5f} {now.excess:.5f} {each:.3f}")
    for seed, count, before, now in rows:
        if before.kept != now.kept:
            print(f"  {seed:6d} {count:3d} kept {'before' if before.kept else 'now'} only; {now.message[:70]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
