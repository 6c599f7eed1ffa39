"""Parts of the same shape, left and right or near and far: what is certain of one tells about the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .links import Hold, Link
from .parts import PuppetPart

if TYPE_CHECKING:
    from .scores import Scores

ALIKE = 0.06
"""Parts have the same shape if area, radius and both sides of their boxes differ by less than this part."""


def alike(parts: Sequence[PuppetPart]) -> Iterator[tuple[int, int]]:
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


def with_twins(scores: Scores, found: dict[int, Link], fixed: Set[int]) -> None:
    """Hang the twin of a part as that part hangs, if the latter is more certain and the twin meets that parent.

    found: links of all parts, changed in place; fixed: parts that a user has decided about.
    """
    pairs = [pair for pair in alike(scores.parts) if all(found[k].hold is Hold.JOINT for k in pair)]
    twins: dict[int, list[int]] = {}
    for i, j in pairs:
        twins.setdefault(i, []).append(j)
        twins.setdefault(j, []).append(i)
    for one, other in (pair for pair in pairs for pair in (pair, pair[::-1])):
        certain, parent = found[one], found[one].parent
        if parent is None or other in fixed or found[other].margin >= certain.margin:
            continue
        wanted = [p for p in (*twins.get(parent, ()), parent) if p != other and scores.of(other, p) > 0.0]
        if not wanted or found[other].parent in (parent, *twins.get(parent, ())):
            continue
        new = max(wanted, key=lambda p: scores.of(other, p))
        if not hangs_on(found, new, other):
            met = scores.meetings[other, new]
            middle, radius = met.disc
            found[other] = replace(
                found[other],
                parent=new,
                joint=(float(middle[0]), float(middle[1])),
                radius=radius if met.area else 0.0,
                gap=met.gap,
                score=scores.of(other, new),
                margin=0.0,
            )


def hangs_on(found: Mapping[int, Link], part: int | None, other: int) -> bool:
    """Whether a part hangs on another one, however indirectly."""
    while part is not None:
        if part == other:
            return True
        part = found[part].parent
    return False
