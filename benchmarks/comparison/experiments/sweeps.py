"""What do a contact's own parameters trade: tightness, time, failures?"""

from __future__ import annotations

import statistics
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from comparison import methods, plots
from comparison.bench import Bench
from comparison.cases import Inputs
from comparison.measure import Measurement, Results
from comparison.starts import starts
from comparison.tables import number, table
from nestedcages_core.published.gurditta_jacobson_2022 import PaperWeights

LIMIT = 3.0  # CPU seconds of a run
OTHER_SEEDS = 100_000  # so that the shapes are not those of the comparison of contacts


@dataclass(frozen=True)
class Sweep:
    """A parameter of a contact and the values that it is given."""

    contact: str
    parameter: str
    values: tuple[float, ...]
    default: float
    meaning: str

    def label(self, value: float) -> str:
        """Name of a method."""
        return f"{self.contact}, default" if value == self.default else f"{self.contact}, {self.parameter} {value:g}"

    def contact_with(self, value: float) -> Any:
        """The contact with area descent, or with what it has, and a value of the parameter."""
        known = methods.ALONE[self.contact]
        contact: Any = known.descent or known.clearing
        if self.contact.startswith("paper's") and self.parameter in PaperWeights.__dataclass_fields__:
            return replace(contact, weights=replace(contact.weights, **{self.parameter: value}))
        return replace(contact, **{self.parameter: value})


def around(default: float, *factors: float) -> tuple[float, ...]:
    """The default times some factors."""
    return tuple(sorted(default * factor for factor in (*factors, 1.0)))


WIDE, NARROW = (0.03, 0.1, 0.3, 3.0), (0.25, 0.5, 2.0, 4.0)
PAPER_RANGE = methods.BY_NEWTON.d_hat

SWEEPS = (
    Sweep("IPC", "barrier_range", around(0.1, 0.01, 0.03, 0.1, 0.3, 3.0), 0.1, "d̂, in mean coarse edges"),
    Sweep("IPC", "barrier", around(1.0, *WIDE, 10.0), 1.0, "κ = λ_B d̂"),
    Sweep("IPC", "restoring", around(100.0, 0.1, 0.3, 3.0, 10.0), 100.0, "λ_R d̂"),
    Sweep("IPC", "stride", around(0.5, *NARROW), 0.5, "longest motion of the fine mesh, in mean coarse edges"),
    Sweep("IPC 2020", "d_hat", around(1e-3, 0.1, 0.3, 3.0, 10.0), 1e-3, "d̂, in diagonals"),
    Sweep("IPC 2020", "stiffness", around(1e11, 1e-4, 1e-2, 1e2), 1e11, "least κ"),
    Sweep("IPC 2020", "tolerance", around(2.5e-4, 0.1, 0.3, 3.0, 10.0), 2.5e-4, "last Newton step, in diagonals"),
    Sweep("sequential QP", "gap", around(0.05, *NARROW), 0.05, "gap on the way, in mean coarse edges"),
    Sweep("sequential QP", "stride", around(1.0 / 3.0, *NARROW), 1.0 / 3.0, "longest motion of the fine mesh"),
    Sweep("velocity filter", "proximity", around(1e-3, *WIDE), 1e-3, "distance of pairs that are pushed apart"),
    Sweep("velocity filter", "stride", around(1.0 / 3.0, *NARROW), 1.0 / 3.0, "longest motion of the fine mesh"),
    Sweep("El Topo", "proximity", around(1e-3, *WIDE), 1e-3, "distance of pairs that are pushed apart"),
    Sweep("El Topo", "smallest_step", around(1e-3, 0.1, 0.3, 3.0), 1e-3, "descent step at which it ends"),
    Sweep("paper's energy, Newton", "d_hat", around(PAPER_RANGE, *WIDE), PAPER_RANGE, "d̂, in diagonals"),
    Sweep("paper's energy, Newton", "barrier", around(10.0, *WIDE), 10.0, "λ_B"),
    Sweep("paper's energy, Newton", "restoring", around(1e4, *WIDE), 1e4, "λ_R"),
)


@dataclass(frozen=True)
class Point:
    """A contact with certain parameters, over all shapes."""

    label: str
    seconds: float
    """Geometric mean of the reinflation where it succeeds."""
    above: float
    """Mean excess above the tightest of all points on the same shape where it succeeds, in points."""
    excess: float
    """Mean excess where it succeeds."""
    failures: float
    """Share of the shapes."""


