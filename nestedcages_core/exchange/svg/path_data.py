"""The path language of SVG: M L H V C S Q T A Z, absolute and relative (SVG 1.1, section 8.3)."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

import numpy as np

from ...geometry.arrays import FloatArray
from ..limits import Budget
from .curves import arc, line

NUMBER = re.compile(r"[\s,]*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)")
FLAG = re.compile(r"[\s,]*([01])")
COMMAND = re.compile(r"[\s,]*([MmLlHhVvCcSsQqTtAaZz])")
BLANK = re.compile(r"[\s,]*")

ARGUMENTS = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
"""How many numbers each command takes."""
FLAGS_OF_ARC = (3, 4)
"""Arguments of A that are one digit each and need no separator."""


@dataclass
class Subpath:
    """Consecutive curves, given by their control points."""

    curves: list[FloatArray] = field(default_factory=list)
    closed: bool = False


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
        self.at = np.zeros(2)
        self.begin = np.zeros(2)
        self.handle: FloatArray | None = None
        self.handle_of = ""

    def read(self) -> list[Subpath]:
        """The subpaths with at least one curve, up to the place where the data go wrong, which `fault` then says.

        Raises NestedCagesError for more points than the budget has.
        """
        try:
            self._read()
        except _WrongDataError as error:
            rest = self.data[self.place : self.place + 20].strip() or "its end"
            self.fault = f"go wrong at character {self.place} ({rest}): {error} is missing"
        return [path for path in self.subpaths if path.curves]

    def _read(self) -> None:
        command = ""
        while BLANK.match(self.data, self.place).end() < len(self.data):  # type: ignore[union-attr]
            found = COMMAND.match(self.data, self.place)
            if found:
                command = found[1]
                self.place = found.end()
            elif command in ("", "Z", "z"):
                raise _WrongDataError("a command")
            elif command in "Mm":
                command = "L" if command == "M" else "l"  # further points of a moveto are lines
            if not self.subpaths and command not in "Mm":
                raise _WrongDataError("a path that begins with M")
            self._follow(command)
            self.budget.spend("points", 1)

    def _follow(self, command: str) -> None:
        kind = command.upper()
        values = [self._argument(kind, k) for k in range(ARGUMENTS[kind])]
        origin = self.at if command.islower() else np.zeros(2)
        previous, self.handle = self.handle, None
        if kind == "M":
            self.at = self.begin = origin + values
            self.subpaths.append(Subpath())
            return
        if self.subpaths[-1].closed:
            self.subpaths.append(Subpath())
        path = self.subpaths[-1]
        if kind == "Z":
            if (self.at != self.begin).any() or not path.curves:
                path.curves.append(line(self.at, self.begin))
            self.at, path.closed = self.begin, True
            return
        if kind == "A":
            end = origin + values[5:]
            curves = arc(self.at, end, values[:2], math.radians(values[2]), bool(values[3]), bool(values[4]))
            self.budget.spend("points", len(curves))
            path.curves += curves
            self.at = end
            return
        if kind in "HV":
            end = self.at.copy()
            axis = "HV".index(kind)
            end[axis] = origin[axis] + values[0]
            control = [end]
        else:
            control = list(origin + np.reshape(values, (-1, 2)))
            if kind in "ST":  # the first control point mirrors the last one of a curve of the same kind
                like = {"S": "CS", "T": "QT"}[kind]
                mirrored = previous is not None and self.handle_of in like
                control.insert(0, 2.0 * self.at - previous if mirrored else self.at)  # type: ignore[operator]
            if kind in "CSQT":
                self.handle, self.handle_of = control[-2], kind
        path.curves.append(np.stack((self.at, *control)))
        self.at = control[-1]

    def _argument(self, kind: str, index: int) -> float:
        pattern = FLAG if kind == "A" and index in FLAGS_OF_ARC else NUMBER
        found = pattern.match(self.data, self.place)
        if not found:
            raise _WrongDataError(f"argument {index + 1} of {kind}")
        self.place = found.end()
        return float(found[1])
