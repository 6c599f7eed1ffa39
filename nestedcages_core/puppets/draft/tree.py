"""The tree of the parts: which part hangs on which, the most likely tree of all; and which parts ride along."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...errors import invalid_setting
from ...geometry.arrays import FloatArray, IntArray
from ...libraries import load_shapely
from ..part import NEEDED_FOR, STUBBY, PuppetPart
from .arborescence import best_parents
from .covers import alternatives_of, covers_of, wheels_of
from .evidence import CONTAINED, MOSTLY
from .lexicon import TURNING
from .links import Hold, Link, PartChoice, depth_of, hangs_on
from .scores import Scores

NEVER = -1e3
"""Logarithm of the odds of what is not to be."""

ROOTS = 4
"""Parts that are tried as the root, the most likely ones."""

SMALL, THIN, CLINGS = 0.05, 0.12, 0.65
"""What rides rather than turns: leaves of less than this part of their parent's area; lines thinner than this, in radii
of the parent; leaves with more than this part of their area on the parent."""

ROUND, PIN_SIZE = 0.9, 0.25
"""A pin: its least area, in those of its largest disc, and its most, in those of each of the parts that it holds."""


def links_of(parts: Sequence[PuppetPart], choices: Mapping[str, PartChoice] | None = None) -> tuple[Link, ...]:
    """The link of every part, in the order of the parts, which is the stacking order, the lowest first.

    choices: by name of the part. Raises NestedCagesError for choices that name no part or that make a circle.
    """
    return _Tree(parts, dict(choices or {})).links()


class _Tree:
    def __init__(self, parts: Sequence[PuppetPart], choices: dict[str, PartChoice]) -> None:
        self.parts = parts
        self.scores = Scores(parts)
        self.evidence = self.scores.evidence
        number = {part.name: k for k, part in enumerate(parts)}
        wrong = [name for name in choices if name not in number]
        wrong += [choice.parent for choice in choices.values() if choice.parent and choice.parent not in number]
        if wrong:
            raise invalid_setting(f"There is no part {wrong[0]!r}; there are {', '.join(number)}.")
        self.choices = {number[name]: choice for name, choice in choices.items()}
        self.chosen = {k: number[choice.parent] for k, choice in self.choices.items() if choice.parent}
        self._check_circles()
        self.sets = [own for own in alternatives_of(parts) if not {*own} & {*self.choices}]
        shown_in_turn = {k for own in self.sets for k in own}
        self.covered = {
            high: low
            for high, low in covers_of(parts).items()
            if not {high, low} & shown_in_turn and high not in self.choices
        }
        """The limb under each cover, which is drawn with it as one thing."""
        self.wheels = [k for k in wheels_of(parts) if k not in self.choices]

    def _check_circles(self) -> None:
        for start in self.chosen:
            seen, here = {start}, start
            while here in self.chosen:
                here = self.chosen[here]
                if here in seen:
                    raise invalid_setting(f"{self.parts[start].name!r} would hang on itself; choose another parent.")
                seen.add(here)

    def links(self) -> tuple[Link, ...]:
        """The tree, then from the tips inwards who rides, then where joints lie."""
        root, parents, likely = self._tree()
        disc = self.parts[root].disc
        found = {root: Link(Hold.ROOT, None, _as_place(disc[0]), disc[1])}
        for part, parent in enumerate(parents.tolist()):
            if part != root:
                found[part] = self._link(part, parent, Hold.JOINT, float(np.exp(likely[part, parent])))
        pins = self._pins(found)
        for (part, _), pin in pins.items():
            if pin not in self.chosen:
                found[pin] = replace(found[pin], parent=part)
        for part in found:
            found[part] = replace(found[part], margin=self._margin(part, found, likely))
        for part in sorted(found, key=lambda part: -depth_of(found, part)):
            if part != root and self._rides(part, found):
                found[part] = replace(found[part], hold=Hold.RIDES)
        for part, link in found.items():
            if link.hold is Hold.JOINT and self.evidence.share(part, link.parent or 0) >= MOSTLY:
                found[part] = replace(link, joint=self._upper_end(part, found))
        for part in self.wheels:
            hub = self.parts[part].solid.convex_hull.centroid
            hold = found[part].hold if part == root else Hold.JOINT
            found[part] = replace(found[part], joint=(float(hub.x), float(hub.y)), hold=hold)
        for (part, parent), pin in pins.items():
            if found[part].parent == parent and found[part].hold is Hold.JOINT:
                found[part] = replace(found[part], joint=_as_place(self.parts[pin].disc[0]))
        for part, choice in self.choices.items():
            if choice.joint is not None:
                found[part] = replace(found[part], joint=choice.joint)
        return tuple(found[part] for part in range(len(self.parts)))

    def _tree(self) -> tuple[int, IntArray, FloatArray]:
        """The root, (n,) parents and (n, n) logarithms of probabilities of the most likely tree."""
        found = []
        for root in self._roots():
            likely = self._as_things(self.scores.of_links(root))
            gain = likely.copy()
            for part, parent in self.chosen.items():
                gain[part] = -np.inf
                gain[part, parent] = 0.0
            parents = best_parents(gain, root)
            for first, *others in self.sets:
                parents[others] = parents[first] if first != root else root
            rest = np.arange(len(parents)) != root
            found.append((self.scores.of_root[root] + gain[rest, parents[rest]].sum(), root, parents, likely))
        _, root, parents, likely = max(found, key=lambda each: float(each[0]))
        return root, parents, likely

    def _as_things(self, likely: FloatArray) -> FloatArray:
        """Probabilities where all hangs on a limb instead of its cover, nothing on a wheel but what lies in it, and
        alternatives on what the likeliest of them hangs on."""
        likely = likely.copy()
        for high, low in self.covered.items():
            others = self._beside(high, low)
            likely[others, low] = np.maximum(likely[others, low], likely[others, high])
            likely[others, high] = NEVER
            likely[high] = NEVER
            likely[high, low] = 0.0
        for wheel in self.wheels:
            likely[self._beside(wheel), wheel] = NEVER
        for first, *others in self.sets:
            likely[first] = likely[[first, *others]].max(axis=0)
            likely[:, others] = NEVER
            likely[others] = NEVER
            likely[others, first] = 0.0
            likely[first, first] = NEVER
        return likely

    def _beside(self, part: int, *apart: int) -> list[int]:
        """The other parts that do not lie in one."""
        others = (k for k in range(len(self.parts)) if k not in (part, *apart))
        return [k for k in others if self.evidence.share(k, part) < CONTAINED]

    def _roots(self) -> list[int]:
        """The chosen root, else the most likely ones."""
        roots = [part for part, choice in self.choices.items() if choice.parent == ""]
        if len(roots) > 1:
            names = " and ".join(repr(self.parts[part].name) for part in roots)
            raise invalid_setting(f"{names} can't both be the root; choose one.")
        things = {*self.chosen, *self.covered, *self.wheels, *(k for own in self.sets for k in own)}
        free = [part for part in range(len(self.parts)) if part not in things]
        free = free or [part for part in range(len(self.parts)) if part not in self.chosen]
        if not free:
            raise invalid_setting("Every part has a chosen parent; leave one of them without, as the root.")
        return roots or sorted(free, key=lambda part: -float(self.scores.of_root[part]))[:ROOTS]

    def _margin(self, part: int, found: Mapping[int, Link], likely: FloatArray) -> float:
        """How much less likely the next parent is that does not hang on this part itself."""
        parent = found[part].parent
        others = [p for p in self.evidence.near[part] if p != parent and not hangs_on(found, p, part)]
        if parent is None or not others:
            return 1.0
        return float(1.0 - np.exp(min(0.0, max(likely[part, p] for p in others) - likely[part, parent])))

    # ---- pins

    def _pins(self, found: Mapping[int, Link]) -> dict[tuple[int, int], int]:
        """Small round leaves over the joint of two parts below them, by child and parent."""
        pins = {}
        carrying = {link.parent for link in found.values()}
        for pin, each in enumerate(self.parts):
            area = self.evidence.areas[pin] / (np.pi * each.disc[1] ** 2)
            if pin in carrying or each.slenderness > STUBBY or not ROUND <= area <= 1.0 / ROUND:
                continue
            under = [
                p
                for p in self.evidence.near[pin]
                if p < pin
                and self.evidence.areas[pin] < PIN_SIZE * self.evidence.areas[p]
                and self.evidence.share(pin, p) >= CONTAINED
            ]
            held = [(p, found[p].parent) for p in under if found[p].parent in under]
            held = [pair for pair in held if found[pin].parent in pair]  # a hand before a hip holds neither
            if held:
                part, parent = max(held)
                pins[part, parent or 0] = pin
        return pins

    def _link(self, part: int, parent: int, hold: Hold, score: float) -> Link:
        met = self.evidence.meetings.get(part, parent)
        is_chosen = part in self.chosen
        if met is None:
            shapely = load_shapely(NEEDED_FOR)
            line = shapely.shortest_line(self.parts[part].solid, self.parts[parent].solid)
            middle = shapely.get_coordinates(line).mean(axis=0)
            return Link(hold, parent, _as_place(middle), 0.0, np.inf, score, 1.0, is_chosen)
        middle, radius = met.pin(self.parts[part])
        return Link(hold, parent, _as_place(middle), radius if met.area else 0.0, met.gap, score, 1.0, is_chosen)

    # ---- who rides

    def _rides(self, part: int, found: Mapping[int, Link]) -> bool:
        """Whether a part moves with its parent: a line, a small leaf, or a leaf that clings to it.

        A leaf is what nothing turns on.
        """
        wanted = self.choices.get(part, PartChoice()).hold
        if wanted is not None:
            return wanted is Hold.RIDES
        parent = found[part].parent or 0
        if self.covered.get(part) == parent or any(part in own for own in self.sets):
            return True
        if self.evidence.words[part].noun in TURNING:
            return False
        if any(other.parent == part and other.hold is Hold.JOINT for other in found.values()):
            return False
        if self.evidence.radii[part] < THIN * self.evidence.radii[parent]:
            return True
        is_small = bool(self.evidence.areas[part] < SMALL * self.evidence.areas[parent])
        return is_small or self.evidence.share(part, parent) > CLINGS

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
