"""Mutation tests of the exact parts: every small change of their code must make a test fail.

Run as ``python packaging/mutants.py``: all files of `TESTS`. Names of files or folders try only these, ``--changed
main`` only files that differ from a commit, and ``--most 20`` so many changes of each line of `TESTS`, spread evenly.
``--by-hand`` puts in the faults of `by_hand.py`, which went unnoticed once. Exit status 1 if a change survives that is
not in `survivors.json`, which says of each why no test can see it. Needs fork, so Linux or macOS.

The tests of a line run once with the code as it is, to learn which of them pass which line of code. A change in a
function gets a fork of a process that has read the tests, in which these run, fastest first, until one fails. What is
decided on import is tried in a process that has imported nothing.
"""

from __future__ import annotations

import argparse
import functools
import gc
import importlib
import inspect
import json
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType, FrameType, FunctionType
from typing import Any, NamedTuple

from changes import Mutant, mutants, plain

ROOT = Path(__file__).resolve().parents[1]
CORE = "nestedcages_core/"
SURVIVORS = Path(__file__).with_name("survivors.json")
TESTS = {
    "geometry/predicates/": "test_predicates.py test_nesting.py test_deliberate_faults.py",
    "geometry/mesh/nesting.py": "test_nesting.py test_verification.py",
    "verification/certificate.py": "test_verification.py",
    "verification/motion.py": "test_motion.py test_deliberate_faults.py",
    "tolerance/": "test_outcomes.py test_tolerance.py test_deliberate_faults.py test_gate.py test_checker.py",
    "decimation/merging.py": "test_merging.py",
    "decimation/line_cycles/": "test_outcomes.py test_line_cycles_oracle.py test_line_cycles.py test_counts.py "
    "test_loops.py test_needs_together.py test_symmetry.py test_priorities.py test_constraints.py",
    "level/": "test_outcomes.py test_gate.py test_attempts.py test_guarantees.py test_stages.py test_line_cycles.py "
    "test_inner_cages.py test_hierarchy.py test_loops.py test_errors.py test_limits.py test_grid.py test_counts.py",
    "motion/": "test_outcomes.py test_gate.py test_animated_cages.py test_sequence.py test_deliberate_faults.py "
    "test_constraints.py test_stages.py test_convex_cages.py test_swept.py",
    "constraints/": "test_outcomes.py test_constraints.py test_needs_together.py test_grid.py test_convex_cages.py "
    "test_symmetry.py test_strange_constraints.py test_axis_aligned.py test_priorities.py test_gate.py test_imports.py",
    "checker.py": "test_checker.py",
    "checker_distance.py": "test_checker.py",
}
"""Tests of each file, or of each file of a folder; the first one that fails is enough."""

SURVIVED, FACTOR, SECONDS, HOURS = 0, 5.0, 30.0, 7200
"""Exit status where all tests pass, and the time that tests of changed code get: so many times what they took, and so
much more; and seconds that all of it gets."""


class Trial(NamedTuple):
    """Tests on changed code: `run` returns pytest's exit status."""

    what: Any
    limit: float
    run: Callable[[], int]


def tried(trials: list[Trial], jobs: int) -> Iterator[tuple[Any, bool]]:
    """What is tried with whether it survives, as they end, in processes of their own."""
    waiting, running = list(trials), {}
    while waiting or running:
        while waiting and len(running) < jobs:
            trial = waiting.pop(0)
            running[_forked(trial)] = trial.what
        process, status = os.wait()
        if process in running:
            yield running.pop(process), status == SURVIVED


def _forked(trial: Trial) -> int:
    """The process of a trial, which is ended at the limit."""
    process = os.fork()
    if process:
        return process
    try:
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(int(trial.limit) + 1)
        os._exit(trial.run())
    except BaseException:  # a fork must never go on as its parent would
        os._exit(70)


def fresh(mutant: Mutant | None, tests: list[str], seconds: float) -> Trial:
    """Tests that import the changed code, until one fails."""
    target, read = mutant and str(ROOT / mutant.path), SourceFileLoader.get_code

    def get_code(loader: SourceFileLoader, name: str) -> Any:
        return compile(mutant.source, target, "exec") if mutant and loader.path == target else read(loader, name)

    def run() -> int:
        SourceFileLoader.get_code = get_code  # type: ignore[method-assign]
        return _pytest(["-x", "-m", "not slow and not thorough", *tests])

    return Trial(mutant, FACTOR * seconds + SECONDS, run)


