"""Progress of a run as a whole from the progress of its stages."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

from .results import Progress

SHARES = {"decimation": 0.15, "flow": 0.1, "reinflation": 0.25, "tightening": 0.4, "verification": 0.1}
"""Fraction of a level's time that each stage takes, roughly: only for the progress bar."""


class Reporter:
    """Places the progress of one stage within the whole run, and times the stages."""

    def __init__(self, level: int, levels: int, progress: Callable[[Progress], None] | None) -> None:
        self.seconds = dict.fromkeys(SHARES, 0.0)
        self._level = level
        self._levels = levels
        self._progress = progress
        self._stage = "decimation"
        self._began = perf_counter()

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
        before = sum(share for stage, share in list(SHARES.items())[: list(SHARES).index(self._stage)])
        inside = before + SHARES[self._stage] * min(max(fraction, 0.0), 1.0)
        text = f"Level {self._level + 1} of {self._levels}: {message}"
        self._progress(Progress(self._level, self._stage, (self._level + inside) / self._levels, text))
        self._began = perf_counter()
