"""Every run as a line of a CSV file, from which all pages are written."""

from __future__ import annotations

import csv
from collections.abc import Collection, Iterable
from dataclasses import dataclass, fields
from pathlib import Path


@dataclass(frozen=True)
class Run:
    """One run. Excess in per cent, distances in bounding-box diagonals, seconds of CPU; None where there is none."""

    experiment: str
    family: str
    """`random`, `glyphs`, `held out`, or the name of a set of drawings."""
    number: int
    """Seed or place of the shape in its family."""
    shape: str
    start: str
    """What made the coarse mesh."""
    method: str
    fine: int
    """Vertices."""
    coarse: int
    success: bool
    """A certified cage, the fine mesh at home to the last bit, an animation without crossings."""
    encloses: bool
    """Whether the cage strictly encloses the fine mesh at home, whatever became of the rest."""
    failed: str
    """The phase that failed, or empty."""
    excess: float | None
    tightened: float | None
    """Excess after the same tightening, where that was tried."""
    distance: float | None
    """Smallest, between cage and fine mesh, before the tightening."""
    short: float | None
    """How far the fine mesh ends from home."""
    seconds: float | None
    """Median of the repeats; of contacts from the same starts: of the reinflation."""
    flow_steps: int
    iterations: int
    asymmetry: float | None
    """Of the cage of a symmetric drawing."""
    problem: str


def write(runs: Iterable[Run], path: Path) -> None:
    """All runs, one in each line."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([field.name for field in fields(Run)])
        for run in runs:
            writer.writerow([_text(getattr(run, field.name)) for field in fields(Run)])


def read(path: Path) -> list[Run]:
    """All runs of a file. Raises OSError, KeyError."""
    with path.open(newline="", encoding="utf-8") as file:
        return [Run(**{field.name: _value(str(field.type), line[field.name]) for field in fields(Run)})
                for line in csv.DictReader(file)]  # fmt: skip


def of(runs: Iterable[Run], experiment: str, *families: str, start: str = "") -> list[Run]:
    """The runs of an experiment, on some families or all, from a start or all."""
    return [run for run in runs if run.experiment == experiment and (not families or run.family in families)
            and (not start or run.start == start)]  # fmt: skip


def by_shape(runs: Iterable[Run]) -> dict[str, dict[str, Run]]:
    """Shape and start -> method -> run."""
    found: dict[str, dict[str, Run]] = {}
    for run in runs:
        found.setdefault(f"{run.family}: {run.shape} from {run.start}", {})[run.method] = run
    return found


def shared(runs: Iterable[Run], methods: Collection[str]) -> list[dict[str, Run]]:
    """The shapes and starts from which each of some methods succeeds."""
    rows = by_shape(runs).values()
    return [row for row in rows if all(name in row and row[name].success for name in methods)]


def methods_of(runs: Iterable[Run]) -> list[str]:
    """Names of the methods, in the order of the runs."""
    return list(dict.fromkeys(run.method for run in runs))


def _text(value: object) -> str:
    return "" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)


def _value(kind: str, text: str) -> object:
    if kind == "bool":
        return text == "True"
    if kind == "int":
        return int(text)
    return text if kind == "str" else (float(text) if text else None)
