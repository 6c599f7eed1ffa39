"""How well one part hangs on another: a score from overlap, stacking order, pins and names."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from ..geometry.arrays import FloatArray
from ..libraries import load_shapely
from .overlaps import Meetings
from .parts import AT_END, NEEDED_FOR, STUBBY, PuppetPart
from .words import agreement, words_of

CONTAINED = 0.8
"""A part lies in another one with at least this part of its area."""

ROUND = 0.9
"""Least area of a round part, in those of its largest disc."""

PIN_SIZE, PIN_SHARED, PIN_INSIDE = 0.15, 0.3, 0.95
"""A pin: its most area, in those of each of two parts under it; how much of it both share; how much lies in each."""

PIN_CENTRED = 0.5
"""A pin's middle is at least this far from the outline of the limb that it holds, in radii of the limb."""

OFF_END = 0.4
"""Factor of an overlap that is at no end of the part."""

SHORT_SPAN, WHOLE_SPAN = 0.3, 0.1
"""A joint takes up this part of a limb's length at most without loss; the factor of one along the whole limb."""

BY_ITS_SIDE = 0.7
"""Factor of a part that hangs by its longer side: fins, jaws, hips."""

CLINGING, CLINGING_ON, BASE = 0.35, 0.9, 3.0
"""Factors of the part of the area that an overlap takes up, on a parent of the same area and on one this many times
larger, a base: upper arms lie on the body, lower ones touch it."""

APART = 0.35
"""Factor of parts that do not overlap."""

PINNED = 3.0
"""Factor of parts that a pin holds together."""

END_OF_PARENT, PARENT_END = 1.4, 0.3
"""Factor of an overlap at an end of a slender parent, as in chains of limbs; how near, in lengths of the parent."""

SNUG_POWER, SIZE_POWER, MOST_SIZE = 0.5, 0.2, 4.0
"""Powers of two ratios in the score: of the joint over the thinner part, and of the area of the parent over that of
the child, at most this much. Weak on purpose: a neck is thinner than its head."""

STACK_POWER = 0.2
"""Power of the distance in the stack by which the score falls: the parts of a limb are drawn one after the other."""

PARTED = 0.6
"""Factor of two parts of which one lies over and one under a larger part that both meet: near and far limbs."""

HALF_WITHIN, WITHIN_CHILD = 0.5, 0.2
"""A parent that lies on its child with more than this part of its area; the factor of one that lies on it wholly: the
fringe does not carry the head."""

CARRYING_RADIUS = 0.25
"""A part thinner than this, in radii of another, does not make a joint snug: whiskers carry nothing."""