def _pytest(words: list[str], *plugins: object) -> int:
    """pytest's exit status, without a word of it."""
    import pytest

    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1)
    os.dup2(quiet, 2)
    options = ["-q", "-s", "-p", "no:cacheprovider", "-p", "no:xdist", "--timeout=0", f"--session-timeout={HOURS}"]
    return int(pytest.main([*options, *words], plugins=list(plugins)))


Functions = dict[tuple[str, str], CodeType]
"""Those of files, by file and name."""


class Session:
    """A plugin of pytest that tries changes of files in forks, by the tests that pass their lines."""

    def __init__(self, mutants: list[Mutant], jobs: int) -> None:
        self.mutants, self.jobs = mutants, jobs
        self.targets = {str(ROOT / mutant.path) for mutant in mutants}
        for path in {mutant.path for mutant in mutants}:  # what is imported in a fork would be as it was
            importlib.import_module(path.removesuffix(".py").removesuffix("/__init__").replace("/", "."))
        self.failed = False
        self.survivors: list[int] = []
        self.on_import: list[int] = []
        """Changes that can only be tried by importing them."""

    def pytest_runtest_logreport(self, report: Any) -> None:
        self.failed |= report.failed

    def pytest_runtestloop(self, session: Any) -> bool:
        with tempfile.NamedTemporaryFile() as file:
            self._require(lambda: self._observed(session, file.name))
            passed, seconds = pickle.loads(Path(file.name).read_bytes())
        before: Functions = {}
        rest: dict[str, list[Any]] = {}
        for target in self.targets:
            functions, rest[target] = _taken_apart(plain(Path(target).read_text(encoding="utf-8")), target)
            before |= functions
        self._require(lambda: self._caught(session, range(len(seconds)), before))
        trials = []
        for number, mutant in enumerate(self.mutants):
            target = str(ROOT / mutant.path)
            after, other = _taken_apart(mutant.source, target)
            if rest[target] != other:
                self.on_import.append(number)
                continue
            found = (passed.get((target, line), ()) for line in mutant.lines)
            order = sorted(set().union(*found), key=seconds.__getitem__)
            limit = FACTOR * sum(seconds[test] for test in order) + SECONDS
            trials.append(Trial(number, limit, functools.partial(self._caught, session, order, after)))
        self.survivors = [number for number, survives in tried(trials, self.jobs) if survives]
        return True

    def _require(self, run: Callable[[], int]) -> None:
        require([Trial(None, HOURS, run)])

    def _run(self, session: Any, number: int) -> None:
        item = session.items[number]
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=None)

    def _observed(self, session: Any, path: str) -> int:
        """Writes which tests pass each line, and the seconds that each takes; 1 if one of them fails."""
        passed, seconds = defaultdict(set), []

        def called(frame: FrameType, event: str, _: object) -> Any:
            return at_line if frame.f_code.co_filename in self.targets else None

        def at_line(frame: FrameType, event: str, _: object) -> Any:
            passed[frame.f_code.co_filename, frame.f_lineno].add(len(seconds))
            return at_line

        for number in range(len(session.items)):
            began = time.monotonic()
            sys.settrace(called)
            self._run(session, number)
            sys.settrace(None)
            seconds.append(time.monotonic() - began)
        Path(path).write_bytes(pickle.dumps((dict(passed), seconds)))
        return int(self.failed)

    def _caught(self, session: Any, order: Iterable[int], functions: Functions) -> int:
        """1 if one of the tests fails with these functions, else 0."""
        for each in gc.get_objects():
            if isinstance(each, FunctionType):
                code = each.__code__
                each.__code__ = functions.get((code.co_filename, code.co_qualname), code)
        for number in order:
            self._run(session, number)
            if self.failed:
                return 1
        return SURVIVED


def _taken_apart(source: str | CodeType, file: str) -> tuple[Functions, list[Any]]:
    """The functions of a module or class, and all that is decided on import."""
    code = compile(source, file, "exec") if isinstance(source, str) else source
    functions: Functions = {}
    rest: list[Any] = [code.co_code, code.co_names]
    for constant in code.co_consts:
        if not isinstance(constant, CodeType):
            rest.append(repr(constant))
        elif constant.co_flags & inspect.CO_OPTIMIZED:
            functions[file, constant.co_qualname] = constant
        else:
            inner, others = _taken_apart(constant, file)
            functions |= inner
            rest += others
    return functions, rest


