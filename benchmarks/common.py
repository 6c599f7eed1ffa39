"""What benchmarks share: their options, processes with the package of another commit, and tables of plain text."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from select import select
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent

FAILED = "FAILED"  # in a table: something that must not be. The exit status of the command is then 1
DETAILS = "Details"  # a line of this alone separates what pages show from what only docs/measured keeps


@dataclass(frozen=True)
class Options:
    """What a benchmark is asked for."""

    quick: bool = False  # a small part of the work, within about ten seconds
    against: Path | None = None  # a checkout of another commit, whose package is measured side by side
    commit: str = ""  # the name of that commit
    seed: int = 0
    meshes: Path | None = None  # a folder with the meshes of the paper, which are not ours to distribute
    only: tuple[str, ...] = ()  # words, one of which the name of a part has to contain; all parts if there are none

    def wants(self, name: str) -> bool:
        return not self.only or any(word in name for word in self.only)

    def trees(self) -> dict[str, Path]:
        """What is measured: the other commit if there is one, and this clone."""
        return {**({self.commit: self.against} if self.against else {}), "now": ROOT}


@contextmanager
def checkout(commit: str) -> Iterator[Path]:
    """A temporary work tree of a commit; a folder is taken as it is."""
    if (Path(commit) / "nestedcages_core").is_dir():
        yield Path(commit).resolve()
        return
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "tree"
        git = ["git", "-C", str(ROOT), "worktree"]
        subprocess.run([*git, "add", "--detach", "--quiet", str(tree), commit], check=True)
        try:
            yield tree
        finally:
            subprocess.run([*git, "remove", "--force", str(tree)], check=True)


class ServerError(RuntimeError):
    """What a function in a server raised, as one line."""


class Server:
    """A process that runs a function of a benchmark, "golden:outcome", with the package of one checkout.

    Arguments and results are pickled: arrays and plain values, no objects of the package, which may differ.
    """

    def __init__(self, tree: Path, function: str) -> None:
        self.tree, self.function = tree, function
        self._start()

    def _start(self) -> None:
        self.process = subprocess.Popen(
            [sys.executable, str(HERE / "common.py"), str(self.tree), self.function],
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
            cwd=self.tree,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )

    def __call__(self, *arguments: object, patience: float | None = None) -> Any:
        """The result of the function; ServerError if it raises or takes longer than the patience in seconds."""
        assert self.process.stdin is not None and self.process.stdout is not None
        pickle.dump(arguments, self.process.stdin)
        self.process.stdin.flush()
        if not select([self.process.stdout], [], [], patience)[0]:
            self.close()
            self._start()
            raise ServerError(f"more than {patience:.0f} s")
        try:
            good, result = pickle.load(self.process.stdout)
        except EOFError:
            self.close()
            self._start()
            raise ServerError("the process ended") from None
        if not good:
            raise ServerError(result)
        return result

    def close(self) -> None:
        self.process.kill()
        self.process.wait()

    def __enter__(self) -> Server:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def serve(tree: str, function: str) -> None:
    """In a server: the answers to all requests that come in."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints must not get between the answers
    sys.path[:0] = [tree, str(HERE)]
    module, _, name = function.partition(":")
    call = getattr(import_module(module), name)
    with suppress(EOFError):
        while True:
            arguments = pickle.load(sys.stdin.buffer)
            try:
                answer = True, call(*arguments)
            except Exception as error:
                answer = False, " ".join((str(error) or type(error).__name__).split())
            pickle.dump(answer, answers)
            answers.flush()


def forget() -> None:
    """Empties the memory of results that some commits have, for times that do not depend on what was before."""
    with suppress(ImportError):
        import_module("nestedcages_core.cache").forget()


def table(headings: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Rows under their headings, the first column aligned to the left, the others to the right."""
    texts = [[cell(value) for value in row] for row in (headings, *rows)]
    widths = [max(map(len, column)) for column in zip(*texts, strict=True)]
    return "\n".join(
        "  ".join(f"{text:{'>' if k else '<'}{width}}" for k, (text, width) in enumerate(zip(row, widths, strict=True)))
        .rstrip()
        for row in texts
    )  # fmt: skip


def parts(tables: Mapping[str, str]) -> str:
    """Several tables by name; a page has a place for each: ``<!-- table BENCHMARK_NAME -->``."""
    return "\n\n".join(f"[{name}]\n{text}" for name, text in tables.items())


def cell(value: object) -> str:
    """Text as it is; numbers with four digits; a dash where there is none."""
    if value is None or (isinstance(value, float) and np.isnan(value)):
        return "-"
    if isinstance(value, (float, np.floating)):
        return f"{value:.0f}" if abs(value) >= 1e4 else f"{value:.4g}"
    return str(value)


def spread(values: Sequence[float], digits: int = 3) -> str:
    """Median, and the range of the middle eight tenths, of the numbers that are finite."""
    finite = np.asarray(values, dtype=float)
    finite = finite[np.isfinite(finite)]
    if not len(finite):
        return "-"
    low, middle, high = np.percentile(finite, (10.0, 50.0, 90.0))
    return f"{middle:.{digits}f} ({low:.{digits}f} … {high:.{digits}f})"


def ratios(values: Sequence[float], digits: int = 3) -> str:
    """Of ratios: geometric mean, median, the least and the worst."""
    found = np.asarray(values, dtype=float)
    if not len(found):
        return "none"
    mean, median = np.exp(np.log(found).mean()), np.median(found)
    return f"geometric mean {mean:.{digits}f}, median {median:.{digits}f}, " \
           f"least {found.min():.{digits}f}, worst {found.max():.{digits}f}"  # fmt: skip


if __name__ == "__main__":
    serve(*sys.argv[1:])
