"""Mutation tests of the exact parts: every small change of their code must make a test fail.

Run as ``python packaging/mutants.py``: all files of `TESTS`, which takes hours. ``--most 20`` tries so many changes of
each file, spread evenly, ``--changed main`` only files that differ from a commit, and names of files only these.
``--by-hand`` puts in the faults of `by_hand.py`, which went unnoticed once. Exit status 1 if a change survives that is
not in `survivors.json`, which says of each why no test can see it. Needs fork, so Linux or macOS.
"""

from __future__ import annotations

import argparse
import ast
import difflib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from importlib.machinery import SourceFileLoader
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[1]
CORE = "nestedcages_core/"
SURVIVORS = Path(__file__).with_name("survivors.json")
TESTS = {
    "geometry/predicates/": "test_predicates.py",
    "geometry/mesh/nesting.py": "test_nesting.py test_verification.py",
    "geometry/grid.py": "test_grid.py",
    "verification/certificate.py": "test_verification.py",
    "verification/motion.py": "test_motion.py test_deliberate_faults.py",
    "verification/linear_motion.py": "test_motion.py",
    "tolerance/": "test_deliberate_faults.py test_checker.py",
    "checker.py": "test_checker.py",
    "checker_distance.py": "test_checker.py",
}
"""Tests of each file, or of each file of a folder; the first one that fails is enough."""

SURVIVED, SECONDS = 0, 30
"""Exit status of pytest where all tests pass, and time beyond three times that of the tests without a change."""

SWAPS: dict[type, type] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.And: ast.Or, ast.Or: ast.And,
    ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.USub: ast.UAdd,
    ast.FloorDiv: ast.Mult, ast.Pow: ast.Mult,
}  # fmt: skip
"""What each operator becomes."""

SCALE = 1.02
"""Factor on floating-point constants."""


class Mutant(NamedTuple):
    """One change of a file."""

    path: str
    line: int
    before: str
    after: str
    source: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.before}  ->  {self.after}"


def mutants(path: str, source: str) -> Iterator[Mutant]:
    """Every change of a file, each alone."""
    count = sum(1 for _ in _changes(ast.parse(source)))
    original = ast.unparse(ast.parse(source)).splitlines()
    for number in range(count):
        tree = ast.parse(source)
        line, change = next(each for k, each in enumerate(_changes(tree)) if k == number)
        change()
        changed = ast.unparse(ast.fix_missing_locations(tree))
        lines = [each for each in difflib.ndiff(original, changed.splitlines()) if each[0] in "-+"]
        before, after = (" ".join(each[2:].strip() for each in lines if each[0] == sign) for sign in "-+")
        if before != after:
            yield Mutant(path, line, before, after, changed)


def _changes(tree: ast.AST) -> Iterator[tuple[int, Callable[[], object]]]:
    """Line and action of each change of a tree; messages, annotations and docstrings stay."""
    for node in _judged(tree):
        line = getattr(node, "lineno", 0)
        if isinstance(node, ast.Compare):
            for k, operator in enumerate(node.ops):
                if type(operator) in SWAPS:
                    yield line, lambda n=node, k=k, o=operator: n.ops.__setitem__(k, SWAPS[type(o)]())
        elif isinstance(node, ast.BinOp | ast.BoolOp | ast.UnaryOp | ast.AugAssign) and type(node.op) in SWAPS:
            yield line, lambda n=node: setattr(n, "op", SWAPS[type(n.op)]())
        elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
            yield line, lambda n=node: setattr(n, "value", not n.value)
        elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            new = node.value + 1 if isinstance(node.value, int) or node.value == 0.0 else node.value * SCALE
            yield line, lambda n=node, new=new: setattr(n, "value", new)
        if isinstance(node, ast.If | ast.IfExp | ast.While):
            for value in (True, False) if not isinstance(node, ast.While) else (False,):
                yield line, lambda n=node, value=value: setattr(n, "test", ast.Constant(value))
        for name in ("body", "orelse"):
            block = getattr(node, name, None)
            for k, statement in enumerate(block if isinstance(block, list) else ()):
                if isinstance(statement, ast.AugAssign) or (
                    isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call | ast.Yield)
                ):
                    yield statement.lineno, lambda b=block, k=k: b.__setitem__(k, ast.Pass())


def _judged(node: ast.AST) -> Iterator[ast.AST]:
    """The node and all below it whose change a test should see."""
    if isinstance(node, ast.Raise | ast.JoinedStr | ast.Assert):
        return
    yield node
    for name, value in ast.iter_fields(node):
        if name in {"annotation", "returns", "decorator_list"}:
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _judged(child)


