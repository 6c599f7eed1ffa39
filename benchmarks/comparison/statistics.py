"""Spreads, paired tests corrected for their number, and bootstrap intervals."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import scipy

RESAMPLES = 2000
LEVEL = 95.0  # per cent, of all intervals
SEED = 0


class Interval(NamedTuple):
    """A statistic with its percentile bootstrap interval."""

    value: float
    low: float
    high: float

    def text(self, form: str = ".2f") -> str:
        """Value and interval."""
        return f"{self.value:{form}} [{self.low:{form}}, {self.high:{form}}]"


def bootstrap(values: Sequence[float], statistic: Callable[..., np.ndarray] = np.median) -> Interval:
    """A statistic of values (k,), with an interval; nan without values."""
    if not len(values):
        return Interval(np.nan, np.nan, np.nan)
    array = np.asarray(values, np.float64)
    drawn = np.random.default_rng(SEED).integers(len(array), size=(RESAMPLES, len(array)))
    resampled = statistic(array[drawn], axis=1)
    low, high = np.percentile(resampled, [50.0 - 0.5 * LEVEL, 50.0 + 0.5 * LEVEL])
    return Interval(float(statistic(array, axis=0)), float(low), float(high))


def geometric_mean(values: Sequence[float]) -> Interval:
    """Of positive values, with an interval."""
    return Interval(*np.exp(bootstrap(np.log(values), np.mean))) if len(values) else bootstrap(())


def share(flags: Sequence[bool]) -> Interval:
    """How many of some flags are set, with an interval."""
    return bootstrap([float(flag) for flag in flags], np.mean)


class Paired(NamedTuple):
    """One method against another on the same shapes: two-sided sign test, which for flags is McNemar's exact test."""

    wins: int
    losses: int
    p: float
    """Ties are left out."""

    @property
    def text(self) -> str:
        """Wins of all that are not ties, and p."""
        return f"{self.wins} of {self.wins + self.losses} (p = {self.p:.1g})"

    def says(self, level: float) -> bool:
        """Whether the first is better, at a level."""
        return self.wins > self.losses and self.p < level


def sign_test(one: Sequence[float], other: Sequence[float]) -> Paired:
    """How often the first of two paired values is smaller; an infinite one stands for a failure."""
    wins = sum(a < b for a, b in zip(one, other, strict=True))
    losses = sum(a > b for a, b in zip(one, other, strict=True))
    p = scipy.stats.binomtest(wins, wins + losses).pvalue if wins + losses else 1.0
    return Paired(wins, losses, float(p))


def corrected(tests: Mapping[str, Paired]) -> dict[str, Paired]:
    """The tests with p as corrected for their number (Holm 1979)."""
    least, found = 0.0, {}
    for place, name in enumerate(sorted(tests, key=lambda name: tests[name].p)):
        least = max(least, min(1.0, (len(tests) - place) * tests[name].p))
        found[name] = tests[name]._replace(p=least)
    return {name: found[name] for name in tests}
