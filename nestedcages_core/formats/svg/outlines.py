"""Outlines of paths and basic shapes, which are paths too (SVG 1.1, sections 8 and 9)."""

from __future__ import annotations

import math
import re
from itertools import chain
from xml.etree import ElementTree as ET

import numpy as np

from ..limits import Quota
from .curves import CONIC, LINE, Subpath
from .elements import name_of, title_of
from .lengths import Viewport, attribute

OUTLINED = frozenset(("path", "rect", "circle", "ellipse", "line", "polyline", "polygon"))
"""Elements with an outline."""

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

MIRRORED = {"S": "CS", "T": "QT"}
"""Commands whose first control point mirrors the last one of a curve of one of these kinds."""

MAX_ARC = math.pi / 2.0
"""Radians of one conic."""

FLATTEST = 1e-30
"""Radii by coordinates, and (chord / diameter) squared, below which an elliptical arc is a line."""

Point = tuple[float, float]


def outline(item: ET.Element, viewport: Viewport, quota: Quota) -> list[Subpath]:
    """The outline of an element, in its own units, up to what cannot be read.

    Raises NestedCagesError where points go beyond the quota.
    """
    reader = PathReader(_path_data(item, viewport), quota)
    found = reader.read()
    if reader.fault:
        viewport.faults.add(f"The data of the {title_of(item)} {reader.fault}; the rest is left out")
    return found


def _path_data(item: ET.Element, viewport: Viewport) -> str:
    name = name_of(item)

    def length(key: str) -> float:
        return attribute(item, key, viewport)

    if name == "path":
        return item.get("d", "")
    if name in ("polygon", "polyline"):
        points = item.get("points", "").strip()
        return f"M{points}{'Z' if name == 'polygon' else ''}" if points else ""
    if name == "line":
        return f"M{length('x1')} {length('y1')}L{length('x2')} {length('y2')}"
    given = ["r"] if name == "circle" else [key for key in ("rx", "ry") if item.get(key, "auto").strip() != "auto"]
    rx, ry = (length(key if key in given else (given or [key])[0]) for key in ("rx", "ry"))
    if name == "rect":
        return rectangle(length("x"), length("y"), length("width"), length("height"), rx, ry)
    x, y, arc = length("cx"), length("cy"), f"A{rx} {ry} 0 0 1 "
    around = f"M{x + rx} {y}{arc}{x} {y + ry}{arc}{x - rx} {y}{arc}{x} {y - ry}{arc}{x + rx} {y}Z"
    return around if min(rx, ry) > 0.0 else ""


def rectangle(x: float, y: float, width: float, height: float, rx: float = 0.0, ry: float = 0.0) -> str:
    """Path data of a rectangle, with corners of radii that are at most half of its sides."""
    if not (width > 0.0 and height > 0.0):
        return ""
    right, low, rx, ry = x + width, y + height, min(rx, width / 2.0), min(ry, height / 2.0)
    if not (rx > 0.0 and ry > 0.0):
        return f"M{x} {y}H{right}V{low}H{x}Z"
    arc = f"A{rx} {ry} 0 0 1 "
    return (
        f"M{x + rx} {y}H{right - rx}{arc}{right} {y + ry}V{low - ry}{arc}{right - rx} {low}"
        f"H{x + rx}{arc}{x} {low - ry}V{y + ry}{arc}{x + rx} {y}Z"
    )


