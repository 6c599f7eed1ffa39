"""Levels as users write them, in Python, in the shell and in Blender: counts, percentages, distances, excesses."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import isfinite

from ..errors import NestingError
from ..tolerance.within import Within
from .targets import Share

UNITS: Mapping[str, float] = {"px": 1.0, "u": 1.0}
"""Suffixes of distances with their lengths in input units: pixels and units of a file, which mean the same."""

LENGTHS = ("mm", "cm", "m", "km", "in", "ft", "yd", "pt")
"""Units that a scene of Blender has, and plain coordinates do not."""

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
    Raises NestingError.
    """
    found = re.fullmatch(r"(\+?)(\d+\.?\d*(?:e[+-]?\d+)?|\.\d+(?:e[+-]?\d+)?)([^\d.]*)", word)
    sign, number, unit = found.groups() if found else ("", "nan", "")
    if re.fullmatch(EITHER_WAY, word):
        first, second = word.split(",")
        raise NestingError(
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
    known = f"a number of vertices such as 24, a share of them such as 8%, a distance such as 2{next(iter(units))}"
    named = f" Coordinates have no {unit} here; {number}u is {number} of their own units."
    raise NestingError(
        f"A level is {known}, or more area such as +25%; {word!r} is none of these."
        + (named if unit in LENGTHS and unit not in units else ""),
        code="level.invalid",
    )
