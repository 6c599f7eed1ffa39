"""Random valid shapes, every one of which must get certified cages.

    python benchmarks/stress.py --count 10000 --seed 0 --jobs 2

Per case: a random shape (kind, size, gaps), one to three levels of random vertex counts, started from the outer hull,
line cycles, the curve or a simplification. A count that is refused because the loops need more is replaced by the one
that the refusal names, and told apart. Prints each failure with its seed (repeat it with --seed SEED --count 1), and at
the end tables of cages, counts replaced, and refusals by their sentence. A sample is checked by shapely as well. Exit
status 1 when anything failed.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import re
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
import shapely

import clone  # noqa: F401
from nestedcages_core import (
    ArcLength,
    Hierarchy,
    Level,
    LineCycles,
    Mesh,
    NestingError,
    OnCurve,
    OuterHull,
    Settings,
    nested_cages,
    verify,
    verify_motion,
)
from published import DouglasPeucker, EdgeCollapse, Visvalingam
from random_shapes import random_shape

DECIMATIONS = (
    OuterHull(), OnCurve(), ArcLength(), LineCycles(), DouglasPeucker(), Visvalingam(), EdgeCollapse(),
)  # fmt: skip
"""Coarse meshes that cages start from."""

SHAPELY_SAMPLE = 10
"""Every tenth case is checked by shapely too."""

LARGEST = 1500
"""Shapes with more vertices are left out: growth has its own benchmark."""

SLOWEST = 5
"""Number of slow cases that are named."""

SMALLEST_POSSIBLE = re.compile(r"ask for at least (\d+)")
"""How a refusal names the smallest vertex count that was found to be possible."""

DETAILS = re.compile(r" \([\d, ]+ for its loops\)|-?\d+(\.\d+)?(e[+-]?\d+)?")
"""What differs between sentences of one kind: lists of numbers, and numbers."""

REFUSALS = 2
"""Refusals of a count that are followed: one for a later level, one for the fine mesh itself."""


@dataclass(frozen=True)
class Case:
    """What became of one seed."""

    seed: int
    kind: str
    vertices: int = 0
    levels: tuple[int, ...] = ()
    decimation: str = ""
    start: str = ""
    excess: float = float("nan")
    seconds: float = 0.0
    refusals: tuple[str, ...] = ()
    """Sentences that refused a count, each of which was replaced."""
    failure: str = ""


def run_case(seed: int) -> Case | None:
    """Cages for one seed; None where the seed draws no valid shape or one that is too large."""
    drawn = random_shape(seed)
    if drawn is None or len(drawn[1].vertices) > LARGEST:
        return None
    kind, fine = drawn
    random = np.random.default_rng([seed, 1])
    fewest, most = 3 * len(fine.loops), len(fine.vertices)
    counts = {int(c) for c in random.integers(fewest, max(fewest, min(most, 100)) + 1, random.integers(1, 4))}
    levels = tuple(sorted(counts, reverse=True))
    decimation = DECIMATIONS[random.integers(len(DECIMATIONS))]
    case = Case(seed, kind, most, levels, type(decimation).__name__)
    settings = Settings(decimation=decimation, fallback=OuterHull())
    begin = time.process_time()
    try:
        hierarchy, case = cages_or_smallest(fine, case, settings)
    except Exception as error:  # a crash is a failure too, and its seed must be printed
        return replace(case, failure=f"{type(error).__name__}: {error}")
    seconds = time.process_time() - begin
    first = hierarchy.levels[0].report
    return replace(
        case,
        start=first.start,
        excess=first.excess,
        seconds=seconds,
        failure=next((fault for level in hierarchy.levels if (fault := fault_of(level, seed))), ""),
    )


def cages_or_smallest(fine: Mesh, case: Case, settings: Settings) -> tuple[Hierarchy, Case]:
    """Cages for the case's levels; where a count is refused as too small, one level of the number that is named."""
    for _ in range(REFUSALS):
        try:
            return nested_cages(fine, case.levels, settings), case
        except NestingError as error:
            possible = SMALLEST_POSSIBLE.search(str(error))
            if possible is None:
                raise
            # named for the mesh inside the refused level, which may have been a cage already
            case = replace(case, levels=(int(possible[1]),), refusals=(*case.refusals, str(error)))
    return nested_cages(fine, case.levels, settings), case


def fault_of(level: Level, seed: int) -> str:
    """What is wrong with a level; empty when nothing is."""
    certificate = verify(level.cage, level.fine)
    if not certificate.holds:
        return " ".join(certificate.problems)
    way = level.reinflation
    motion = verify_motion(level.cage, level.fine, way.cage_steps, way.fine_steps)
    if not motion:
        return f"the motion after step {motion.step} of {len(way.cage_steps) - 1} is not certified"
    if seed % SHAPELY_SAMPLE == 0 and not nested_by_shapely(level.cage, level.fine):
        return "shapely disagrees"
    return ""