def run(inputs: Inputs, bench: Bench) -> Results:
    """Every value of every parameter, one at a time."""
    cases = starts(bench, inputs.sizes.sweep, inputs.sizes.sweep, inputs.sizes.first_seed + OTHER_SEEDS)
    chosen = {s.label(value): methods.alone(s.contact_with(value)) for s in SWEEPS for value in s.values}
    return bench.compare("sweeps", cases, chosen, limit=LIMIT)


def points(found: Results) -> dict[str, Point]:
    """By label; those that never succeed are left out."""
    best = {
        shape: min((run.excess for run in runs.values() if run.success), default=0.0) for shape, runs in found.items()
    }
    made: dict[str, Point] = {}
    for name in next(iter(found.values())):
        good: list[tuple[str, Measurement]] = [(s, runs[name]) for s, runs in found.items() if runs[name].success]
        if good:
            made[name] = Point(
                name,
                statistics.geometric_mean(max(run.seconds["reinflation"], 1e-4) for _, run in good),
                statistics.mean(run.excess - best[shape] for shape, run in good),
                statistics.mean(run.excess for _, run in good),
                1.0 - len(good) / len(found),
            )
    return made


def front(made: dict[str, Point]) -> list[Point]:
    """The points that no other beats in time, tightness and failures at once, by time."""

    def beats(one: Point, other: Point) -> bool:
        mine, theirs = (one.seconds, one.above, one.failures), (other.seconds, other.above, other.failures)
        return mine != theirs and all(a <= b for a, b in zip(mine, theirs, strict=True))

    kept = [point for point in made.values() if not any(beats(other, point) for other in made.values())]
    return sorted(kept, key=lambda point: point.seconds)


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """A curve for each parameter, the front of all, and every point in numbers."""
    made = points(found)
    plots.sweeps(made, SWEEPS, pictures / "sweeps.png")
    plots.front(made, [point.label for point in front(made)], pictures / "pareto.png")
    parts = [
        "## Parameters of the contacts",
        f"Each contact by itself, with area descent where it has one, on {len(found)} starts that the comparison of "
        "contacts does not contain; one parameter at a time, the others at their defaults. *Above*: mean excess above "
        "the tightest of all runs on the same shape, in points, where the contact succeeds; seconds are the geometric "
        f"mean of the reinflation. A run is ended after {LIMIT:.0f} s. Stars mark defaults, and rings grow with the "
        "share of failures.",
        "![Sweeps](sweeps.png)",
        "What no other setting beats in time, tightness and failures at once (the Pareto front):",
        "![Pareto front](pareto.png)",
        table(
            ["setting", "s", "above", "excess %", "failures"],
            [[p.label, number(p.seconds, ".4f"), number(p.above), number(p.excess), f"{p.failures:.0%}"]
             for p in front(made)],
        ),
    ]  # fmt: skip
    for sweep in SWEEPS:
        lines = []
        for value in sweep.values:
            point = made.get(sweep.label(value))
            mark = " (default)" if value == sweep.default else ""
            lines.append(
                [f"{value:.3g}{mark}", "–", "–", "–", "100%"] if point is None else
                [f"{value:.3g}{mark}", number(point.seconds, ".4f"), number(point.above), number(point.excess),
                 f"{point.failures:.0%}"]
            )  # fmt: skip
        parts += [
            f"### {sweep.contact}: {sweep.parameter}",
            f"{sweep.meaning[0].upper()}{sweep.meaning[1:]}.",
            table([sweep.parameter, "s", "above", "excess %", "failures"], lines),
        ]
    return "\n\n".join(parts)


def spread(made: dict[str, Point], contact: str) -> tuple[float, float]:
    """Least and largest mean excess of a contact over its parameters, where at most a tenth fails."""
    own = [p.above for p in made.values() if p.label.startswith(f"{contact}, ") and p.failures <= 0.1]
    return (min(own), max(own)) if own else (float("nan"), float("nan"))


def finding(found: Results, inputs: Inputs) -> str:
    """How far parameters move a contact."""
    made = points(found)
    told = []
    for name in methods.ALONE:
        least, largest = spread(made, name)
        default = made.get(f"{name}, default")
        if default is not None:
            told.append(f"{name} {least:.2f} to {largest:.2f} (default {default.above:.2f})")
    return (
        "**Parameters.** Mean points above the tightest run, over the values at which at most a tenth of the shapes "
        "fail: " + "; ".join(told) + ". On the front: " + ", ".join(p.label for p in front(made)) + "."
    )
