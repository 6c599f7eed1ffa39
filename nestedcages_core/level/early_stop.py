"""Stop a tightening early when its excess cannot fall below that of the best cage so far.

See docs/ablation.md: early stop of losing starts.
"""

from __future__ import annotations

FIRST_LOOK = 2
"""Steps before the first comparison."""

USUAL_RATIO, LARGEST_RATIO = 2.0 / 3.0, 0.95
"""Ratio of a gain to the one before that is expected at least, since it usually is about a half; ratio from which on
gains do not shrink."""


class EarlyStop:
    """Watches the steps of one tightening."""

    def __init__(self, best: float, excess: float) -> None:
        """best: the least excess so far, infinite if there is none; excess: of the start."""
        self._best = best
        self._steps, self._last, self._gain = 0, excess, 0.0

    def cannot_improve(self, excess: float) -> bool:
        """Whether the best excess is out of reach after the next step, which has this excess."""
        gain, before = max(self._last - excess, 0.0), self._gain
        self._steps, self._last, self._gain = self._steps + 1, excess, gain
        if self._steps < FIRST_LOOK or gain > LARGEST_RATIO * before:
            return False
        ratio = max(gain / before, USUAL_RATIO) if before > 0.0 else USUAL_RATIO
        return excess - gain * ratio / (1.0 - ratio) > self._best  # the sum of all gains to come