class Scores:
    """Scores of all pairs of parts. Groups do not count: they were tried, and helped nothing."""

    def __init__(self, parts: Sequence[PuppetPart]) -> None:
        self.parts = parts
        self.meetings = Meetings(parts)
        self.areas = np.array([part.outline.area for part in parts])
        self.radii = np.array([part.disc[1] for part in parts])
        self.words = [words_of(part.name) for part in parts]
        self._known: dict[tuple[int, int], float] = {}

    def near(self, part: int) -> list[int]:
        """The parts that one overlaps, touches or nearly touches."""
        return self.meetings.near[part]

    def share(self, child: int, parent: int) -> float:
        """The part of a child's area that lies in its parent."""
        met = self.meetings.get(child, parent)
        return 0.0 if met is None else met.area / float(self.areas[child])

    def of(self, child: int, parent: int) -> float:
        """How well a part hangs on another: 0 for parts that are apart, about 1 for an overlap as wide as the thinner
        one at an end of the child."""
        if self.meetings.get(child, parent) is None:
            return 0.0
        if (child, parent) not in self._known:
            self._known[child, parent] = self._score(child, parent)
        return self._known[child, parent]

    def _score(self, child: int, parent: int) -> float:
        met = self.meetings[child, parent]
        thinner = min(self.radii[child], max(self.radii[parent], CARRYING_RADIUS * self.radii[child]))
        width = (met.disc[1] if met.area > 0.0 else APART * 0.5 * met.length) / thinner
        ratio = self.areas[parent] / self.areas[child]
        score = min(1.0, width) ** SNUG_POWER * min(ratio, MOST_SIZE) ** SIZE_POWER
        score *= self._placed(child, parent, ratio)
        score *= (1.0 + abs(child - parent)) ** -STACK_POWER
        score *= PINNED if (child, parent) in self.pins else 1.0
        score *= END_OF_PARENT if self.at_end_of(parent, child) else 1.0
        score *= agreement(self.words[child], self.words[parent])
        score *= PARTED if self._are_parted(child, parent) else 1.0
        within = (self.share(parent, child) - HALF_WITHIN) / (CONTAINED - HALF_WITHIN) if parent > child else 0.0
        return float(score * (1.0 - (1.0 - WITHIN_CHILD) * np.clip(within, 0.0, 1.0)))

    def _placed(self, child: int, parent: int, ratio: float) -> float:
        """Whether the overlap is at an end of the child, and short, or the child lies on a base."""
        part, share = self.parts[child], self.share(child, parent)
        met = self.meetings[child, parent]
        on_base = CLINGING + (CLINGING_ON - CLINGING) * np.clip((ratio - 1.0) / (BASE - 1.0), 0.0, 1.0)
        if part.slenderness < STUBBY:
            ends = [_end_factor(0.0, share)]
        else:
            ends = [_end_factor(*met.span(part)), BY_ITS_SIDE * _end_factor(*met.span(part, across=True))]
        return max(*ends, float(on_base) * share)

    def at_end_of(self, parent: int, child: int) -> bool:
        """Whether a part meets another one, which is slender, at an end of the latter."""
        limb = self.parts[parent]
        low, high = self.meetings[child, parent].span(limb)
        middle = 0.5 * (low + high)
        return limb.slenderness >= STUBBY and min(middle, 1.0 - middle) < PARENT_END

    def _are_parted(self, one: int, other: int) -> bool:
        """Whether a larger part that meets both lies between them in the stack."""
        between = range(min(one, other) + 1, max(one, other))
        larger = max(self.areas[one], self.areas[other])
        return any(
            self.areas[part] > larger and self.share(one, part) > 0.0 and self.share(other, part) > 0.0
            for part in between
        )

    @cached_property
    def visible(self) -> FloatArray:
        """(n,) area of each part that no part above it hides."""
        shapely = load_shapely(NEEDED_FOR)
        seen = []
        for k, part in enumerate(self.parts):
            above = [self.parts[j].solid for j in self.near(k) if j > k]
            seen.append(float(shapely.difference(part.solid, shapely.union_all(above)).area))
        return np.array(seen)

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
            p, q = sorted(under)[-2:]
            met = self.meetings.get(p, q)
            if met is None or met.area <= PIN_SHARED * self.areas[pin] or not self._holds(pin, p, q):
                continue
            if met.area <= CONTAINED * min(self.areas[p], self.areas[q]):
                found[p, q] = found[q, p] = pin
        return found

    def _holds(self, pin: int, *limbs: int) -> bool:
        """Whether a pin lies at an end of both of two parts, or they have no ends, and in the middle of one of them."""
        shapely = load_shapely(NEEDED_FOR)
        middle = self.parts[pin].disc[0]
        is_centred = False
        for limb in limbs:
            part = self.parts[limb]
            place = float(part.along(middle[None])[0])
            if part.slenderness >= STUBBY and min(place, 1.0 - place) >= PARENT_END:
                return False
            inside = float(shapely.distance(shapely.boundary(part.solid), shapely.points(middle)))
            is_centred = is_centred or inside > PIN_CENTRED * self.radii[limb]
        return is_centred


def _end_factor(low: float, high: float) -> float:
    """How good a joint from one place to another along a part is, 0 and 1 at its ends."""
    end = 1.0 if min(low, 1.0 - high) < AT_END else OFF_END
    long = max(0.0, high - low - SHORT_SPAN) / (1.0 - SHORT_SPAN)
    return float(end * (1.0 - (1.0 - WHOLE_SPAN) * min(long, 1.0)))
