"""Layers that are one part: the colour, shades and lines of one limb; and what in a file is no drawing.

A line layer is hollow and its filled outline holds the colour: both, and what lies between, are one part. A layer whose
name is a number, or repeats in other groups, says its role, not what it is: the group says that.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import groupby
from typing import Protocol, TypeVar

import numpy as np
import scipy

from ...formats.pictures.png import Pixels
from ...geometry.arrays import BoolArray
from .layer import NORMAL, Layer, Notes
from .painting import PicturePart, paint_onto

HOLLOW, HOLDS, ALIKE, WITHIN = 0.7, 0.95, 0.5, 0.9
"""A line layer: most of its filled outline that it paints; least part of the colour in that; least common area over
joined area; and what part of a shade lies in the colour."""

SOLID = 64
"""Alpha from which pixels make up an outline."""

BACKGROUND = re.compile(
    r"(?i)^\W*(back[ -]?ground|bg|backdrop|paper|fondo|fundo|sfondo|hintergrund|fond|tło|tausta|bakgrund|фон|"
    r"задний план|背景|배경|用紙)\W*\d*$"
)
"""Names of what is no part of a figure."""

AIDS = re.compile(r"(?i)^\W*(skeleton|joints?|pivots?|bones?|guides?|sketch|reference|rig)\W*\d*$")
"""Names of groups that hold an artist's aids."""

TAG = re.compile(r"\[[^\]]*\]")
"""What scripts of other programs read in a name: [ignore], [merge], [bone:hand]."""


class Named(Protocol):
    """A part of any kind."""

    @property
    def name(self) -> str: ...

    @property
    def groups(self) -> tuple[str, ...]: ...


Part = TypeVar("Part", bound=Named)


def without_aids(parts: Sequence[Part], notes: Notes) -> list[Part]:
    """The parts without what is tagged or named as no part of the figure."""
    found = []
    for part in parts:
        names = (*part.groups, part.name)
        if any("[ignore" in name.lower() for name in names) or any(AIDS.match(name) for name in part.groups):
            notes.add("Left out, since its name says that it is no drawing: {}.", part.name)
        elif any(BACKGROUND.match(TAG.sub("", name)) for name in names):
            notes.add("Backgrounds are left out: {}.", part.name)
        else:
            found.append(part)
    return found or list(parts)


def as_things(parts: Sequence[PicturePart], notes: Notes) -> list[PicturePart]:
    """Each limb once, by the name that tells what it is, without tags."""
    roles = Counter(role for groups, own in _groups(parts) if groups for role in {_role(part) for part in own})
    found: list[PicturePart] = []
    for groups, own in _groups(parts):
        merged = _merged(own, roles) if groups else own
        if len(merged) < len(own):
            notes.add("Layers of one part are painted together: {}.", groups[-1])
        for part in merged:
            is_alone = len(merged) == 1 and groups and (len(own) > 1 or _is_role(part, roles))
            name, above = (groups[-1], groups[:-1]) if is_alone else (part.name, groups)
            found.append(replace(part, name=_untagged(name), groups=tuple(map(_untagged, above))))
    return found


def _untagged(name: str) -> str:
    return " ".join(TAG.sub("", name).split()) or name


def _groups(parts: Sequence[PicturePart]) -> Iterable[tuple[tuple[str, ...], list[PicturePart]]]:
    return ((groups, list(own)) for groups, own in groupby(parts, key=lambda part: part.groups))


def _role(part: PicturePart) -> str:
    """A name without that of its group and without the number of a copy."""
    name = part.name.lower()
    if part.groups:
        name = name.replace(part.groups[-1].lower(), "")
    return re.sub(r"[\W\d_]+$", "", name).strip()


def _is_role(part: PicturePart, roles: Counter[str]) -> bool:
    return not re.search(r"[^\W\d_]", part.name) or roles[_role(part)] > 1


def _merged(own: list[PicturePart], roles: Counter[str]) -> list[PicturePart]:
    """The layers of one group with those painted together that are one thing."""
    if len(own) < 2:
        return own
    if any("[merge" in name.lower() for name in own[0].groups):
        return [_together(own)]
    shapes = [_Shape(part) for part in own]
    pairs = ((low, high) for low in range(len(own)) for high in range(low + 1, len(own)))
    linked = [pair for pair in pairs if _are_lines_and_colour(shapes, *pair)]
    if not linked:
        return own
    first, last = min(low for low, _ in linked), max(high for _, high in linked)
    base = max(shapes[first : last + 1], key=lambda each: each.area)

    def is_shade(k: int) -> bool:
        named = own[k].blend != NORMAL or roles[_role(own[k])] > 1
        return named and shapes[k].share_in(base) >= WITHIN

    while first > 0 and is_shade(first - 1):
        first -= 1
    while last < len(own) - 1 and is_shade(last + 1):
        last += 1
    return [*own[:first], _together(own[first : last + 1]), *own[last + 1 :]]


def _are_lines_and_colour(shapes: Sequence[_Shape], low: int, high: int) -> bool:
    """Whether one of two shapes is the lines around the other, and all between them lie in it."""
    lines, colour = sorted((shapes[low], shapes[high]), key=lambda each: each.hollow)
    if lines.hollow >= HOLLOW or colour.share_in(lines) < HOLDS:
        return False
    shared = colour.shared(lines)
    is_alike = shared >= ALIKE * (colour.area + lines.area - shared)
    return is_alike and all(each.share_in(lines) >= WITHIN for each in shapes[low + 1 : high])


class _Shape:
    """A part's filled outline on the canvas."""

    def __init__(self, part: PicturePart) -> None:
        alpha = part.seen[..., 3]
        self.left, self.top, self.opaque = part.left, part.top, alpha >= min(SOLID, int(alpha.max()))

    @cached_property
    def filled(self) -> BoolArray:
        return np.asarray(scipy.ndimage.binary_fill_holes(self.opaque))

    @cached_property
    def area(self) -> float:
        return float(self.filled.sum())

    @property
    def hollow(self) -> float:
        """The part of the filled outline that is painted."""
        return float(self.opaque.sum()) / self.area

    def shared(self, other: _Shape) -> float:
        """Pixels that both fill."""
        x, y = other.left - self.left, other.top - self.top
        height, width = other.filled.shape
        own = self.filled[max(y, 0) : max(y + height, 0), max(x, 0) : max(x + width, 0)]
        rows, columns = slice(max(-y, 0), max(-y, 0) + own.shape[0]), slice(max(-x, 0), max(-x, 0) + own.shape[1])
        return float(np.count_nonzero(own & other.filled[rows, columns])) if own.size else 0.0

    def share_in(self, other: _Shape) -> float:
        return self.shared(other) / self.area


def _together(own: Sequence[PicturePart]) -> PicturePart:
    """Layers, the lowest first, painted onto each other."""
    left, top = min(part.left for part in own), min(part.top for part in own)
    right = max(part.left + part.pixels.shape[1] for part in own)
    bottom = max(part.top + part.pixels.shape[0] for part in own)
    pixels: Pixels = np.zeros((bottom - top, right - left, 4), np.uint8)
    shown = [part for part in own if part.is_visible] or own
    for part in shown:
        paint_onto(pixels, left, top, Layer(part.name, part.left, part.top, part.seen, blend=part.blend))
    base = max(shown, key=lambda part: int(np.count_nonzero(part.seen[..., 3])))
    return replace(base, left=left, top=top, pixels=pixels, opacity=1.0, blend=NORMAL)
