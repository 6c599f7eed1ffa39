"""Left and right, near and far: from names, from mirrored places, and from the stacking order."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import takewhile

import numpy as np

from ...geometry.vectors import norm
from ..part import PuppetPart
from .lexicon import DEPTHS, SIDES
from .links import Hold, Link, hangs_on
from .names import name_without, name_words, side_of, words_of

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
    near_side = _near_side(parts, links, root)
    linked = dict(enumerate(links))
    ends = [words_of(part.name).labels[2] for part in parts]

    def may_be(one: int, other: int) -> bool:
        if hangs_on(linked, one, other) or hangs_on(linked, other, one):
            return False
        return not (ends[one] and ends[other] and ends[one] != ends[other])

    free = {k for k, side in enumerate(found) if not side.side}
    named = _named_pairs(parts, free)
    free -= {part for pair in named for part in pair}
    pairs = [(one, other, False) for one, other in named] + list(_pairs(parts, root, free, may_be))
    for one, other, is_front in pairs:
        if is_front:
            is_left = parts[one].disc[0][0] > parts[root].disc[0][0]
            sides, depths = ("L", "R") if is_left else ("R", "L"), ("", "")
        else:
            sides, depths = ("R", "L") if near_side == "L" else ("L", "R"), ("far", "near")
        stems = _stems(parts[one].name, parts[other].name)
        for part, side, depth, stem in zip((one, other), sides, depths, stems, strict=True):
            found[part] = Side(side, depth, stem)
    return tuple(found)


def _named_pairs(parts: Sequence[PuppetPart], free: Iterable[int]) -> list[tuple[int, int]]:
    """Parts whose names say that one is far and the other near, the far one first."""
    left, found = set(free), list[tuple[int, int]]()
    for pair in _nearest_first(parts):
        if {*pair} <= left and _are_named(*(parts[k].name for k in pair)):
            left -= {*pair}
            found.append(pair if _by_name(parts[pair[0]].name).depth == "far" else pair[::-1])
    return found


def twins_of(parts: Sequence[PuppetPart], root: int) -> list[int]:
    """For each part the one that is left where it is right, or far where it is near; without one, the part itself."""
    twins = list(range(len(parts)))
    for one, other, _ in _pairs(parts, root, set(twins), lambda one, other: True):
        twins[one], twins[other] = other, one
    return twins


def _pairs(
    parts: Sequence[PuppetPart], root: int, free: Iterable[int], may_be: Callable[[int, int], bool]
) -> Iterator[tuple[int, int, bool]]:
    """Near and far parts, the far one first, then left and right ones, and whether they are the latter.

    free: which parts may be in a pair; may_be: whether two may be one.
    """
    left = set(free) - {root}
    middle = float(parts[root].disc[0][0])
    pairs = _nearest_first(parts)
    for is_front in (False, True):
        for one, other in pairs:
            if not {one, other} <= left or not may_be(one, other):
                continue
            if is_front:
                is_pair = _are_mirrored(parts[one], parts[other], middle)
            else:
                is_pair = _are_near_and_far(parts, one, root, other)
            if is_pair:
                left -= {one, other}
                yield one, other, is_front


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


def _are_near_and_far(parts: Sequence[PuppetPart], one: int, trunk: int, other: int) -> bool:
    """Whether the trunk lies between two parts in the stack that are less than half of its length apart."""
    away, length = parts[one].disc[0] - parts[other].disc[0], parts[trunk].box[1] - parts[trunk].box[0]
    return one < trunk < other and bool(norm(away) < 0.5 * norm(length))


def _near_side(parts: Sequence[PuppetPart], links: Sequence[Link], root: int) -> str:
    """The side that is seen of a figure from the side: L if it looks towards smaller x.

    It looks to where most details of its limbs are: eyes, noses and mouths lie in the head.
    """
    details = [k for k, link in enumerate(links) if link.hold is Hold.RIDES and link.parent != root]
    places = np.array([parts[k].disc[0][0] for k in details])
    return "R" if np.sign(places - parts[root].disc[0][0]).sum() > 0.0 else "L"


def _are_named(one: str, other: str) -> bool:
    """Whether names differ only in that one is near and the other far."""
    depths = {_by_name(name).depth for name in (one, other)}
    return depths == {"near", "far"} and name_without(one, DEPTHS) == name_without(other, DEPTHS)


def _nearest_first(parts: Sequence[PuppetPart]) -> list[tuple[int, int]]:
    """The pairs of parts that are alike, by the distance of their middles."""
    return sorted(alike_pairs(parts), key=lambda pair: float(norm(parts[pair[0]].disc[0] - parts[pair[1]].disc[0])))


def alike_pairs(parts: Sequence[PuppetPart]) -> Iterator[tuple[int, int]]:
    """Pairs of parts of the same shape, whatever their direction, or whose names say that they are near and far."""
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
            one, other = parts[j].name, parts[i].name
            if _are_named(one, other) or (np.abs(np.log(figures[i] / figures[j])) < ALIKE).all():
                yield j, i
