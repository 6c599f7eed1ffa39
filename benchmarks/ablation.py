"""What each mechanism buys: it is switched off alone, and cages are made of the same shapes as with it.

    python benchmarks/ablation.py --shapes 150 --output docs/ablation.md

First a quick pass, decimation and flow only, finds the cases in which rare mechanisms are used. Then cages are made
with and without each mechanism: of the first cases that use it, or of cases of all kinds where every case does. Prints
what is lost without it: cages, and starts on the curve; the excess relative to that with it (mean and worst; above 1 it
helps); and time. Mechanisms are switched off by settings where there are some, otherwise by replacing a constant or a
function of the core (mechanisms.py); a name that is no longer there is an error. A mechanism that buys nothing is to be
removed. `--results FILE` keeps what was made, so that a long run can be made in parts.
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
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from dataclasses import asdict, dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

import clone  # noqa: F401
from data import shape, shape_names
from growth import KINDS as GROWING
from mechanisms import MECHANISMS, Around, Mechanism
from nestedcages_core import (
    ArcLength,
    Mesh,
    NestedCagesError,
    NestingError,
    OnCurve,
    OuterHull,
    TwoSidedFlow,
    nested_cages,
    verify,
)
from nestedcages_core.cache import forget
from nestedcages_core.level.choices import DEFAULT_CLEARANCE
from nestedcages_core.level.units import SolverUnits
from nestedcages_core.tasks import drain
from random_shapes import KINDS, random_shape
from stress import SMALLEST_POSSIBLE

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

REMOVED = """\
Mechanisms that earlier runs of this program found to buy nothing are gone. With the mean excess without them, relative
to that with them, and the time:

- the flow's last resort, the fine mesh laid along the coarse one: no cage came of it
- hulls around a smaller offset where the first search fails: 1.0000, time 0.55, no cage lost
- rescues that start from the outline itself: 1.0000, time 0.99
- a second outline to restart from, made with even weights: 1.0000, time 0.96
- restarts that vary the spike term alone: 0.9951, time 0.99
- a shift of the Hessian in the trust region: 1.0003, time 0.95
- parts of the cage that give way to each other in the quadratic program: 1.0000, time 0.94
- a fraction of its own for every vertex in the widening: 1.0000, time 0.96
- more than three trials of a step, with neighbours slowed down and stopped: 1.0000, time 0.98
- IPC before sequential quadratic programs on small meshes: 0.9991, time 0.65

