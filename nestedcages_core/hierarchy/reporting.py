"""Progress of a run as a whole from the progress of its stages."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

from .results import Progress

DECIMATION_SHARE = 0.2
"""Fraction of a level's time that decimation takes, roughly: only for the progress bar."""

STAGES = {"decimation": 0.0, "flow": 0.0, "reinflation": 0.15, "tightening": 0.4, "verification": 0.95}
"""Where each stage begins within one start, from 0 to 1, roughly."""


class Reporter:
    """Places the progress of one stage within the whole run, and times the stages."""

    def __init__(self, level: int, levels: int, progress: Callable[[Progress], None] | None) -> None:
        self.seconds = dict.fromkeys(STAGES, 0.0)
        self._level = level
        self._levels = levels
        self._progress = progress
        self._stage = "decimation"
        self._began = perf_counter()
        self._start, self._starts = 0, 1
        self._furthest = 0.0

    def start(self, number: int, of: int) -> None:
        """The next coarse mesh begins, number 0 being the first."""
        self._start, self._starts = number, of

    def begin(self, stage: str) -> None:
        """The next stage starts now."""
        self.pause()
        self._stage = stage
        self(0.0, stage)

    def pause(self) -> None:
        """Credit the time since the last call to the current stage."""
        now = perf_counter()
        self.seconds[self._stage] += now - self._began
        self._began = now

    def __call__(self, fraction: float, message: str) -> None:
        """Report a fraction of the current stage; the time the listener takes is nobody's."""
        if self._progress is None:
            return
        self.pause()
        # what starts anew, for instance from the fallback, does not take the bar back
        self._furthest = max(self._furthest, self._within_level(min(max(fraction, 0.0), 1.0)))
        text = f"Level {self._level + 1} of {self._levels}: {message}"
        self._progress(Progress(self._level, self._stage, (self._level + self._furthest) / self._levels, text))
        self._began = perf_counter()

    def _within_level(self, fraction: float) -> float:
        """From 0 to 1 within the level."""
        if self._stage == "decimation":
            return DECIMATION_SHARE * fraction
        begins = STAGES[self._stage]
        ends = min((other for other in STAGES.values() if other > begins), default=1.0)
        within_start = begins + fraction * (ends - begins)
        return DECIMATION_SHARE + (1.0 - DECIMATION_SHARE) * (self._start + within_start) / self._starts
