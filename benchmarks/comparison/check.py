"""Whether the pages are what their runs say, and whether this code still gives such runs."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from comparison import experiments, pages
from comparison.runs import Run, read

TOLERANCE = 0.02
"""Relative change of an excess that counts as another result: other processors and libraries round differently."""
POINTS = 0.1
"""The same in points, for small excesses."""

CHANGED = 1
"""Exit status where pages or runs differ."""


def check(out: Path) -> int:
    """Say what differs; the exit status."""
    folder = out / "comparison"
    try:
        runs, record = read(folder / pages.RUNS), pages.read_record(folder)
    except OSError:
        print(f"{folder} has no runs; run: {pages.COMMAND}")
        return CHANGED
    found = [*other_pages(runs, record, out), *other_runs(runs, experiments.sample(runs))]
    for line in found:
        print(line)
    print(f"The comparison is of other code; run: {pages.COMMAND}" if found else "The comparison holds for this code.")
    return CHANGED if found else 0


def other_pages(runs: list[Run], record: dict[str, object], out: Path) -> list[str]:
    """Pages that are not what the runs give."""
    texts = pages.pages(runs, record)
    return [f"{out / name} is not what its runs give" for name, text in texts.items()
            if not (out / name).is_file() or (out / name).read_text(encoding="utf-8") != text]  # fmt: skip


def other_runs(runs: Iterable[Run], again: Iterable[Run]) -> list[str]:
    """What runs that were made again say, where it is not what is recorded."""
    known = {(run.experiment, run.family, run.shape, run.method): run for run in runs}
    found = []
    for run in again:
        then = known.get((run.experiment, run.family, run.shape, run.method))
        if then is None or not alike(then, run):
            was = "not recorded" if then is None else f"{then.success}, {then.excess} %, tightened {then.tightened} %"
            found.append(
                f"{run.shape}, {run.method}: {run.success}, {run.excess} %, tightened {run.tightened} %; was {was}"
            )
    return found


def alike(one: Run, other: Run) -> bool:
    """Whether two runs are the same result."""
    pairs = ((one.excess, other.excess), (one.tightened, other.tightened))
    return one.success == other.success and all(_close(a, b) for a, b in pairs)


def _close(a: float | None, b: float | None) -> bool:
    if a is None or b is None:
        return a is b
    return abs(a - b) <= TOLERANCE * abs(a) + POINTS
