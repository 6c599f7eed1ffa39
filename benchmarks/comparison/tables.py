"""Tables in Markdown, every number from the measurements."""

from __future__ import annotations

import csv
import statistics
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np

from comparison.measure import PHASES, Measurement, Results


def table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def number(value: float | None, form: str = ".2f") -> str:
    """A number, or a dash where there is none."""
    return "–" if value is None or not np.isfinite(value) else format(value, form)


def matrix(
    corner: str, columns: Sequence[str], rows: dict[str, dict[str, Measurement]], cell: Callable[[Measurement], str]
) -> str:
    """One cell for each run: rows of shapes, columns of methods."""
    lines = [
        [name, *(cell(found[column]) if column in found else "–" for column in columns)] for name, found in rows.items()
    ]
    return table([corner, *columns], lines)


def excess_and_time(result: Measurement) -> str:
    """Excess in per cent and seconds of a run that succeeded; otherwise the phase that failed, and in brackets the
    excess of the cage that it left, if that encloses the fine mesh."""
    if result.success:
        return f"{number(result.excess)} % · {result.total:.2f} s"
    left = f" ({number(result.excess)} %)" if result.certified else ""
    return f"✗ {result.failed or 'not certified'}{left}"


def count(results: Results, name: str) -> str:
    """How many of the runs of a method succeeded, of how many."""
    tried = [shape[name] for shape in results.values() if name in shape]
    return f"{sum(run.success for run in tried)} of {len(tried)}"


def median(values: Iterable[float | None]) -> float | None:
    """Of those that are there; None if none is."""
    there = [value for value in values if value is not None]
    return statistics.median(there) if there else None


CSV_COLUMNS = (
    "experiment", "shape", "method", "fine_vertices", "coarse_vertices", "success", "failed_in", "excess_percent",
    "smallest_distance", "short_of_home", "encloses", "crossing_free", "flow_steps", "iterations",
    "decimation_s", *(f"{phase}_s" for phase in PHASES), "total_s", "problem",
)  # fmt: skip


def write_runs(experiments: dict[str, Results], path: Path) -> int:
    """Every run as a line of a CSV file; returns their number. Lengths in bounding-box diagonals."""
    lines = []
    for experiment, results in experiments.items():
        for shape, found in results.items():
            for name, run in found.items():
                coarse = len(run.coarse.vertices) if run.coarse is not None else ""
                seconds = [f"{run.seconds[p]:.4f}" if p in run.seconds else "" for p in ("decimation", *PHASES)]
                lines.append([
                    experiment, shape, name, len(run.fine.vertices), coarse, run.success, run.failed,
                    number(run.excess, ".4f"), number(run.smallest, ".3e"), number(run.short, ".3e"), run.certified,
                    "" if run.free is None else run.free, run.flow_steps, run.iterations, *seconds,
                    f"{run.total:.4f}", run.problem,
                ])  # fmt: skip
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(CSV_COLUMNS)
        writer.writerows([["" if cell == "–" else cell for cell in line] for line in lines])
    return len(lines)