def nested_by_shapely(cage: Mesh, fine: Mesh) -> bool:
    """Whether shapely, in coordinates of the shape's own size, finds the cage around the fine mesh."""
    outside, inside = (solid(mesh, fine) for mesh in (cage, fine))
    return bool(outside.is_valid and outside.covers(inside) and outside.boundary.distance(inside.boundary) > 0.0)


def solid(mesh: Mesh, frame: Mesh) -> shapely.Geometry:
    """The mesh as a shapely geometry in units of the frame's diagonal, centred."""
    unit = (mesh.vertices - frame.vertices.mean(axis=0)) / frame.diagonal
    shape: shapely.Geometry = shapely.MultiPolygon()
    for loop in sorted(mesh.loops, key=lambda loop: -shapely.Polygon(unit[loop]).area):
        shape = shape.symmetric_difference(shapely.Polygon(unit[loop]))
    return shape


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000, help="valid shapes to try")
    parser.add_argument("--seed", type=int, default=0, help="the first seed")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    options = parser.parse_args()

    # the matrices here are small: in every process, threads of the linear algebra would only wait for each other
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    cases: list[Case] = []
    seed = options.seed
    with ProcessPoolExecutor(options.jobs, multiprocessing.get_context("spawn")) as pool:
        while len(cases) < options.count:
            wanted = options.count - len(cases)
            for case in pool.map(run_case, range(seed, seed + wanted), chunksize=8):
                seed += 1
                if case is None:
                    continue
                cases.append(case)
                if case.failure:
                    print(f"failed: {described(case)}: {case.failure}", flush=True)
    report(cases, options.seed, seed)
    return 1 if any(case.failure for case in cases) else 0


def described(case: Case) -> str:
    """What a case is, for those who repeat it."""
    levels = ", ".join(map(str, case.levels))
    return f"seed {case.seed}, {case.kind}, {case.vertices} vertices, levels [{levels}], from {case.decimation}"


def report(cases: list[Case], first: int, last: int) -> None:
    """The tables, by kind and by start, and the slowest cases."""
    sample = sum(case.seed % SHAPELY_SAMPLE == 0 for case in cases)
    print(f"\nseeds {first} to {last - 1}; {sample} cases checked by shapely too")
    table("kind", ((case.kind, case) for case in cases))
    table("coarse", ((case.decimation, case) for case in cases))
    refusals(cases)
    print()
    for case in sorted(cases, key=lambda case: -case.seconds)[:SLOWEST]:
        print(f"{case.seconds:.1f} s: {described(case)}")


def refusals(cases: list[Case]) -> None:
    """How many counts were replaced, and the sentences that refused counts or whole cases, numbers left out."""
    replaced = sum(bool(case.refusals) and not case.failure for case in cases)
    asked = sum(not case.refusals and not case.failure for case in cases)
    print(f"\ncertified with the counts asked for: {asked}; with counts replaced: {replaced}; failed: "
          f"{sum(bool(case.failure) for case in cases)}")  # fmt: skip
    sentences = Counter(
        DETAILS.sub(lambda found: "" if found[0].startswith(" (") else "N", told)
        for case in cases
        for told in (*case.refusals, case.failure)
        if told
    )
    for sentence, count in sentences.most_common():
        print(f"{count:6d} x {sentence}")


def table(title: str, named: Iterable[tuple[str, Case]]) -> None:
    """One line for the cases of each name, and one for all of them."""
    groups: dict[str, list[Case]] = defaultdict(list)
    everything: list[Case] = []
    for name, case in named:
        groups[name].append(case)
        everything.append(case)
    columns = ("cases", "certified", "replaced", "flow", "hull", "median s", "slowest s", "excess %")
    print(f"\n{title:10}" + "".join(f"{name:>10}" for name in columns))
    for name, group in [*sorted(groups.items()), ("all", everything)]:
        good = [case for case in group if not case.failure]
        starts = Counter(case.start for case in good)
        seconds = [case.seconds for case in good] or [0.0]
        excess = [100.0 * case.excess for case in good] or [0.0]
        print(
            f"{name:10}{len(group):10d}{len(good):10d}{sum(bool(case.refusals) for case in good):10d}"
            f"{starts['flow']:10d}{starts['outer hull']:10d}"
            f"{np.median(seconds):10.3f}{max(seconds):10.2f}{np.median(excess):10.2f}"
        )


if __name__ == "__main__":
    sys.exit(main())