class Trial(NamedTuple):
    """A process that runs tests on changed code."""

    mutant: Mutant
    began: float


def start(mutant: Mutant, tests: list[str], limit: float) -> int:
    """The process that runs tests on the changed code; it ends with pytest's exit status, or at the limit."""
    process = os.fork()
    if process:
        return process
    try:
        signal.alarm(int(limit))
        quiet = os.open(os.devnull, os.O_WRONLY)
        os.dup2(quiet, 1)
        os.dup2(quiet, 2)
        target, read = str(ROOT / mutant.path), SourceFileLoader.get_code

        def get_code(loader: SourceFileLoader, name: str) -> Any:
            changed = mutant.source and loader.path == target
            return compile(mutant.source, target, "exec") if changed else read(loader, name)

        SourceFileLoader.get_code = get_code  # type: ignore[method-assign]
        import pytest

        chosen = [
            "-x",
            "-q",
            "-m",
            "not slow and not thorough",
            "-p",
            "no:cacheprovider",
            "-p",
            "no:xdist",
            "--timeout",
            "0",
        ]
        os._exit(int(pytest.main([*chosen, *tests])))
    except BaseException:  # a fork must never go on as its parent would
        os._exit(70)


def tried(each: list[Mutant], tests: list[str], jobs: int) -> Iterator[tuple[Mutant, bool]]:
    """Each change with whether it survives, as they end. Raises SystemExit if the tests fail without a change."""
    began = time.monotonic()
    _, status = os.waitpid(start(Mutant("", 0, "", "", ""), tests, 3600), 0)
    if status != SURVIVED:
        raise SystemExit(f"The tests fail without any change: {' '.join(tests)}")
    limit = 3.0 * (time.monotonic() - began) + SECONDS
    waiting, running = list(each), {}
    while waiting or running:
        while waiting and len(running) < jobs:
            mutant = waiting.pop(0)
            running[start(mutant, tests, limit)] = mutant
        process, status = os.wait()
        yield running.pop(process), status == SURVIVED


def tests_of(path: str) -> list[str]:
    """The tests of a file of the core."""
    names = next((tests for part, tests in TESTS.items() if path.removeprefix(CORE).startswith(part)), "")
    return [str(ROOT / "tests" / "core" / name) for name in names.split()]


def by_hand(jobs: int) -> list[Mutant]:
    """The faults put in by hand that survive the test which is to catch them."""
    from by_hand import FAULTS

    survivors = []
    for fault in FAULTS:
        source = (ROOT / fault.path).read_text(encoding="utf-8")
        if source.count(fault.before) != 1:
            raise SystemExit(f"{fault.path} has {source.count(fault.before)} places for the fault {fault.before!r}")
        mutant = Mutant(fault.path, 0, fault.before, fault.after, source.replace(fault.before, fault.after))
        for _, survives in tried([mutant], [str(ROOT / fault.test)], jobs):
            print(f"{'SURVIVES' if survives else 'caught'}: {mutant}", flush=True)
            survivors += [mutant] if survives else []
    return survivors


def main() -> int:
    """Run the command; the exit status."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("files", nargs="*", help="files of the core, from the project's root")
    options.add_argument("--changed", metavar="COMMIT", help="only files that differ from this commit")
    options.add_argument("--most", type=int, metavar="N", help="try at most so many changes of each file")
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
        return int(bool(by_hand(given.jobs)))
    files = given.files or [path.as_posix() for path in sorted(Path(CORE).rglob("*.py"))]
    if given.changed:
        command = ["git", "diff", "--name-only", given.changed, "--", CORE]
        differing = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
        files = [path for path in files if path in differing]
    explained = json.loads(SURVIVORS.read_text(encoding="utf-8"))
    known = {(each["file"], each["before"], each["after"]) for each in explained}
    new = total = 0
    for path in files:
        if not tests_of(path):
            continue
        each = list(mutants(path, Path(path).read_text(encoding="utf-8")))
        each = each[:: max(1, -(-len(each) // given.most))] if given.most else each
        killed = 0
        for mutant, survives in tried(each, tests_of(path), given.jobs):
            killed += not survives
            if survives and (mutant.path, mutant.before, mutant.after) not in known:
                new += 1
                print(f"SURVIVES: {mutant}", flush=True)
        total += len(each)
        print(f"{path}: {killed} of {len(each)} caught", flush=True)
    print(f"{total} changes tried, {new} survive unexplained.")
    return int(bool(new))


if __name__ == "__main__":
    sys.exit(main())
