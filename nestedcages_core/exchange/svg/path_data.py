"""The path language of SVG: M L H V C S Q T A Z, absolute and relative (SVG 1.1, section 8.3)."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ..limits import Budget
from .curves import CUBIC, LINE, arc, flattened

NUMBER = r"[\s,]*+((?>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?))"
FLAG = r"[\s,]*+([01])"
"""One digit, which needs no separator."""

NUMBERS, BLANK = re.compile(NUMBER), re.compile(r"[\s,]*")

ARGUMENTS = {
    **{kind: [NUMBER] * count for kind, count in zip("ZHVMLTSQC", (0, 1, 1, 2, 2, 2, 4, 4, 6), strict=True)},
    "A": [*[NUMBER] * 3, FLAG, FLAG, NUMBER, NUMBER],
}
"""What each command takes, again and again."""

ARC = re.compile("".join(ARGUMENTS["A"]))
WHOLE = {kind: re.compile(f"(?:{''.join(taken)})*+" if taken else "") for kind, taken in ARGUMENTS.items()}

LENGTH_TOLERANCE = 1e-5
"""Distance of chords from curves, over their size, where lengths are measured."""

MIRRORED = {"S": "CS", "T": "QT"}
"""Commands whose first control point mirrors the last one of a curve of one of these kinds."""


@dataclass(frozen=True, eq=False)
class Subpath:
    """Consecutive lines and Bézier curves; each begins where the one before ends."""

    points: FloatArray
    """(k, 2) all control points; ends that curves share are there once."""
    degrees: IntArray
    """(n,) of the curves."""
    closed: bool = False

    @property
    def is_curved(self) -> bool:
        return bool((self.degrees != LINE).any())

    @property
    def curves(self) -> list[FloatArray]:
        """The control points of each curve."""
        ends = np.cumsum(self.degrees).tolist()
        return [self.points[begin : end + 1] for begin, end in zip([0, *ends[:-1]], ends, strict=True)]


def length_of(subpaths: Sequence[Subpath]) -> float:
    """The length of all subpaths together."""
    found = 0.0
    for path in subpaths:
        points = flattened(path.points, path.degrees, LENGTH_TOLERANCE * float(np.ptp(path.points, axis=0).max()))
        found += float(np.hypot(*np.diff(points, axis=0).T).sum())
    return found


class _WrongDataError(Exception):
    """What is missing."""


class PathReader:
    """Follows path data command by command."""

    def __init__(self, data: str, budget: Budget) -> None:
        self.data = data
        self.budget = budget
        self.place = 0
        self.fault = ""
        self.subpaths: list[Subpath] = []
        self.points: list[float] = []
        """x and y of the current subpath's control points in turn; empty before the first one."""
        self.degrees: list[int] = []
        self.before = "M"
        """The command before."""

    def read(self) -> list[Subpath]:
        """The subpaths with at least one curve, up to the place where the data go wrong, which `fault` then says.

        Raises NestedCagesError for more points than the budget has.
        """
        try:
            self._read()
        except _WrongDataError as error:
            rest = self.data[self.place : self.place + 20].strip() or "its end"
            self.fault = f"go wrong at character {self.place} ({rest}): {error} is missing"
        self._end_subpath(closed=False)
        return self.subpaths

    def _read(self) -> None:
        command = ""
        while (begin := BLANK.match(self.data, self.place).end()) < len(self.data):  # type: ignore[union-attr]
            letter = self.data[begin]
            if letter.upper() in ARGUMENTS and letter.isascii():
                command, self.place = letter, begin + 1
            elif command in ("", "Z", "z"):
                raise _WrongDataError("a command")
            else:
                self._find_missing(command.upper())
            kind = command.upper()
            if kind != "M" and not self.points:
                raise _WrongDataError("a path that begins with M")
            text = WHOLE[kind].match(self.data, self.place)[0]  # type: ignore[index]
            taken = ARC.findall(text) if kind == "A" else NUMBERS.findall(text)
            values = [float(each) for each in (chain.from_iterable(taken) if kind == "A" else taken)]
            if not values and kind != "Z":
                self._find_missing(kind)
            self.budget.spend("points", len(values) // len(ARGUMENTS[kind]) if values else 1)
            self._follow(kind, values, relative=command.islower())
            self.place += len(text)

    def _find_missing(self, kind: str) -> None:
        """Raise the error for the first argument that is not there."""
        for number, pattern in enumerate(ARGUMENTS[kind], 1):
            found = re.compile(pattern).match(self.data, self.place)
            if not found:
                raise _WrongDataError(f"argument {number} of {kind}")
            self.place = found.end()

    def _follow(self, kind: str, values: list[float], *, relative: bool) -> None:
        """Add what a command draws, as often as it has arguments."""
        if kind == "Z":
            begin = self.points[:2]
            if self.points[-2:] != begin or not self.degrees:
                self._add(kind, begin, LINE)
            self._end_subpath(closed=True)
            self.points, self.before = begin, kind
        size = len(ARGUMENTS[kind])
        for place in range(0, len(values), size or 1):
            given, (x, y) = values[place : place + size], self.points[-2:] or (0.0, 0.0)
            if relative:
                origin = {"V": (y,), "A": (0.0, 0.0, 0.0, 0.0, 0.0, x, y)}.get(kind, (x, y) * 3)
                given = [value + shift for value, shift in zip(given, origin, strict=False)]
            if kind == "M":
                self._end_subpath(closed=False)
                self.points, self.before, kind = given, kind, "L"  # further points of a moveto are lines
            elif kind == "A":
                rx, ry, degrees, large, sweep, *end = given
                found = arc((x, y), (end[0], end[1]), (rx, ry), math.radians(degrees), bool(large), bool(sweep))
                degree = LINE if len(found) == 1 else CUBIC
                self.budget.spend("points", len(found) // degree)
                self._add(kind, found.ravel().tolist(), degree)
            else:
                if kind in "HV":
                    given = [given[0], y] if kind == "H" else [x, given[0]]
                elif kind in "ST":
                    handle = self.points[-4:-2] if self.before in MIRRORED[kind] else (x, y)
                    given = [2.0 * x - handle[0], 2.0 * y - handle[1], *given]
                self._add(kind, given, len(given) // 2)

    def _add(self, kind: str, given: list[float], degree: int) -> None:
        """Add the curves of a command to the subpath, through control points in turn."""
        self.points += given
        self.degrees += [degree] * (len(given) // (2 * degree))
        self.before = kind

    def _end_subpath(self, *, closed: bool) -> None:
        if self.degrees:
            self.subpaths.append(Subpath(np.reshape(self.points, (-1, 2)), np.array(self.degrees), closed))
        self.degrees = []
