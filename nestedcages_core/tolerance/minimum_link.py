"""Lines through runs of gates: segments in a circle, each crossed from left to right by what goes around.

With n from the tip to the foot of a gate, a line separates feet from tips where n · (foot - tip) ≥ 0 for all pairs of
a foot and a tip: each pair allows half a circle of normals around the direction of its difference.

Points are complex numbers here: nearly all of the work is a few products of single ones.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from ..decimation.base import MIN_PER_LOOP
from ..geometry.arrays import FloatArray
from ..geometry.precision import NEGLIGIBLE

ComplexArray: TypeAlias = npt.NDArray[np.complex128]
"""Array of points x + iy."""

FIRST_RUN = 48
"""Gates looked at for a run at first; half as many more where it is longer."""

FAR = 4.0
"""Length of a line without an end, in sizes of the corridor."""


class Line(NamedTuple):
    """A line with the feet of a run of gates on its left, or on it, and the tips on its right."""

    place: complex
    """A point of it."""
    along: complex
    """In the order of the gates."""

    def meets(self, place: complex, along: complex) -> complex:
        """Where it meets the line through a place along a vector; the place itself where they are parallel."""
        sine = _cross(self.along, along)
        return place if sine == 0.0 else place + _cross(self.along, self.place - place) / sine * along


class Window(NamedTuple):
    """A segment that the next link crosses. Gates are counted on and on around the loop."""

    foot: complex
    """Its end on the inner side, to the left of the link."""
    tip: complex
    """Its end on the outer side."""
    next_foot: int
    """The first gate whose foot the next link has to pass."""
    next_tip: int
    """The first gate whose tip the next link has to pass."""


class GateRun(NamedTuple):
    """The longest run of gates from a window on that a line passes."""

    missed: int
    """The first gate that it does not reach."""
    line: Line | None
    """The last line that passes the run; None where it is not known."""
    after: Window
    """What the next link crosses."""
    foot_gate: int
    """The gate whose foot the line touches."""
    tip_gate: int
    """The gate whose tip it touches."""


class Corridor:
    """Gates from feet (N, 2) to tips (N, 2) in a circle, feet to the left of what goes around."""

    def __init__(self, feet: FloatArray, tips: FloatArray, *, slack: float) -> None:
        """slack: radians by which a line may miss a gate; 0 for links that are made, not counted."""
        self.feet, self.tips = (np.ascontiguousarray(ends).view(np.complex128)[:, 0] for ends in (feet, tips))
        self.slack, self.count = slack, len(feet)
        self.size = float(np.ptp(np.concatenate([feet, tips]), axis=0).sum())
        self._lengths: dict[int, int] = {}

    def some(self, number: int) -> list[int]:
        """This many gates, evenly."""
        return sorted(set(np.linspace(0, self.count, number, endpoint=False).astype(int).tolist()))

    def links_around(self, start: int) -> int:
        """Fewest links from anywhere on a gate to anywhere on it, once around."""
        window, links = self._gate(start), 1
        while (run := self._longest(window, start + self.count)).missed <= start + self.count:
            window, links = run.after, links + 1
        return links

    def fewest_runs(self, known: int) -> int:
        """As few runs as cover the circle, whether or not their lines meet, or a known bound if that is more."""
        end, runs = 0, 0
        while end < self.count:
            end, runs = end + self._length(end % self.count), runs + 1
        # the farther a run begins, the farther it ends: with one run less, a cover from a gate gets no farther than
        # this one, so that it begins no later than where this one overlaps, and so on
        start = end - self.count
        while runs > known and start > 0:
            end = start
            for _ in range(runs - 1):
                end += self._length(end % self.count)
            if end - self.count >= start:
                return runs - 1
            start = end - self.count
        return max(runs, known)

    def polygon(self, start: int) -> FloatArray | None:
        """(k, 2) corners of a walk of last lines, from a gate on and around; None where it does not get around.

        A line that crosses the first one in time closes the walk; where there is none, the gate where the first line
        begins does, with one more corner.
        """
        first = self._longest(self._gate(start), start + self.count)
        if first.line is None or first.missed > start + self.count:
            return None
        before = start - 1
        while self._passes(first.line, before):
            before -= 1
        lines, window, reached, anew = [first.line], first.after, first.missed, False
        while len(lines) <= self.count:
            run = self._longest(window, start + 2 * self.count)
            if run.missed > before + self.count:
                last = self._closing(window, first, before)
                if last is not None:
                    return _corners([*lines, last])
            if run.missed > before + 1 + self.count:
                return self._closed_by_gate(lines, window, before + 1 + self.count)
            if run.missed > reached and run.line is not None:
                lines.append(run.line)
                window, reached, anew = run.after, run.missed, False
            elif anew:
                return None
            else:  # the window does not see the gate that is next: go on from the whole of it
                window, anew = self._gate(reached), True
        return None

    def _gate(self, number: int) -> Window:
        """A gate as a window."""
        k = number % self.count
        return Window(complex(self.feet[k]), complex(self.tips[k]), number + 1, number + 1)

    def _length(self, start: int) -> int:
        """Gates in the longest run from a gate on."""
        if start not in self._lengths:
            self._lengths[start] = self._longest(self._gate(start), start + self.count - 1).missed - start
        return self._lengths[start]

    def _passes(self, line: Line, gate: int) -> bool:
        """Whether a line passes between foot and tip of a gate."""
        foot, tip, _, _ = self._gate(gate)
        return _cross(line.along, foot - line.place) >= 0.0 >= _cross(line.along, tip - line.place)

    def _longest(self, window: Window, last: int) -> GateRun:
        """The longest run from a window on, up to a last gate at most."""
        begin, size = min(window.next_foot, window.next_tip), FIRST_RUN
        while True:
            stop = min(begin + size, last + 1)
            feet, tips = _side(window.foot, self.feet, begin, stop), _side(window.tip, self.tips, begin, stop)
            feet[: window.next_foot - begin + 1], tips[: window.next_tip - begin + 1] = window.foot, window.tip
            angles = _angles_between(feet, tips)
            high, low = _extremes(angles, np.maximum), _extremes(angles, np.minimum)
            apart = (high - low > np.pi + self.slack).nonzero()[0]
            if len(apart):
                k = int(apart[0])
                return self._ended(
                    window, begin + k - 1, angles[: k + 1, : k + 1], float(high[k - 1]), float(low[k - 1])
                )
            if stop == last + 1:
                return GateRun(last + 1, None, window, last, last)
            size += size // 2

    def _ended(self, window: Window, missed: int, angles: FloatArray, high: float, low: float) -> GateRun:
        """The run that misses a gate.

        angles: between the window and the directions from tips to feet, those of the window first and those of that
        gate last. high, low: the extremes without it.
        """
        passed = angles[:-1, :-1]
        tip_turn = self._turn_missing(high, low, angles[:-1, -1])
        foot_turn = self._turn_missing(high, low, angles[-1, :-1])
        beyond_tip, turn = tip_turn != 0, tip_turn or foot_turn
        i, j = divmod(int(passed.argmin() if turn > 0 else passed.argmax()), len(passed))
        begin = missed + 1 - len(passed)
        foot_gate, tip_gate = max(window.next_foot, begin + i) - 1, max(window.next_tip, begin + j) - 1
        foot = window.foot if i == 0 else complex(self.feet[foot_gate % self.count])
        tip = window.tip if j == 0 else complex(self.tips[tip_gate % self.count])
        line = Line(foot, foot - tip if foot_gate > tip_gate else tip - foot)
        if (tip_turn == 0) == (foot_turn == 0) or beyond_tip != (foot_gate > tip_gate) or foot_gate == tip_gate:
            # a sharp turn, with the gate edge-on: no more is known than that the next link passes it
            return GateRun(missed, line if foot_gate != tip_gate else None, self._gate(missed), foot_gate, tip_gate)
        if beyond_tip:
            after_it = Window(foot, self._end(line, foot, self.tips, missed), foot_gate + 1, missed)
        else:
            after_it = Window(self._end(line, tip, self.feet, missed), tip, missed, tip_gate + 1)
        return GateRun(missed, line, after_it, foot_gate, tip_gate)

    def _turn_missing(self, high: float, low: float, added: FloatArray) -> int:
        """Which way the lines of angles between extremes have to turn, and cannot, for others too; 0 if they can."""
        base = 0.5 * (high + low) - np.pi
        turned = np.mod(added - base, 2.0 * np.pi)
        if base + turned.max() - low > np.pi + self.slack:
            return 1
        return -1 if high - (base + turned.min()) > np.pi + self.slack else 0

    def _end(self, line: Line, contact: complex, side: ComplexArray, missed: int) -> complex:
        """Where the part of a line from a contact on ends that the next link may start from.

        Links that are made start before the chord of two ends on one side. For those that are only counted, it is all
        of the line on the near side of the missed gate, where a link that passes the gate begins.
        """
        k = missed % self.count
        foot, tip, _, _ = self._gate(k)
        across = tip - foot
        if self.slack == 0.0:
            chord = complex(side[k - 1] - side[k])
            return line.meets(complex(side[k]), across if abs(chord) <= NEGLIGIBLE * abs(across) else chord)
        end = line.meets(foot, across)
        if _cross(across, line.along) > 0.0 and _dot(end - contact, line.along) > 0.0:
            return end
        return contact + FAR * self.size / abs(line.along) * line.along

    def _closing(self, window: Window, first: GateRun, before: int) -> Line | None:
        """A line from a window to the part of the first line before it touches a gate; None if there is none.

        before: the last gate that the first line does not pass, going back.
        """
        line, count = first.line, self.count
        assert line is not None
        k = before % count
        from_foot = first.foot_gate < first.tip_gate
        side = self.tips if from_foot else self.feet
        end = line.meets(complex(side[k]), complex(side[(k + 1) % count] - side[k]))
        touched = min(first.foot_gate, first.tip_gate)
        at = (self.feet if from_foot else self.tips)[touched % count]
        stops = (touched + count, before + 1 + count) if from_foot else (before + 1 + count, touched + count)
        feet = np.append(_side(window.foot, self.feet, window.next_foot, stops[0]), at if from_foot else end)
        return _midline(
            feet, np.append(_side(window.tip, self.tips, window.next_tip, stops[1]), end if from_foot else at)
        )

    def _closed_by_gate(self, lines: list[Line], window: Window, last: int) -> FloatArray | None:
        """The corners of a walk with a line from a window to the last gate, and along it to the first line."""
        line = _midline(
            _side(window.foot, self.feet, window.next_foot, last + 1),
            _side(window.tip, self.tips, window.next_tip, last + 1),
        )
        foot, tip, _, _ = self._gate(last)
        return None if line is None else _corners([*lines, line, Line(foot, tip - foot)])


def _cross(u: complex, v: complex) -> float:
    return u.real * v.imag - u.imag * v.real


def _dot(u: complex, v: complex) -> float:
    return u.real * v.real + u.imag * v.imag


def _side(end: complex, side: ComplexArray, first: int, stop: int) -> ComplexArray:
    """An end of a window, and those of the gates from the first one on."""
    ends: ComplexArray = side.take(np.arange(first - 1, max(first, stop)), mode="wrap")
    ends[0] = end
    return ends


def _angles_between(feet: ComplexArray, tips: ComplexArray) -> FloatArray:
    """(F, T) angles of the directions from tips to feet, from that between the first ones."""
    across = (feet[:, None] - tips) * (feet[0] - tips[0]).conjugate()
    angles: FloatArray = np.arctan2(across.imag, across.real)
    return angles


def _extremes(angles: FloatArray, extreme: np.ufunc) -> FloatArray:
    """(N,) extremes of the first angles, in both directions, of a matrix (N, N)."""
    both = np.where(np.tri(len(angles), dtype=bool), extreme(angles, angles.T), angles[0, 0])
    return np.asarray(extreme.accumulate(extreme.reduce(both, axis=1)))


def _midline(feet: ComplexArray, tips: ComplexArray) -> Line | None:
    """A line midway between feet (F,), on its left, and tips (T,); None if there is none."""
    angles = _angles_between(feet, tips)
    high, low = float(angles.max()), float(angles.min())
    if high - low > np.pi:
        return None
    normal = complex(np.exp(0.5j * (high + low)) * (feet[0] - tips[0]))
    gap = float((feet * normal.conjugate()).real.min() + (tips * normal.conjugate()).real.max())
    size = _dot(normal, normal)
    return Line(0.5 * gap / size * normal, -1j * normal) if size > 0.0 else None


def _corners(lines: list[Line]) -> FloatArray | None:
    """(k, 2) where lines meet that follow each other in a circle; None for fewer than three."""
    if len(lines) < MIN_PER_LOOP:
        return None
    corners = [one.meets(*other) for one, other in zip(lines, [*lines[1:], lines[0]], strict=True)]
    return np.array(corners).view(np.float64).reshape(-1, 2)
