"""Three claims. Each is a sentence with numbers from the runs, and a test of what it says; both on the shapes that
methods were made with, and on held-out families. A claim that the runs contradict is printed as such."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from comparison import methods, statistics
from comparison.runs import Run, of, shared
from comparison.shapes import GLYPHS, HELD_OUT, RANDOM

KNOWN = (RANDOM, GLYPHS)
SIGNIFICANT = 0.05
"""p of a paired test below which one method is called better."""
MOST = 0.5
"""Share of shapes below which those that differ are the few."""

AGREE = 0.02
"""Spread of medians after the tightening, relative to their mean, up to which contacts agree in the median."""
APART = 1.01
"""Ratio of the largest to the least excess of a shape above which contacts differ on it."""


@dataclass(frozen=True)
class Verdict:
    """What some runs say of a claim."""

    numbers: dict[str, str]
    holds: bool


@dataclass(frozen=True)
class Conclusion:
    """A claim and its test."""

    name: str
    claim: str
    judge: Callable[[Sequence[Run], tuple[str, ...]], Verdict]
    page: str
    picture: str
    caption: str


def original(runs: Sequence[Run], families: tuple[str, ...]) -> Verdict:
    """Gurditta & Jacobson name this comparison as what their work lacks."""
    own = of(runs, "methods", *families)
    solved = {name: [run.success for run in own if run.method == name]
              for name in (methods.ORIGINAL, methods.REPAIRED, methods.NEWTON)}  # fmt: skip
    rows = shared(own, [methods.ORIGINAL, methods.REPAIRED, methods.NEWTON])
    one, other = ([row[name].excess or 0.0 for row in rows] for name in (methods.ORIGINAL, methods.REPAIRED))
    tighter = statistics.sign_test(one, other)
    points = statistics.bootstrap([b - a for a, b in zip(one, other, strict=True)])
    slower = {name: statistics.geometric_mean([_time(row[name]) / _time(row[methods.ORIGINAL]) for row in rows])
              for name in (methods.REPAIRED, methods.NEWTON)}  # fmt: skip
    descent, newton = slower[methods.REPAIRED], slower[methods.NEWTON]
    return Verdict(
        {
            "solved by the method of 2015": f"{sum(solved[methods.ORIGINAL])} of {len(solved[methods.ORIGINAL])}",
            "solved by that of 2022, repaired": f"{sum(solved[methods.REPAIRED])} of {len(solved[methods.REPAIRED])}",
            "2015 is tighter": tighter.text,
            "by points, median": points.text(".1f"),
            "gradient descent takes": f"{descent.text('.0f')} times as long as 2015",
            "Newton steps take": f"{newton.text('.1f')} times as long as 2015",
        },
        tighter.wins > tighter.losses and tighter.p < SIGNIFICANT and descent.low > 1.0
        and newton.high < descent.low,
    )  # fmt: skip


def ranges(runs: Sequence[Run], families: tuple[str, ...]) -> Verdict:
    """IPC as published against the modified energy, at equal ranges."""
    rows = shared(of(runs, "ranges", *families), list(methods.AT_RANGES))
    least, largest = methods.RANGES[0], methods.RANGES[-1]

    def excess(name: str, d_hat: float) -> list[float]:
        return [row[f"{name}, {d_hat:g}"].excess or 0.0 for row in rows]

    effect = statistics.geometric_mean(
        _ratios(excess(methods.ENERGY_2022, largest), excess(methods.ENERGY_2022, least))
    )
    told, tests = {}, []
    for d_hat in (least, largest):
        ours, theirs = excess(methods.ENERGY_2022, d_hat), excess(methods.IPC_2020, d_hat)
        tests.append(statistics.sign_test(ours, theirs))
        told[f"at d̂ = {d_hat:g}: median excess of 2022, of IPC 2020"] = (
            f"{_median(ours):.1f} %, {_median(theirs):.1f} %"
        )
        told[f"at d̂ = {d_hat:g}: 2022 is tighter"] = tests[-1].text
    slower = statistics.geometric_mean([
        _time(row[f"{methods.ENERGY_2022}, {least:g}"]) / _time(row[f"{methods.ENERGY_2022}, {largest:g}"])
        for row in rows
    ])  # fmt: skip
    close = tests[0]
    return Verdict(
        {
            "shapes that both solve at every range": str(len(rows)),
            f"excess of 2022 from d̂ = {least:g} to {largest:g}": f"grows {effect.text()} times",
            **told,
            "the small range takes": f"{slower.text('.0f')} times as long",
        },
        effect.low > 1.0 and not (close.losses > close.wins and close.p < SIGNIFICANT),
    )


def tightened(runs: Sequence[Run], families: tuple[str, ...]) -> Verdict:
    """What is left of the differences between contacts."""
    rows = after_tightening(runs, families)
    names = list(methods.CONTACTS)
    medians = [float(np.median([row[name].tightened or 0.0 for row in rows])) for name in names] if rows else [np.nan]
    before = [float(np.median([row[name].excess or 0.0 for row in rows])) for name in names] if rows else [np.nan]
    apart = [spread([row[name].tightened for name in names]) for row in rows]
    differ = statistics.share([ratio > APART for ratio in apart])
    return Verdict(
        {
            f"shapes that all {len(names)} contacts solve": str(len(rows)),
            "medians after reinflation": f"{min(before):.1f} to {max(before):.1f} %",
            "medians after tightening": f"{min(medians):.2f} to {max(medians):.2f} %",
            "shapes that differ by more than 1 %": f"{100.0 * differ.value:.0f} % "
            f"[{100.0 * differ.low:.0f}, {100.0 * differ.high:.0f}]",
            "largest difference": f"{max(apart, default=np.nan):.1f} times",
        },
        max(medians) - min(medians) <= AGREE * float(np.mean(medians)) and differ.high < MOST,
    )


def after_tightening(runs: Sequence[Run], families: tuple[str, ...]) -> list[dict[str, Run]]:
    """The shapes on which every contact succeeds, tightening included."""
    rows = shared(of(runs, "contacts", *families), list(methods.CONTACTS))
    return [row for row in rows if all(run.tightened is not None for run in row.values())]


def spread(excesses: Sequence[float | None]) -> float:
    """Largest excess over the least."""
    known = [max(value, 1e-3) for value in excesses if value is not None]
    return max(known) / min(known) if known else np.inf


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if len(values) else np.nan


def _ratios(one: Sequence[float], other: Sequence[float]) -> list[float]:
    return [max(a, 1e-3) / max(b, 1e-3) for a, b in zip(one, other, strict=True)]


def _time(run: Run) -> float:
    return max(run.seconds or 0.0, 1e-4)


CONCLUSIONS = (
    Conclusion(
        "original", "The method of 2015 is tighter than its augmentation of 2022; that it is much faster is mostly "
        "gradient descent.", original, "methods.md", "original.png",
        "Every shape: excess of 2022 over that of 2015, and their times",
    ),
    Conclusion(
        "ranges", "What makes the augmentation of 2022 loose is the range of its barrier, not the barrier: at that of "
        "IPC (2020) it is no looser.", ranges, "contacts.md", "ranges.png",
        "Excess over the range d̂, median and quartiles",
    ),
    Conclusion(
        "tightened", "After the same tightening contacts agree in the median, and on most shapes.", tightened,
        "contacts.md", "tightened.png", "Largest over least excess of the contacts, for every shape",
    ),
)  # fmt: skip


def verdicts(runs: Sequence[Run]) -> dict[Conclusion, tuple[Verdict, Verdict]]:
    """Every conclusion on the shapes that methods were made with, and on held-out families."""
    return {c: (c.judge(runs, KNOWN), c.judge(runs, (HELD_OUT,))) for c in CONCLUSIONS}
