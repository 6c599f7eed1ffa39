"""What each mechanism buys: it is switched off alone, and cages are made of the same shapes as with it.

    python benchmarks/ablation.py --shapes 60 --jobs 2 --output docs/ablation.md

Prints, for each mechanism, what is lost without it: shapes that get no cage or start from the hull, excess relative to
that with it (mean and worst; above 1 it helps), and time. Mechanisms are switched off by settings where there are some,
otherwise by replacing a constant or a function of the core (mechanisms.py); a name that is no longer there is an error.
Where probes tell in which cases a mechanism is used, only these are made again. A mechanism that buys nothing is to be
removed. `--results FILE` keeps what was made, so that a long run can be made in parts with `--only`.
"""

from __future__ import annotations

import argparse
import inspect
import json
import multiprocessing
import os
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import asdict, dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

import clone  # noqa: F401
from data import shape, shape_names
from mechanisms import MECHANISMS, Around, Mechanism
from nestedcages_core import ArcLength, Mesh, NestedCagesError, nested_cages, verify
from random_shapes import KINDS, random_shape

LARGEST = 500
"""Vertices of the largest random shape: growth has its own benchmark."""

COUNTS = (16, 32)
"""Vertex counts, raised to four for every loop."""

FEWEST = 8
"""The vertex count at which loops are in each other's way, raised to three for every loop."""

WIDE_CLEARANCE = 0.02
"""A clearance in diagonals that does not fit into narrow gaps and holes."""

OWN_COUNT = 24
"""Vertices of coarse meshes that are given."""

FIRST_SEED = 40_000
"""Of the random shapes."""

SMALL_EXCESS = 3e-4
"""Added to both sides of a ratio of excesses: what the clearance alone costs."""


@dataclass(frozen=True)
class Case:
    """A shape and a level."""

    name: str
    fine: Mesh
    level: int | Mesh
    clearance: float | None = None


@dataclass(frozen=True)
class Made:
    """What became of a case."""

    certified: bool
    excess: float
    seconds: float
    start: str
    used: tuple[str, ...] = ()
    """Mechanisms that were used, of those with probes."""


