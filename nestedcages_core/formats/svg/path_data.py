"""The path language of SVG: M L H V C S Q T A Z, absolute and relative (SVG 1.1, section 8.3)."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ..limits import Quota

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

LINE, CUBIC = 1, 3
"""Degrees."""

MAX_ARC = math.pi / 6.0
"""Radians of one cubic; its distance from the true arc is then below 4e-7 of the radius."""

MAX_CHORDS = 4096
"""Maximum number of chords of a curve."""

FLATTEST = 1e-30
"""Radii by coordinates, and (chord / diameter) squared, below which an elliptical arc is a line."""


Point = tuple[float, float]


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

    def __init__(self, data: str, quota: Quota) -> None:
        self.data = data
        self.quota = quota
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

        Raises NestedCagesError for more points than the quota has.
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
            self.quota.spend("points", len(values) // len(ARGUMENTS[kind]) if values else 1)
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
                self.quota.spend("points", len(found) // degree)
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


def arc(start: Point, end: Point, radii: Point, turn: float, large: bool, sweep: bool) -> FloatArray:
    """Control points (3 k, 2) of k cubics along an elliptical arc, after its start (SVG 1.1, appendix F.6).

    radii: along the ellipse's axes, widened if too small to reach; turn: radians from x to the first axis. A straight
    arc has its end only, one that ends where it starts no points.
    """
    (x0, y0), (x1, y1) = start, end
    rx, ry = abs(radii[0]), abs(radii[1])
    if x0 == x1 and y0 == y1:
        return np.zeros((0, 2))
    largest = max(abs(x0), abs(y0), abs(x1), abs(y1))
    if not (rx > FLATTEST * largest and ry > FLATTEST * largest and math.isfinite(turn)):
        return np.array([end])
    cosine, sine = math.cos(turn), math.sin(turn)
    dx, dy = (x0 - x1) / 2.0, (y0 - y1) / 2.0
    u, v = (cosine * dx + sine * dy) / rx, (cosine * dy - sine * dx) / ry  # half the chord, the ellipse a unit circle
    stretch = u * u + v * v
    if not FLATTEST < stretch < math.inf:  # so large that the arc is straight, or out of range
        return np.array([end])
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
    axes = np.array([[cosine * rx, -sine * ry], [sine * rx, cosine * ry]])
    points = ellipse(axes @ (across, along) + np.add(start, end) / 2.0, axes, begin, angle)[1:]
    points[-1] = end
    return points


TINY = sys.float_info.min
"""Smallest tolerance: scaled ones may underflow."""


def ellipse(centre: FloatArray, axes: FloatArray, begin: float = 0.0, angle: float = 2.0 * math.pi) -> FloatArray:
    """Control points (3 k + 1, 2) of cubics along centre + axes @ (cos t, sin t), t from `begin` over `angle` radians.

    axes: (2, 2).
    """
    count = max(math.ceil(abs(angle) / MAX_ARC - 1e-9), 1)
    reach = 4.0 / 3.0 * math.tan(angle / count / 4.0)
    t = [begin + angle * k / count for k in range(count + 1)]
    if abs(angle) == 2.0 * math.pi:
        t[-1] = t[0]
    on = np.array([(math.cos(at), math.sin(at)) for at in t])
    ahead = on[:, ::-1] * (-reach, reach)
    unit = np.empty((3 * count + 1, 2))
    unit[::3], unit[1::3], unit[2::3] = on, on[:-1] + ahead[:-1], on[1:] - ahead[1:]
    return np.asarray(unit @ axes.T + centre)


def flattened(
    points: FloatArray, degrees: IntArray, tolerance: float, spend: Callable[[int], None] = lambda number: None
) -> FloatArray:
    """(k, 2) points on consecutive curves, no farther than `tolerance` from them along the chords between.

    points: control points, each curve's first one the last one before; degrees: 1 to 3; spend: told how many points
    there will be before they are made. The number of chords is that of Wang (1984):
    sqrt(d (d - 1) / 8 · max |second difference| / tolerance) for degree d.
    """
    if (degrees == LINE).all():
        spend(len(points))
        return points
    ends = np.cumsum(degrees)
    counts = np.ones(len(degrees), dtype=np.int64)
    kinds = []
    for degree in range(LINE + 1, CUBIC + 1):
        which = np.flatnonzero(degrees == degree)
        control = points[(ends[which] - degree)[:, None] + np.arange(degree + 1)]
        bend = np.hypot(*np.moveaxis(np.diff(control, 2, axis=1), 2, 0)).max(axis=1)
        wanted = np.sqrt(degree * (degree - 1) / 8.0 * bend / max(tolerance, TINY))
        counts[which] = np.ceil(np.clip(wanted, 1, MAX_CHORDS))
        kinds.append((which, control))
    last = np.cumsum(counts)
    spend(int(last[-1]) + 1)
    found = np.empty((last[-1] + 1, 2))
    found[0], found[last] = points[0], points[ends]
    for which, control in kinds:
        inner = counts[which] - 1
        curve = np.repeat(np.arange(len(which)), inner)
        k = np.arange(1, len(curve) + 1) - np.repeat(np.cumsum(inner) - inner, inner)
        t, level = (k / counts[which][curve])[:, None, None], control[curve]
        while level.shape[1] > 1:  # de Casteljau, all t at once
            level = level[:, :-1] + t * np.diff(level, axis=1)
        found[(last - counts)[which][curve] + k] = level[:, 0]
    return found