Eight restarts, six of them with random weights, became five with weights that complement each other; these became up to
three restarts that end in five ways each, and the three starts two.
"""
"""What is gone because it bought nothing."""

STAYS = """\
What buys nothing here and stays: gaps and details at round-off scale, which random shapes do not have and hostile ones
do; counts per loop shared out anew, since the alternative is an error; and what helps IPC, which is the paper's contact
and comes second to sequential quadratic programs: see [the comparison](comparison.md).
"""
"""Why some rows that show no gain are there."""

HEAD = (
    "| room | without | used | compared | lost | flows | excess, mean | worst | of case | time | changed |",
    "|---|---|---:|---:|---:|---:|---:|---:|---|---:|---:|",
)
"""Of the tables."""

LARGE = (
    "pruning of implied constraints",
    "thinning of nearly implied constraints",
    "radius per vertex",
    "overshoot of restoration",
)
"""Mechanisms that are there for large meshes."""

LARGE_SIZE, LARGE_COUNT = 8_000, 256
"""Vertices of the large shapes and of their cages."""

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


def fewest(chosen: Sequence[Case]) -> list[Case]:
    """For cases whose count is refused, the smallest count that hulls are found for."""
    found = []
    for case in chosen:
        if isinstance(case.level, Mesh) or case.level > max(FEWEST, 3 * len(case.fine.loops)):
            continue
        try:
            OuterHull().decimate(case.fine, case.level)
        except NestingError as refusal:
            if smallest := SMALLEST_POSSIBLE.search(str(refusal)):
                found.append(replace(case, name=f"{case.name}, in fact {smallest[1]}", level=int(smallest[1])))
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


@contextmanager
def watching(used: set[str]) -> Iterator[None]:
    """Note the mechanisms that are used."""
    with ExitStack() as stack:
        for name, mechanism in MECHANISMS.items():
            patches = {at: watched(name, happened, used) for at, happened in mechanism.probes.items()}
            stack.enter_context(switched_off(patches))
        yield


def run(job: tuple[Case, str | None]) -> Made:
    """Make the cage of a case with a mechanism off; None: as it is, noting which ones are used."""
    case, name = job
    mechanism = MECHANISMS[name] if name is not None else Mechanism("")
    used: set[str] = set()
    forget()  # what was made with other mechanisms
    with switched_off(mechanism.patches), watching(used) if name is None else nullcontext():
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


def probe(case: Case) -> list[str]:
    """The mechanisms that decimation and flow of a case use, of those with probes."""
    used: set[str] = set()
    clearance = DEFAULT_CLEARANCE * case.fine.diagonal if case.clearance is None else case.clearance
    forget()
    with watching(used), suppress(NestedCagesError):
        coarse: Mesh | None = case.level if isinstance(case.level, Mesh) else None
        if not isinstance(case.level, Mesh):
            coarse = drain(OnCurve().starts(case.fine, case.level, clearance=clearance, most=1))[0].on_curve
        if coarse is not None:
            units = SolverUnits.of(case.fine)
            drain(TwoSidedFlow().run(units.from_input(case.fine), units.from_input(coarse)))
    return sorted(used)


def compare(with_it: Sequence[Made], without: Sequence[Made], all_cases: Sequence[Case]) -> Bought:
    """The difference over all cases."""
    lost = sum(a.certified for a in with_it) - sum(b.certified for b in without)
    flows = sum(a.start == "flow" for a in with_it) - sum(b.start == "flow" for b in without)
    both = [k for k in range(len(all_cases)) if with_it[k].certified and without[k].certified]
    if not both:
        return Bought(lost, flows, 1.0, 1.0, "", 1.0, 0)
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
    parser.add_argument("--rare", type=int, default=30, help="cages of cases that use a mechanism, at most")
    parser.add_argument("--common", type=int, default=60, help="cages for a mechanism that every case uses")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--results", type=Path, help="JSON file that keeps what was made, read first if there")
    parser.add_argument("--output", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

    wanted = list(MECHANISMS) if options.only is None else [n for n in MECHANISMS if any(o in n for o in options.only)]
    chosen = cases(options.shapes, options.kinds, options.largest)
    everything = fewest(chosen) + chosen
    store = Store(options.results)
    with ProcessPoolExecutor(options.jobs, multiprocessing.get_context("spawn")) as pool:
        store.probe(everything, pool)
        spread = chosen[:: max(1, len(chosen) // options.common)][: options.common]
        store.make(spread, None, pool)
        rows = []
        for name in wanted:
            if MECHANISMS[name].probes:
                using = [case for case in everything if store.uses(case, name)]
                compared = using[: options.rare]
            else:
                using, compared = everything, spread
            store.make(compared, None, pool)
            store.make(compared, name, pool)
            bought = compare([store.made(c, None) for c in compared], [store.made(c, name) for c in compared], compared)
            rows.append(row(name, len(using), len(compared), bought))
            print(rows[-1], flush=True)
        large = [
            Case(f"{kind}, {LARGE_SIZE} vertices, at {LARGE_COUNT}", make(LARGE_SIZE), LARGE_COUNT)
            for kind, make in GROWING.items()
        ]
        store.make(large, None, pool)
        large_rows = []
        for name in (name for name in LARGE if name in wanted):
            store.make(large, name, pool)
            bought = compare([store.made(c, None) for c in large], [store.made(c, name) for c in large], large)
            large_rows.append(row(name, len(large), len(large), bought))
            print(large_rows[-1], flush=True)
    if options.output:
        options.output.write_text(page(rows, large_rows, len(everything), options), encoding="utf-8")
    return 0


class Store:
    """What was made so far, kept in a file."""

    def __init__(self, path: Path | None) -> None:
        self.path = path
        known = json.loads(path.read_text(encoding="utf-8")) if path and path.exists() else {"used": {}, "made": {}}
        self.used, self._made = known["used"], known["made"]

    def probe(self, chosen: Sequence[Case], pool: Executor) -> None:
        """Find the mechanisms that cases use."""
        missing = [case for case in chosen if case.name not in self.used]
        for case, used in zip(missing, pool.map(probe, missing), strict=True):
            self.used[case.name] = used
            self._save()

    def make(self, chosen: Sequence[Case], name: str | None, pool: Executor) -> None:
        """Make the cages of cases with a mechanism off."""
        missing = [case for case in chosen if f"{case.name}: {name}" not in self._made]
        for case, made in zip(missing, pool.map(run, [(case, name) for case in missing]), strict=True):
            self._made[f"{case.name}: {name}"] = asdict(made)
            self._save()

    def made(self, case: Case, name: str | None) -> Made:
        """The outcome of a case."""
        return Made(**self._made[f"{case.name}: {name}"])

    def uses(self, case: Case, name: str) -> bool:
        """Whether a case is known to use a mechanism."""
        return name in self.used[case.name] or name in self._made.get(f"{case.name}: None", {}).get("used", ())

    def _save(self) -> None:
        if self.path:
            self.path.write_text(json.dumps({"used": self.used, "made": self._made}), encoding="utf-8")


def row(name: str, used: int, compared: int, bought: Bought) -> str:
    """A line of the table."""
    return (
        f"| {MECHANISMS[name].room} | {name} | {used} | {compared} | {bought.successes} | {bought.flows} "
        f"| {bought.mean:.4f} | {bought.worst:.3f} | {bought.worst_case} | {bought.time:.2f} | {bought.changed} |"
    )


def page(rows: Sequence[str], large_rows: Sequence[str], count: int, options: argparse.Namespace) -> str:
    """A Markdown page."""
    kinds = "" if len(options.kinds) == len(KINDS) else f" --kinds {' '.join(options.kinds)}"
    lines = [
        "# What each mechanism buys",
        "",
        REMOVED,
        "",
        f"Made by `python benchmarks/ablation.py --shapes {options.shapes}{kinds} --largest {options.largest} --rare "
        f"{options.rare} --common {options.common} --output docs/ablation.md`. Each mechanism is switched off alone, "
        f"and the same cages are made with and without it. Of {count} cases, *used* is how many are known to use it, "
        "*compared* of how many cages are made twice. *Lost* are cages that cannot be made without it, *flows* those "
        "that start on the curve only with it. Excess and time are without the mechanism, relative to with it: above "
        "1, it helps. A cage is *changed* if its excess differs at all.",
        "",
        *HEAD,
        *rows,
        "",
        f"The same at {LARGE_SIZE:,} vertices and {LARGE_COUNT} of the cage, for what is there for large meshes:",
        "",
        *HEAD,
        *large_rows,
        "",
        STAYS,
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
