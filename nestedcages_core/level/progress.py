"""Progress and time of a run, from the progress of its stages."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from time import perf_counter

from ..tasks import Result, Stage, Yielded, followed
from .report import Progress

DECIMATION_SHARE = 0.2
"""Approximate fraction of a level's time for decimation; only for the progress bar."""

STAGES = {"decimation": 0.0, "flow": 0.0, "reinflation": 0.15, "tightening": 0.4, "verification": 0.95}
"""Approximate fraction of a start at which each stage begins."""


class LevelProgress:
    """Converts the progress of a stage to that of the whole run, and times the stages of one level."""

    def __init__(self, level: int, levels: int) -> None:
        self.seconds = dict.fromkeys(STAGES, 0.0)
        self._level, self._levels = level, levels
        self._stage = "decimation"
        self._since = perf_counter()
        self._start, self._starts = -1, 1
        self._furthest = 0.0

    def next_start(self, expected: int) -> None:
        """Begin the next of ``expected`` coarse meshes."""
        self._start += 1
        self._starts = max(self._start + 1, expected)

    @property
    def starts_so_far(self) -> str:
        """The current coarse mesh, in words."""
        return f"{self._start + 1} of {self._starts}"

    def begin(self, stage: str) -> Iterator[Progress]:
        """Begin the next stage."""
        self.stop_clock()
        self._stage = stage
        yield from self.show(0.0, stage)

    def stop_clock(self) -> None:
        """Add the time since the last call to the current stage."""
        now = perf_counter()
        self.seconds[self._stage] += now - self._since
        self._since = now

    def show(self, fraction: float, message: str) -> Iterator[Progress]:
        """Report progress of the current stage. Time spent by the caller is not counted."""
        self.stop_clock()
        # the bar never goes back, for instance when the fallback starts over
        self._furthest = max(self._furthest, self._within_level(min(max(fraction, 0.0), 1.0)))
        text = f"Level {self._level + 1} of {self._levels}: {message}"
        yield Progress(self._level, self._stage, (self._level + self._furthest) / self._levels, text)
        self._since = perf_counter()

    def follow(
        self, stage: Stage[Yielded, Result], describe: Callable[[Yielded], tuple[float, str]]
    ) -> Stage[Progress, Result]:
        """Run a stage, with its yields converted to fraction and message of the progress."""
        return followed(stage, lambda yielded: self.show(*describe(yielded)))

    def _within_level(self, fraction: float) -> float:
        """From 0 to 1 within the level."""
        if self._stage == "decimation":
            return DECIMATION_SHARE * fraction
        begins = STAGES[self._stage]
        ends = min((other for other in STAGES.values() if other > begins), default=1.0)
        within_start = begins + fraction * (ends - begins)
        return DECIMATION_SHARE + (1.0 - DECIMATION_SHARE) * (self._start + within_start) / self._starts