def cases(count: int, kinds: Sequence[str], largest: int) -> list[Case]:
    """The drawn shapes and random ones of these kinds, as many of each: at three vertex counts, with a wide clearance,
    and with a coarse mesh of evenly spaced vertices instead, which flows find harder."""
    every = len(kinds) == len(KINDS)
    shapes = [(name, shape(name)) for name in shape_names() if every and len(shape(name).vertices) <= largest]
    of_kind: Counter[str] = Counter()
    most_of_kind = -(-(count - len(shapes)) // len(kinds))
    seed = FIRST_SEED
    while len(shapes) < count:
        drawn = random_shape(seed)
        seed += 1
        if drawn is None or len(drawn[1].vertices) > largest or of_kind[drawn[0]] >= most_of_kind:
            continue
        if drawn[0] not in kinds:
            continue
        of_kind[drawn[0]] += 1
        shapes.append((f"{drawn[0]} {seed - 1}", drawn[1]))
    found = []
    for name, fine in shapes[:count]:
        most = len(fine.vertices)
        counts = {min(most, max(FEWEST, 3 * len(fine.loops)))} | {
            min(most, max(k, 4 * len(fine.loops))) for k in COUNTS
        }
        found += [Case(f"{name} at {k}", fine, k) for k in sorted(counts)]
        found.append(Case(f"{name} with clearance", fine, max(counts), WIDE_CLEARANCE * fine.diagonal))
        with suppress(NestedCagesError):
            coarse = ArcLength().decimate(fine, min(most, max(OWN_COUNT, 6 * len(fine.loops))))
            found.append(Case(f"{name} and a coarse mesh", fine, coarse))
    return found


@contextmanager
def switched_off(patches: Mapping[str, Any]) -> Iterator[None]:
    """Replace "module:name" or "module:Class.name" of the core; what is `Around` the original is made from it."""
    undo: list[tuple[Any, str, Any]] = []
    try:
        for where, value in patches.items():
            module, _, path = where.partition(":")
            holder: Any = import_module(f"nestedcages_core.{module}")
            *outer, name = path.split(".")
            for part in outer:
                holder = getattr(holder, part)
            before = getattr(holder, name)
            undo.append((holder, name, before))
            setattr(holder, name, value.make(before) if isinstance(value, Around) else value)
        yield
    finally:
        for holder, name, before in reversed(undo):
            setattr(holder, name, before)


def watched(name: str, happened: Callable[[Sequence[Any], Any], bool], used: set[str]) -> Around:
    """The function, or the generator function, that notes the mechanism in `used` where a call uses it."""

    def make(function: Callable[..., Any]) -> Callable[..., Any]:
        def plain(*arguments: Any, **options: Any) -> Any:
            result = function(*arguments, **options)
            if happened(arguments, result):
                used.add(name)
            return result

        def stages(*arguments: Any, **options: Any) -> Iterator[Any]:
            result = yield from function(*arguments, **options)
            if happened(arguments, result):
                used.add(name)
            return result

        return stages if inspect.isgeneratorfunction(function) else plain

    return Around(make)


def run(job: tuple[Case, str | None]) -> Made:
    """Make the cage of a case with a mechanism off; None: as it is, noting which ones are used."""
    case, name = job
    mechanism = MECHANISMS[name] if name is not None else Mechanism("")
    used: set[str] = set()
    with ExitStack() as stack:
        stack.enter_context(switched_off(mechanism.patches))
        for other, probed in MECHANISMS.items() if name is None else ():
            stack.enter_context(
                switched_off({at: watched(other, happened, used) for at, happened in probed.probes.items()})
            )
        begin = time.process_time()
        try:
            settings = replace(mechanism.settings(), clearance=case.clearance)
            level = nested_cages(case.fine, [case.level], settings).levels[0]
        except NestedCagesError:
            return Made(False, float("nan"), time.process_time() - begin, "", tuple(sorted(used)))
        seconds = time.process_time() - begin
    certified = verify(level.cage, level.fine, level.report.wanted_clearance).holds
    return Made(certified, level.report.excess, seconds, level.report.start, tuple(sorted(used)))


@dataclass(frozen=True)
class Bought:
    """What a mechanism buys: what is lost when it is off."""

    successes: int
    flows: int
    """Cases that go the paper's way only with it."""
    mean: float
    worst: float
    worst_case: str
    time: float
    changed: int
    """Cases whose excess differs at all."""


def compare(with_it: Sequence[Made], without: Sequence[Made], all_cases: Sequence[Case]) -> Bought:
    """The difference over all cases."""
    lost = sum(a.certified for a in with_it) - sum(b.certified for b in without)
    flows = sum(a.start == "flow" for a in with_it) - sum(b.start == "flow" for b in without)
    both = [k for k in range(len(all_cases)) if with_it[k].certified and without[k].certified]
    ratios = np.array([(without[k].excess + SMALL_EXCESS) / (with_it[k].excess + SMALL_EXCESS) for k in both])
    worst = int(ratios.argmax())
    seconds = sum(b.seconds for b in without) / sum(a.seconds for a in with_it)
    mean = float(np.exp(np.log(ratios).mean()))
    changed = int((np.abs(ratios - 1.0) > 1e-6).sum())
    return Bought(lost, flows, mean, float(ratios[worst]), all_cases[both[worst]].name, seconds, changed)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = [kind.__name__ for kind in KINDS]
    parser.add_argument("--shapes", type=int, default=60, help="shapes, each in several cases")
    parser.add_argument("--kinds", nargs="+", default=names, choices=names, metavar="KIND", help="of random shapes")
    parser.add_argument("--largest", type=int, default=LARGEST, help="vertices of the largest shape")
    parser.add_argument("--only", nargs="+", default=None, metavar="NAME", help="mechanisms (default: all)")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--results", type=Path, help="JSON file that keeps what was made, read first if there")
    parser.add_argument("--output", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

    wanted = list(MECHANISMS) if options.only is None else [n for n in MECHANISMS if any(o in n for o in options.only)]
    chosen = cases(options.shapes, options.kinds, options.largest)
    stored = json.loads(options.results.read_text()) if options.results and options.results.exists() else {}
    with ProcessPoolExecutor(options.jobs, multiprocessing.get_context("spawn")) as pool:
        by_name: dict[str | None, list[Made]] = {}
        for name in [None, *wanted]:
            kept = stored.setdefault(name or "", {})
            missing = [case for case in chosen if case.name not in kept]
            if name is not None:
                missing = [case for case in missing if uses(name, Made(**stored[""][case.name]))]
            for case, made in zip(missing, pool.map(run, [(case, name) for case in missing]), strict=True):
                kept[case.name] = asdict(made)
                if options.results:
                    options.results.write_text(json.dumps(stored))
            by_name[name] = [Made(**kept.get(case.name, stored[""][case.name])) for case in chosen]
            print(table(by_name, chosen).splitlines()[-1], flush=True)
    if options.output:
        options.output.write_text(table(by_name, chosen), encoding="utf-8")
    return 0


def uses(name: str, as_it_is: Made) -> bool:
    """Whether a case can change without the mechanism."""
    return not MECHANISMS[name].probes or name in as_it_is.used


def table(made: Mapping[str | None, Sequence[Made]], chosen: Sequence[Case]) -> str:
    """A Markdown page."""
    as_it_is = made[None]
    certified = sum(each.certified for each in as_it_is)
    excess = np.mean([each.excess for each in as_it_is if each.certified])
    lines = [
        "# What each mechanism buys",
        "",
        "Made by `python benchmarks/ablation.py --output docs/ablation.md`: each mechanism is switched off alone.",
        "",
        f"{len(chosen)} cases; with everything on {certified} are certified, mean excess {100 * excess:.2f} %, "
        f"{sum(each.seconds for each in as_it_is):.0f} s of processor time. Excess and time are without the mechanism, "
        "relative to with it: above 1, it helps.",
        "",
        "| room | without | used in | cages lost | flows lost | excess, mean | worst | of case | time | changed |",
        "|---|---|---:|---:|---:|---:|---:|---|---:|---:|",
    ]
    for name, results in made.items():
        if name is None:
            continue
        bought = compare(as_it_is, results, chosen)
        used = sum(uses(name, each) for each in as_it_is)
        lines.append(
            f"| {MECHANISMS[name].room} | {name} | {used} | {bought.successes} | {bought.flows} | {bought.mean:.4f} "
            f"| {bought.worst:.3f} | {bought.worst_case} | {bought.time:.2f} | {bought.changed} |"
        )
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    sys.exit(main())
