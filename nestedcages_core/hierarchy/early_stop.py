"""Stop a tightening early when its excess cannot fall below that of the best cage so far.

See docs/ablation.md: early stop of losing starts.
"""

from __future__ import annotations

import numpy as np

FIRST_LOOK = 2
"""Steps before the first comparison, since the first ones only repair the start."""

STEPS_AHEAD = 2.0
"""Expected further gain, in units of the last gain: gains roughly halve from step to step."""


class EarlyStop:
    """Watches the steps of one tightening."""

    def __init__(self, best: float) -> None:
        """best: the least excess so far, infinite if there is none."""
        self._best = best
        self._steps = 0
        self._last = np.inf

    def cannot_improve(self, excess: float) -> bool:
        """Whether the best excess is out of reach after the next step, which has this excess."""
        gain = max(self._last - excess, 0.0)
        self._steps, self._last = self._steps + 1, excess
        return self._steps >= FIRST_LOOK and excess - STEPS_AHEAD * gain > self._best
