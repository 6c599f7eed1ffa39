"""Levels as text, in the shell and in Blender: vertex counts, percentages, distances, excesses."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import isfinite

from ..errors import NestedCagesError
from ..tolerance.within import Within
from .levels import Share

UNITS: Mapping[str, float] = {"px": 1.0, "u": 1.0}
"""Suffixes of distances with their lengths in input units: pixels and units of a file, which mean the same."""

EITHER_WAY = r"(?<![\d.,%])\+?\d+,\d+[^\d\s.,;][^\s,;]*(?!,)"
"""A number with a decimal comma and a unit, or a count and another level, where no further comma tells."""


def level_words(text: str, units: Mapping[str, float] = UNITS) -> list[str]:
    """The levels of a text such as "32, 8 %; 2 px +25 %": separators are commas, semicolons and spaces.

    A comma between digits with a unit behind them, as in "2,5 mm", is a decimal one where no count can stand before it;
    "12,5 %" may be meant either way and stays one word, which `parse_level` rejects.
    """
    names = "|".join(sorted(map(re.escape, units), key=len, reverse=True))
    joined = re.sub(rf"(?<=[\d.])\s+(?=%|(?:{names})(?![^\s,;]))", "", text.lower())
    joined = re.sub(r"\+\s+(?=[\d.])", "+", joined)
    joined = re.sub(r"(?<![\d.,])\+?[012],(?=\d+[^\d\s.,;])", lambda found: found[0].replace(",", "."), joined)
    return re.findall(rf"{EITHER_WAY}|[^\s,;]+", joined)


def parse_level(word: str, units: Mapping[str, float] = UNITS) -> int | Share | Within:
    """Parse one level: `64`, `20%`, `2px` or `+25%`.

    units: suffixes of distances with their lengths; the first one is the example in messages.
    Raises NestedCagesError.
    """
    found = re.fullmatch(r"(\+?)(\d+\.?\d*(?:e[+-]?\d+)?|\.\d+(?:e[+-]?\d+)?)([^\d.]*)", word)
    sign, number, unit = found.groups() if found else ("", "nan", "")
    if re.fullmatch(EITHER_WAY, word):
        first, second = word.split(",")
        raise NestedCagesError(
            f"{word!r} may be one level or two; write {first}.{second}, or {first}, {second}.", code="level.invalid"
        )
    value = float(number)
    if isfinite(value) and value > 0.0:
        if unit in units and not sign:
            return Within(distance=value * units[unit])
        if unit == "%" and sign:
            return Within(excess=value / 100.0)
        if unit == "%" and value <= 100.0:
            return Share(value / 100.0)
        if not unit and not sign and number.isdecimal():
            return int(number)
    known = ("a whole number of at least 1", "a percentage such as 8%", f"a distance such as 2{next(iter(units))}")
    raise NestedCagesError(
        f"A level is {', '.join(known)}, or an excess such as +25%; {word!r} is none of these.", code="level.invalid"
    )


def order_of(levels: Sequence[int | Share | Within]) -> str:
    """What is odd about the order of levels, each around the one before; empty if nothing is."""

    def size(level: int | Share | Within) -> tuple[str, float]:
        if isinstance(level, Within):
            return ("distance", -level.distance) if level.distance is not None else ("excess", -level.limit)
        return ("share", level.fraction) if isinstance(level, Share) else ("count", float(level))

    for k, (one, other) in enumerate(pairwise(map(size, levels)), 1):
        if one[0] == other[0] and one[1] < other[1]:
            return (
                f"Level {k + 1} is finer than level {k}: each level encloses the one before, so the finest comes "
                "first; a finer one around it gains nothing."
            )
    return ""
