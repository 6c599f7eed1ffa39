"""Levels as the user gives them: vertex counts, percentages and own drawings, clamped to what a drawing allows."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from ..core import core
from ..errors import UserError

Percent = float
# Stands for an own coarse drawing in a list of levels.
OWN = "*"
Level = int | Percent | str
# Vertices per loop that a percentage comes to at least, if the loop has them: a triangle around a rectangle is twice as
# large. Whoever wants one asks for three.
LEAST_OF_A_PERCENTAGE = 4


@dataclass(frozen=True)
class Wanted:
    """A vertex count or own ``Mesh``, and what is to be said about it."""

    level: int | core.Mesh
    notes: tuple[str, ...] = ()


def parse_levels(text: str) -> tuple[Level, ...]:
    """Counts, percentages and own drawings from a text such as "64, 24", "10% 3%" or "64, *". Raises: UserError."""
    levels: list[Level] = []
    words = re.findall(r"[^\s,;]+", re.sub(r"\s+%", "%", text)) or [text]
    for word in words:
        if re.fullmatch(r"\d+", word):
            levels.append(int(word))
        elif re.fullmatch(r"\d+(\.\d*)?%|\.\d+%", word):
            levels.append(float(word[:-1]))
        elif word == OWN:
            levels.append(OWN)
        else:
            raise UserError(
                "Levels are vertex counts such as 64, 24 or percentages such as 10%, separated by commas, or * for an "
                f"object of your own; '{word}' is none of these"
            )
    return tuple(levels)


def counted(level: int | Percent, fine: core.Mesh) -> Wanted:
    """The vertex count that a level comes to for a drawing's ``Mesh``: enough for each loop."""
    total, sizes = len(fine.vertices), [len(loop) for loop in fine.loops]
    loops = "an outline needs" if len(sizes) == 1 else f"its {len(sizes)} loops need"
    if isinstance(level, int):
        least = 3 * len(sizes)
        note = f"A level of {level} is too small: {loops} {least} vertices, and so many are used."
        return Wanted(level) if level >= least else Wanted(least, (note,))
    count = count_of(level, sizes)
    note = f"{level:g} % of {total} vertices is too few: {loops} {count} for a close fit, and so many are used."
    return Wanted(count, () if count == round(total * level / 100.0) else (note,))


def count_of(level: Percent, sizes: Sequence[int]) -> int:
    """The vertices that a percentage comes to for loops of these sizes."""
    least = sum(min(size, LEAST_OF_A_PERCENTAGE) for size in sizes)
    return max(round(sum(sizes) * level / 100.0), least)


def wanted_levels(levels: Sequence[Level], fine: core.Mesh, own: Sequence[core.Mesh], name: str) -> tuple[Wanted, ...]:
    """The vertex count or own ``Mesh`` of each level. Raises: UserError."""
    if not levels:
        return tuple(Wanted(mesh) for mesh in own)
    if levels.count(OWN) != len(own):
        raise UserError(
            f"'{name}': own objects (*) in the levels: {levels.count(OWN)}, objects named: {len(own)}; "
            "name one for each"
        )
    meshes = iter(own)
    return tuple(Wanted(next(meshes)) if isinstance(level, str) else counted(level, fine) for level in levels)
