"""Left and right, near and far: from names, from mirrored places, and from the stacking order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import takewhile

import numpy as np

from ..geometry.vectors import norm
from .links import Hold, Link, hangs_on
from .parts import PuppetPart
from .words import DEPTHS, SIDES, name_without, name_words, side_of

MIRRORED = 0.12
"""Two parts are left and right if their mirrored middles are this near, in their length plus their distance."""

ALIKE = 0.06
"""Parts have the same shape if area, radius and both sides of their boxes differ by less than this part."""

LEAST_STEM = 3
"""Letters that two names must begin with to share a name."""


@dataclass(frozen=True)
class Side:
    """Which of two parts one is."""

    side: str = ""
    """"L" or "R", as for mirrored poses in Blender: L is at larger x from the front, and the near side of a figure that
    looks towards smaller x; empty for parts in the middle."""
    depth: str = ""
    """"near" or "far", for two limbs before and behind the same part; else empty."""
    stem: str = ""
    """The part's name without words for the side."""


def sides_of(parts: Sequence[PuppetPart], links: Sequence[Link]) -> tuple[Side, ...]:
    """The side of every part."""
    found = [_by_name(part.name) for part in parts]
    root = next(k for k, link in enumerate(links) if link.parent is None)
    middle = float(parts[root].disc[0][0])
    taken = {root} | {k for k, side in enumerate(found) if side.side}
    near_side = _near_side(parts, links, root)
    linked = dict(enumerate(links))
    for far, near in _alike(parts):
        if far in taken or near in taken or hangs_on(linked, far, near) or hangs_on(linked, near, far):
            continue
        stems = _stems(parts[far].name, parts[near].name)
        if _are_mirrored(parts[far], parts[near], middle):
            sides = ("L", "R") if parts[far].disc[0][0] > middle else ("R", "L")
            depths = ("", "")
        elif far < root < near:
            sides = ("R", "L") if near_side == "L" else ("L", "R")
            depths = ("far", "near")
        else:
            continue
        for part, side, depth, stem in zip((far, near), sides, depths, stems, strict=True):
            found[part] = Side(side, depth, stem)
        taken |= {far, near}
    return tuple(found)


def _by_name(name: str) -> Side:
    """The side that a name says."""
    side = side_of(name)
    depth = next((word.lower() for word in name_words(name) if word.lower() in ("near", "far")), "")
    return Side(side, depth, name_without(name, SIDES) if side else name)


def _stems(one: str, other: str) -> tuple[str, str]:
    """The name that both are given, if theirs differ by a word for the depth or at the end; else their own ones."""
    stem = name_without(one, DEPTHS)
    if stem != name_without(other, DEPTHS):
        same = takewhile(lambda pair: pair[0] == pair[1], zip(one, other, strict=False))
        stem = "".join(letter for letter, _ in same).rstrip("._- ")
    return (stem, stem) if len(stem) >= LEAST_STEM else (one, other)


def _are_mirrored(one: PuppetPart, other: PuppetPart, middle: float) -> bool:
    """Whether two parts lie left and right of a vertical line, at about equal distances and heights."""
    a, b = one.disc[0], other.disc[0]
    size = float(norm(one.box[1] - one.box[0])) + abs(float(a[0] - b[0]))
    off = np.array([a[0] + b[0] - 2.0 * middle, a[1] - b[1]])
    return bool(norm(off) < MIRRORED * size and (a[0] - middle) * (b[0] - middle) < 0.0)


def _near_side(parts: Sequence[PuppetPart], links: Sequence[Link], root: int) -> str:
    """The side that is seen of a figure from the side: L if it looks towards smaller x.

    It looks to where most details of its limbs are: eyes, noses and mouths lie in the head.
    """
    details = [k for k, link in enumerate(links) if link.hold is Hold.RIDES and link.parent != root]
    places = np.array([parts[k].disc[0][0] for k in details])
    return "R" if np.sign(places - parts[root].disc[0][0]).sum() > 0.0 else "L"


def _alike(parts: Sequence[PuppetPart]) -> Iterator[tuple[int, int]]:
    """Pairs of parts of the same shape, whatever their direction."""
    figures = np.array(
        [
            (
                np.sqrt(part.outline.area),
                part.disc[1],
                np.hypot(*(part.box[1] - part.box[0])),
                np.hypot(*(part.box[2] - part.box[1])),
            )
            for part in parts
        ]
    )
    for i in range(len(parts)):
        for j in range(i):
            if (np.abs(np.log(figures[i] / figures[j])) < ALIKE).all():
                yield j, i