class PathReader:
    """Follows path data command by command."""

    def __init__(self, data: str, quota: Quota) -> None:
        self.data = data
        self.quota = quota
        self.fault = ""
        self.subpaths: list[Subpath] = []
        self.points: list[float] = []
        """x and y of the current subpath's control points in turn; empty before the first one."""
        self.degrees: list[int] = []
        self.angles: list[float] = []
        self.before = "M"
        """The command before."""

    def read(self) -> list[Subpath]:
        """The subpaths with at least one curve, up to the place where the data go wrong, which `fault` then says.

        Raises NestedCagesError for more points than the quota has.
        """
        place = 0
        while (place := BLANK.match(self.data, place).end()) < len(self.data):  # type: ignore[union-attr]
            command, kind = self.data[place], self.data[place].upper()
            known = command.isascii() and kind in ARGUMENTS and bool(self.points or kind == "M")
            text = WHOLE[kind].match(self.data, place + 1)[0] if known else ""  # type: ignore[index]
            if not text and not (known and kind == "Z"):
                self.fault = f"go wrong at character {place} ({self.data[place : place + 20].strip()})"
                break
            taken = chain.from_iterable(ARC.findall(text)) if kind == "A" else NUMBERS.findall(text)
            values = list(map(float, taken))
            self.quota.spend("points", len(values) // len(ARGUMENTS[kind]) if values else 1)
            self._follow(kind, values, relative=command.islower())
            place += 1 + len(text)
        self._end_subpath(closed=False)
        return self.subpaths

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
                ends = (x, y), (end[0], end[1])
                found, angle = arc(*ends, (rx, ry), math.radians(degrees), bool(large), bool(sweep))
                self._add(kind, found, CONIC if angle else LINE, angle)
            else:
                if kind in "HV":
                    given = [given[0], y] if kind == "H" else [x, given[0]]
                elif kind in "ST":
                    handle = self.points[-4:-2] if self.before in MIRRORED[kind] else (x, y)
                    given = [2.0 * x - handle[0], 2.0 * y - handle[1], *given]
                self._add(kind, given, len(given) // 2)

    def _add(self, kind: str, given: list[float], degree: int, angle: float = 0.0) -> None:
        """Add the curves of a command to the subpath, through control points in turn."""
        count = len(given) // (2 * degree)
        self.points += given
        self.degrees += [degree] * count
        self.angles += [angle] * count
        self.before = kind

    def _end_subpath(self, *, closed: bool) -> None:
        if self.degrees:
            points = np.reshape(self.points, (-1, 2))
            self.subpaths.append(Subpath(points, np.array(self.degrees), np.array(self.angles), closed))
        self.degrees, self.angles = [], []


def arc(start: Point, end: Point, radii: Point, turn: float, large: bool, sweep: bool) -> tuple[list[float], float]:
    """Control points of k conics along an elliptical arc, after its start, as 4 k numbers, and half the angle of each.

    radii: along the ellipse's axes, widened if too small to reach; turn: radians from x to the first axis (SVG 1.1,
    appendix F.6). A straight arc has its end only and no angle, one that ends where it starts no points.
    """
    (x0, y0), (x1, y1) = start, end
    rx, ry = abs(radii[0]), abs(radii[1])
    if x0 == x1 and y0 == y1:
        return [], 0.0
    largest = max(abs(x0), abs(y0), abs(x1), abs(y1))
    if not (rx > FLATTEST * largest and ry > FLATTEST * largest and math.isfinite(turn)):
        return [x1, y1], 0.0
    cosine, sine = math.cos(turn), math.sin(turn)
    dx, dy = (x0 - x1) / 2.0, (y0 - y1) / 2.0
    u, v = (cosine * dx + sine * dy) / rx, (cosine * dy - sine * dx) / ry  # half the chord, the ellipse a unit circle
    stretch = u * u + v * v
    if not FLATTEST < stretch < math.inf:  # so large that the arc is straight, or out of range
        return [x1, y1], 0.0
    if stretch >= 1.0:  # too small, or just reaching: the centre is the middle
        grown = math.sqrt(stretch)
        rx, ry, u, v, across, along = rx * grown, ry * grown, u / grown, v / grown, 0.0, 0.0
    else:
        off = math.sqrt(1.0 / stretch - 1.0) * (1.0 if large != sweep else -1.0)
        across, along = off * v, -off * u
    begin = math.atan2(v - along, u - across)
    angle = (math.atan2(-v - along, -u - across) - begin) % (2.0 * math.pi)
    if not sweep:
        angle -= 2.0 * math.pi
    count = max(math.ceil(abs(angle) / MAX_ARC - 1e-9), 1)
    half = angle / (2.0 * count)
    points: list[float] = []
    for k in range(1, 2 * count + 1):
        t, far = begin + k * half, 1.0 / math.cos(half) if k % 2 else 1.0
        x, y = rx * (far * math.cos(t) + across), ry * (far * math.sin(t) + along)
        points += (cosine * x - sine * y + (x0 + x1) / 2.0, sine * x + cosine * y + (y0 + y1) / 2.0)
    return [*points[:-2], x1, y1], abs(half)