def survivors(tests: list[str], each: list[Mutant], jobs: int) -> Iterator[Mutant]:
    """The changes that survive tests. Raises SystemExit if these fail without a change."""
    with tempfile.NamedTemporaryFile() as file:

        def run() -> int:
            session = Session(each, jobs)
            status = _pytest(tests, session)
            Path(file.name).write_bytes(pickle.dumps((session.survivors, session.on_import)))
            return status

        require([Trial(None, HOURS, run)])
        found, on_import = pickle.loads(Path(file.name).read_bytes())
    yield from (each[number] for number in found)
    again = [fresh(each[number], tests, SECONDS) for number in on_import]
    if again:
        require([fresh(None, tests, HOURS)])
    yield from (mutant for mutant, survives in tried(again, jobs) if survives)


def require(trials: list[Trial]) -> None:
    """Raise SystemExit if tests fail without any change, which would count as a catch."""
    if not all(passed for _, passed in tried(trials, 1)):
        raise SystemExit("The tests fail without any change.")


def part_of(path: str) -> str | None:
    """The line of `TESTS` that a file of the core belongs to."""
    return next((part for part in TESTS if path.removeprefix(CORE).startswith(part)), None)


def by_hand(jobs: int) -> int:
    """How many of the faults put in by hand survive the test which is to catch them."""
    from by_hand import FAULTS

    trials = []
    for fault in FAULTS:
        source = (ROOT / fault.path).read_text(encoding="utf-8")
        if source.count(fault.before) != 1:
            raise SystemExit(f"{fault.path} has {source.count(fault.before)} places for the fault {fault.before!r}")
        changed = source.replace(fault.before, fault.after)
        trials.append(fresh(Mutant(fault.path, range(0), fault.before, fault.after, changed), [fault.test], 60.0))
    require([fresh(None, sorted({fault.test for fault in FAULTS}), HOURS)])
    count = 0
    for mutant, survives in tried(trials, jobs):
        print(f"{'SURVIVES' if survives else 'caught'}: {mutant.path}: {mutant}", flush=True)
        count += survives
    return count


def main() -> int:
    """Run the command; the exit status."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("files", nargs="*", help="files or folders of the core, from the project's root")
    options.add_argument("--changed", metavar="COMMIT", help="only files that differ from this commit")
    options.add_argument("--most", type=int, metavar="N", help="try at most so many changes of each line of TESTS")
    options.add_argument("--jobs", type=int, default=2, metavar="N", help="processes (default: 2)")
    options.add_argument("--by-hand", action="store_true", help="put in the faults of by_hand.py instead")
    given = options.parse_args()
    if not hasattr(os, "fork"):
        options.exit(2, "Mutants need fork: run this on Linux or macOS.\n")
    os.chdir(ROOT)
    import hypothesis
    import pytest
    import scipy.spatial
    import shapely

    assert all((hypothesis, pytest, scipy, shapely))  # imported once, before the forks
    if given.by_hand:
        return int(by_hand(given.jobs) > 0)
    files = [path.as_posix() for path in sorted(Path(CORE).rglob("*.py"))]
    if given.files:
        files = [path for path in files if any(path.startswith(name) for name in given.files)]
    if given.changed:
        command = ["git", "diff", "--name-only", given.changed, "--", CORE]
        differing = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
        files = [path for path in files if path in differing]
    explained = json.loads(SURVIVORS.read_text(encoding="utf-8"))
    new = total = 0
    for part, names in TESTS.items():
        began, each, known = time.monotonic(), list[Mutant](), 0
        for path in (path for path in files if part_of(path) == part):
            reasons = {change for changes in explained.get(path, {}).values() for change in changes}
            every = list(mutants(path, Path(path).read_text(encoding="utf-8")))
            for change in reasons - {str(mutant) for mutant in every}:
                print(f"NO LONGER A CHANGE: {path}: {change}", flush=True)
                new += 1
            each += [mutant for mutant in every if str(mutant) not in reasons]
            known += len(reasons)
        each = each[:: max(1, -(-len(each) // given.most))] if given.most else each
        if not each:
            continue
        found = 0
        for mutant in survivors([str(ROOT / "tests" / "core" / name) for name in names.split()], each, given.jobs):
            print(f"SURVIVES: {mutant.path}:{mutant.lines.start}: {mutant}", flush=True)
            found += 1
        new += found
        total += len(each)
        seconds = time.monotonic() - began
        print(f"{part}: {len(each) - found} of {len(each)} caught, {known} explained, {seconds:.0f} s", flush=True)
    print(f"{total} changes tried, {new} survive unexplained.")
    return int(bool(new))


if __name__ == "__main__":
    sys.exit(main())
