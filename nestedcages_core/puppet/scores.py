"""How well one part hangs on another: a score from their overlap, the groups around them and pins over both."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from .overlaps import Meetings
from .parts import PuppetPart

CONTAINED = 0.8
"""A part lies in another one with at least this part of its area."""

ROUND = 0.9
"""Least area of a round part, in those of its largest disc."""

PIN_SIZE, PIN_SHARED, PIN_INSIDE = 0.15, 0.3, 0.95
"""A pin: its most area, in those of each of two parts under it; how much of it both share; how much lies in each."""

AT_END, OFF_END = 0.12, 0.4
"""An overlap this near an end of the part, in lengths of the part, is a joint there; factor of one that is not."""

STUBBY = 1.4
"""Slenderness below which a part has no ends."""

SHORT_SPAN, WHOLE_SPAN = 0.3, 0.1
"""A joint takes up this part of a limb's length at most without loss; the factor of one along the whole limb."""

CLINGING = 0.35
"""Least factor of an overlap in the part of the area that it takes up: a patch lies all over its parent."""

APART = 0.35
"""Factor of parts that do not overlap."""

SAME_GROUP, PINNED = 1.6, 3.0
"""Factors of parts in the same innermost group, and of parts that a pin holds together."""

SNUG_POWER, SIZE_POWER = 0.75, 0.25
"""Powers of the two ratios of sizes in the score: of the joint over the thinner part, of a smaller parent over its
child. Weak on purpose: a neck is thinner than its head."""

CARRYING_RADIUS = 0.25
"""A part thinner than this, in radii of another, does not make a joint snug: whiskers carry nothing."""


class Scores:
    """Scores of all pairs of parts, with what they are made of. None of it depends on names."""

    def __init__(self, parts: Sequence[PuppetPart]) -> None:
        self.parts = parts
        self.meetings = Meetings(parts)
        self.areas = np.array([part.outline.area for part in parts])
        self.radii = np.array([part.disc[1] for part in parts])
        common = set.intersection(*(set(part.groups) for part in parts))
        self._group = [next((g for g in part.groups[::-1] if g not in common), None) for part in parts]
        self._known: dict[tuple[int, int], float] = {}

    def near(self, part: int) -> list[int]:
        """The parts that one overlaps, touches or nearly touches."""
        return self.meetings.near[part]

    def share(self, child: int, parent: int) -> float:
        """The part of a child's area that lies in its parent."""
        met = self.meetings.get(child, parent)
        return 0.0 if met is None else met.area / float(self.areas[child])

    def same_group(self, one: int, other: int) -> bool:
        """Whether two parts have the same innermost group, groups of all parts left out."""
        return self._group[one] is not None and self._group[one] == self._group[other]

    def of(self, child: int, parent: int) -> float:
        """How well a part hangs on another: 0 for parts that are apart, about 1 for an overlap as wide as the thinner
        one at an end of the child."""
        if self.meetings.get(child, parent) is None:
            return 0.0
        if (child, parent) not in self._known:
            self._known[child, parent] = self._score(child, parent)
        return self._known[child, parent]

    def _score(self, child: int, parent: int) -> float:
        met, part = self.meetings[child, parent], self.parts[child]
        thinner = min(self.radii[child], max(self.radii[parent], CARRYING_RADIUS * self.radii[child]))
        width = (met.disc[1] if met.area > 0.0 else APART * 0.5 * met.length) / thinner
        size = min(1.0, self.areas[parent] / self.areas[child]) ** SIZE_POWER
        group = SAME_GROUP if self.same_group(child, parent) else 1.0
        pin = PINNED if (child, parent) in self.pins else 1.0
        return float(min(1.0, width) ** SNUG_POWER * size * self._placed(part, child, parent) * group * pin)

    def _placed(self, part: PuppetPart, child: int, parent: int) -> float:
        """Whether the overlap is at an end of the child, and short."""
        share = self.share(child, parent)
        stubby = part.slenderness < STUBBY
        low, high = self.meetings[child, parent].span(part)
        span = share if stubby else high - low
        end = 1.0 if stubby or min(low, 1.0 - high) < AT_END else OFF_END
        long = max(0.0, span - SHORT_SPAN) / (1.0 - SHORT_SPAN)
        return max(end * (1.0 - (1.0 - WHOLE_SPAN) * long), CLINGING * share)

    @cached_property
    def pins(self) -> dict[tuple[int, int], int]:
        """Round details over two parts that overlap there, by those parts in both orders: each names a joint."""
        found: dict[tuple[int, int], int] = {}
        for pin, part in enumerate(self.parts):
            if self.areas[pin] < ROUND * np.pi * part.disc[1] ** 2 or part.slenderness > STUBBY:
                continue
            if self.areas[pin] > np.pi * part.disc[1] ** 2 / ROUND:
                continue
            under = [
                p
                for p in self.near(pin)
                if p < pin and self.areas[pin] < PIN_SIZE * self.areas[p] and self.share(pin, p) >= PIN_INSIDE
            ]
            if len(under) < 2:
                continue
            p, q = sorted(under, key=lambda p: (self.same_group(p, pin), p))[-2:]
            met = self.meetings.get(p, q)
            if met is None or met.area <= PIN_SHARED * self.areas[pin]:
                continue
            if met.area <= CONTAINED * min(self.areas[p], self.areas[q]):
                found[p, q] = found[q, p] = pin
        return found
