"""Progress of a run, the time that its stages take, and the limits of a level."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from time import perf_counter

from ..errors import Fault, NestedCagesError, note
from ..progress import Tick

STAGES = {"decimation": 0.0, "flow": 0.2, "reinflation": 0.32, "tightening": 0.52, "verification": 0.96}
"""Approximate fraction of a level at which each stage begins."""


@dataclass(frozen=True)
class Progress:
    """Progress of a run."""

    level: int
    """Index of the level being made, 0 for the first."""
    stage: str
    """"decimation", "flow", "reinflation", "tightening" or "verification"."""
    fraction: float
    """Fraction of the whole run, from 0 to 1."""
    message: str
    """A sentence for people."""


class OutOfTimeError(NestedCagesError):
    """The time, or the work that a level may take, is over."""


class Watch:
    """Reports the progress of one level and times its stages; raises `OutOfTimeError` once when a limit is reached.

    After that, what has been reached is brought to its end.
    """

    def __init__(
        self,
        level: int,
        levels: int,
        report: Callable[[Progress], None],
        seconds: float | None = None,
        deadline: float = inf,
        most: float = inf,
    ) -> None:
        """seconds: what the run may take, which ends at the deadline; most: how often the level may report."""
        self.seconds = dict.fromkeys(STAGES, 0.0)
        """Wall-clock seconds per stage, those of the caller not counted."""
        self.over: OutOfTimeError | None = None
        """The limit that was reached."""
        self._level, self._levels, self._report = level, levels, report
        self._limit, self._deadline, self._most = seconds, deadline, most
        self._reported, self._furthest = 0, 0.0
        self._stage, self._since = "decimation", perf_counter()

    def begin(self, stage: str) -> None:
        """Begin the next stage."""
        self.stop_clock()
        self._stage = stage
        self.show(0.0, stage)

    def tick(self, message: str) -> Tick:
        """Shows the fraction of the current stage, with a message."""
        return lambda fraction: self.show(fraction, message)

    def show(self, fraction: float, message: str) -> None:
        """Report progress of the current stage. Raises OutOfTimeError, but not during a certificate."""
        self.stop_clock()
        begins = STAGES[self._stage]
        ends = min((other for other in STAGES.values() if other > begins), default=1.0)
        # the bar never goes back, for instance when another start is tried
        self._furthest = max(self._furthest, begins + min(max(fraction, 0.0), 1.0) * (ends - begins))
        text = f"Level {self._level + 1} of {self._levels}: {message}"
        reached = Progress(self._level, self._stage, (self._level + self._furthest) / self._levels, text)
        self._reported += 1
        late = perf_counter() > self._deadline
        if self.over is None and message != "verification" and (late or self._reported > self._most):
            self.over = self._error(reached, late)
            raise self.over
        self._report(reached)
        self._since = perf_counter()

    @property
    def note(self) -> tuple[Fault, ...]:
        """What is said of a cage that is the best when a limit was reached."""
        if self.over is None:
            return ()
        return (note("note.time" if self.over.code == "time.over" else "note.work", **self.over.data),)

    def stop_clock(self) -> None:
        """Add the time since the last call to the current stage."""
        now = perf_counter()
        self.seconds[self._stage] += now - self._since
        self._since = now

    def _error(self, reached: Progress, late: bool) -> OutOfTimeError:
        stage = f"{reached.message[:1].lower()}{reached.message[1:]}"
        place = {"level": reached.level, "stage": reached.stage}
        if late and self._limit is not None:
            said = (
                f"The time of {self._limit:g} s was over during {stage}; give more seconds, or ask for fewer or easier"
            )
            return OutOfTimeError(f"{said} levels.", code="time.over", seconds=self._limit, **place)
        said = f"No cage was found in {self._most:g} steps of work, which ended during {stage}"
        return OutOfTimeError(
            f"{said}; ask for another number of vertices.", code="work.over", steps=self._most, **place
        )
