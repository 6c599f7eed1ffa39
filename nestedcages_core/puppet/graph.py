"""The tree of the parts: which part hangs on which, from overlaps, stacking order, round pins and names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..errors import invalid_setting
from ..geometry.arrays import FloatArray
from ..libraries import load_shapely
from .arborescence import best_parents
from .links import Hold, Link, PartChoice, depth_of, hangs_on
from .parts import NEEDED_FOR, STUBBY, PuppetPart
from .scores import CONTAINED, Scores
from .words import MISNAMED, NAMED, PARENTS, TRUNKS, TURNING, agreement

DETAIL, MOSTLY = 0.6, 0.7
"""A part that lies in another one is a detail of it up to this part of its area; it rides on the topmost part below
with this part of its own area."""

CARRIED, SPECK = 0.25, 0.03
"""A part that carries another one of at least this part of its own area is no detail, unless it is as small as a speck,
in areas of the part that it lies in."""

LIMB, SLENDER, TIP = 0.25, 1.6, 0.35
"""A part that lies in another one hangs on a limb next to it instead, such as a hand on a sleeve over the body: for at
least this score, on a part this slender, and this near its end, in lengths of that part."""

UNCONNECTED = -20.0
"""Logarithm of the score of parts that do not meet, less their distance in diagonals of the drawing."""

SMALL, THIN, CLINGS = 0.05, 0.12, 0.65
"""What rides rather than turns: leaves of less than this part of their parent's area; lines thinner than this, in radii
of the parent, that carry nothing; leaves with more than this part of their area on the parent."""


def links_of(parts: Sequence[PuppetPart], choices: Mapping[str, PartChoice] | None = None) -> tuple[Link, ...]:
    """The link of every part, in the order of the parts, which is the stacking order, the lowest first.

    choices: by name of the part. Raises NestedCagesError for choices that name no part or that make a circle.
    """
    return _Tree(parts, dict(choices or {})).links()


class _Tree:
    def __init__(self, parts: Sequence[PuppetPart], choices: dict[str, PartChoice]) -> None:
        self.parts = parts
        self.scores = Scores(parts)
        bounds = np.array([part.outline.bounds for part in parts])
        self._size = float(np.hypot(*(bounds[:, 2:].max(axis=0) - bounds[:, :2].min(axis=0))))
        number = {part.name: k for k, part in enumerate(parts)}
        wrong = [name for name in choices if name not in number]
        wrong += [choice.parent for choice in choices.values() if choice.parent and choice.parent not in number]
        if wrong:
            raise invalid_setting(f"There is no part {wrong[0]!r}; there are {', '.join(number)}.")
        self.choices = {number[name]: choice for name, choice in choices.items()}
        self.chosen = {k: number[choice.parent] for k, choice in self.choices.items() if choice.parent}
        self._check_circles()

    def _check_circles(self) -> None:
        for start in self.chosen:
            seen, here = {start}, start
            while here in self.chosen:
                here = self.chosen[here]
                if here in seen:
                    raise invalid_setting(f"{self.parts[start].name!r} would hang on itself; choose another parent.")
                seen.add(here)

    def links(self) -> tuple[Link, ...]:
        """Details first, then limbs from the root outwards, then who rides."""
        found = self._details()
        limbs = [part for part in range(len(self.parts)) if part not in found]
        self._limbs(limbs, found)
        for part in sorted(limbs, key=lambda part: depth_of(found, part)):
            found[part] = self._held(part, found)
        for part in limbs:
            if found[part].hold is Hold.JOINT and self.scores.share(part, found[part].parent or 0) >= MOSTLY:
                found[part] = replace(found[part], joint=self._upper_end(part, found))
        for (part, other), pin in self.scores.pins.items():
            if found[part].parent == other and found[part].hold is Hold.JOINT:
                found[part] = replace(found[part], joint=_as_place(self.parts[pin].disc[0]))
                if pin not in self.chosen:
                    found[pin] = replace(found[pin], parent=part)
        for part, choice in self.choices.items():
            if choice.joint is not None:
                found[part] = replace(found[part], joint=choice.joint)
        return tuple(found[part] for part in range(len(self.parts)))

    # ---- details

    def _details(self) -> dict[int, Link]:
        """Parts within others, which ride on what is painted just below them."""
        best = [self._likely(part) for part in range(len(self.parts))]
        found: dict[int, Link] = {}
        for part in range(len(self.parts)):
            choice = self.choices.get(part, PartChoice())
            if choice.parent == "" or choice.hold is Hold.JOINT:
                continue
            if choice.hold is Hold.RIDES or self._is_detail(part, best):
                host = self.chosen.get(part, self._lies_on(part, best[part]))
                if host is not None:
                    found[part] = self._link(part, host, Hold.RIDES, 1.0)
        return found

    def _is_detail(self, part: int, best: Sequence[int | None]) -> bool:
        """Whether a part lies in another one, and neither carries a limb nor joins two parts nor hangs on a limb."""
        scores, areas = self.scores, self.scores.areas
        inside = [
            p
            for p in scores.near(part)
            if areas[part] < min(DETAIL * areas[p], scores.visible[p]) and scores.share(part, p) >= CONTAINED
        ]
        if not inside or scores.words[part].noun in TURNING:
            return False
        if all(scores.radii[part] < THIN * scores.radii[p] for p in inside):
            return True
        if any(self._hangs_beside(part, p) for p in scores.near(part)) or self._is_bridge(part):
            return False
        carries = any(
            best[other] == part and areas[other] > CARRIED * areas[part] and scores.share(other, part) < CONTAINED
            for other in scores.near(part)
        )
        return not carries or min(areas[part] / areas[p] for p in inside) < SPECK

    def _is_bridge(self, part: int) -> bool:
        """Whether larger parts that do not hold it meet a slender part at both of its ends, such as a neck."""
        scores, limb = self.scores, self.parts[part]
        if limb.slenderness < SLENDER:
            return False
        ends = set()
        for p in scores.near(part):
            share = scores.share(part, p)
            if 0.0 < share < CONTAINED and scores.areas[p] > scores.areas[part] and scores.at_end_of(part, p):
                low, high = scores.meetings[part, p].span(limb)
                ends.add(low + high > 1.0)
        return len(ends) == 2

    def _lies_on(self, part: int, otherwise: int | None) -> int | None:
        """The topmost part under a detail that holds most of it; without one, the lowest of those that lie over it.

        Where names say what it lies on, and nothing unnamed lies between, that one.
        """
        own = self.scores.words[part]
        holding = [p for p in self.scores.near(part) if self.scores.share(part, p) >= MOSTLY]
        named = [p for p in holding if agreement(own, self.scores.words[p]) > 1.0]
        if named and not any(p > max(named) and not self.scores.words[p].noun for p in holding if p < part):
            return min(named, key=lambda p: (PARENTS[own.noun].index(self.scores.words[p].noun), -p))
        below = [p for p in holding if p < part]
        return max(below) if below else min(holding, default=otherwise)

    def _likely(self, part: int) -> int | None:
        """The parent that scores best, among those that are not much smaller."""
        if part in self.chosen:
            return self.chosen[part]
        areas = self.scores.areas
        able = [p for p in self.scores.near(part) if areas[p] > 0.2 * areas[part]]
        return max(able, key=lambda p: self.scores.of(part, p), default=None)

    def _hangs_beside(self, part: int, parent: int) -> bool:
        """Whether a part over or under others hangs at the end of a slender part on the same side of them."""
        if self.scores.share(part, parent) >= CONTAINED:
            return False
        holding = [p for p in self.scores.near(part) if self.scores.share(part, p) >= CONTAINED and p != parent]
        if any((p < part) != (p < parent) for p in holding):
            return False
        limb = self.parts[parent]
        low, high = self.scores.meetings[part, parent].span(limb)
        middle = 0.5 * (low + high)
        at_tip = min(middle, 1.0 - middle) < TIP
        return at_tip and limb.slenderness >= SLENDER and self.scores.of(part, parent) >= LIMB

    # ---- limbs

    def _limbs(self, limbs: list[int], found: dict[int, Link]) -> None:
        """Links of the limbs: the tree of the best product of scores."""
        root = self._root(limbs)
        host = {part: self._host(part, found) for part in range(len(self.parts)) if part not in limbs}
        gain = np.array([[self._gain(part, p) for p in limbs] for part in limbs])
        for row, part in enumerate(limbs):
            if part in self.chosen:
                chosen = self.chosen[part]
                gain[row] = np.where(np.array(limbs) == host.get(chosen, chosen), 0.0, -np.inf)
        above = best_parents(gain, limbs.index(root))
        for part, number in zip(limbs, above.tolist(), strict=True):
            if part == root:
                disc = self.parts[root].disc
                found[root] = Link(Hold.ROOT, None, _as_place(disc[0]), disc[1])
            else:
                parent = self.chosen.get(part, limbs[number])
                found[part] = self._link(part, parent, Hold.JOINT, self.scores.of(part, parent))
        for part in limbs:
            found[part] = replace(found[part], margin=self._margin(part, found))

    def _gain(self, part: int, parent: int) -> float:
        """Logarithm of the score; of parts that do not meet, far less, and the less the farther they are apart."""
        score = self.scores.of(part, parent)
        if score > 0.0:
            return float(np.log(score))
        shapely = load_shapely(NEEDED_FOR)
        away = float(shapely.distance(self.parts[part].solid, self.parts[parent].solid))
        return UNCONNECTED - away / self._size

    def _root(self, limbs: list[int]) -> int:
        """The chosen root, else the largest part by its area and the limbs that meet it and fit it best."""
        roots = [part for part, choice in self.choices.items() if choice.parent == ""]
        if len(roots) > 1:
            names = " and ".join(repr(self.parts[part].name) for part in roots)
            raise invalid_setting(f"{names} can't both be the root; choose one.")
        free = [part for part in limbs if part not in self.chosen]
        if not roots and not free:
            raise invalid_setting("Every part has a chosen parent; leave one of them without, as the root.")
        best = [self._likely(part) for part in limbs]

        def size(part: int) -> float:
            met = sum(p in limbs for p in self.scores.near(part))
            noun = self.scores.words[part].noun
            named = NAMED if noun in TRUNKS else MISNAMED if noun else 1.0
            return float(self.scores.areas[part]) * (1 + met + best.count(part)) * named

        return roots[0] if roots else max(free, key=size)

    def _host(self, part: int, found: dict[int, Link]) -> int:
        """The limb that a detail lies on, through other details."""
        seen = {part}
        while part in found and found[part].parent is not None:
            part = found[part].parent  # type: ignore[assignment]
            if part in seen:
                raise invalid_setting("Details lie on each other in a circle; choose the parent of one of them.")
            seen.add(part)
        return part

    def _margin(self, part: int, found: Mapping[int, Link]) -> float:
        """How much lower the next limb scores that does not hang on this one itself."""
        parent = found[part].parent
        best = 1.0 if parent is None else self.scores.of(part, parent)
        others = [
            self.scores.of(part, p)
            for p in self.scores.near(part)
            if p != parent and found[p].hold is not Hold.RIDES and not hangs_on(found, p, part)
        ]
        return 1.0 - min(1.0, max(others, default=0.0) / best) if best > 0.0 else 0.0

    def _link(self, part: int, parent: int, hold: Hold, score: float) -> Link:
        met = self.scores.meetings.get(part, parent)
        is_chosen = part in self.chosen
        if met is None:
            shapely = load_shapely(NEEDED_FOR)
            line = shapely.shortest_line(self.parts[part].solid, self.parts[parent].solid)
            middle = shapely.get_coordinates(line).mean(axis=0)
            return Link(hold, parent, _as_place(middle), 0.0, np.inf, score, 1.0, is_chosen)
        middle, radius = met.pin(self.parts[part])
        return Link(hold, parent, _as_place(middle), radius if met.area else 0.0, met.gap, score, 1.0, is_chosen)

    # ---- who rides

    def _held(self, part: int, found: Mapping[int, Link]) -> Link:
        """The link of a limb, riding where it is a line, a small leaf, or a leaf that clings to its parent."""
        link, scores = found[part], self.scores
        if link.hold is not Hold.JOINT or link.parent is None:
            return link
        wanted = self.choices.get(part, PartChoice()).hold
        if wanted is not None:
            return replace(link, hold=wanted)
        base = link.parent
        while found[base].hold is Hold.RIDES:
            base = found[base].parent  # type: ignore[assignment]
        is_leaf = not any(other.parent == part and other.hold is not Hold.RIDES for other in found.values())
        is_line = is_leaf and scores.radii[part] < THIN * scores.radii[base]
        is_small = scores.areas[part] < SMALL * scores.areas[base]
        if scores.words[part].noun in TURNING:
            return link
        if is_line or (is_leaf and (is_small or scores.share(part, link.parent) > CLINGS)):
            return replace(link, hold=Hold.RIDES)
        return link

    def _upper_end(self, part: int, found: Mapping[int, Link]) -> tuple[float, float]:
        """Where a limb that lies on its parent turns: at the end away from what hangs on it, else at the upper one."""
        limb = self.parts[part]
        if limb.slenderness < STUBBY:
            return found[part].joint
        inset = min(0.5 / limb.slenderness, 0.5) * (limb.ends[1] - limb.ends[0])
        ends = limb.ends + np.stack((inset, -inset))
        below = [link.joint for link in found.values() if link.parent == part and link.hold is Hold.JOINT]
        away = np.hypot(*(ends[:, None] - np.array(below)).T).min(axis=0) if below else ends[:, 1]
        return _as_place(ends[int(away.argmax())])


def _as_place(point: FloatArray) -> tuple[float, float]:
    return float(point[0]), float(point[1])
