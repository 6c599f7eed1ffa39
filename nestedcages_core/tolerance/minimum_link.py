"""Lines through runs of gates: segments in a circle, each crossed from left to right by what goes around.

With n from the tip to the foot of a gate, a line separates feet from tips where n · (foot - tip) ≥ 0 for all pairs of
a foot and a tip: each pair allows half a circle of normals around the direction of its difference.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..decimation.base import LEAST_PER_LOOP
from ..geometry.arrays import FloatArray, IntArray
from ..geometry.precision import NEGLIGIBLE
from ..geometry.vectors import cross, rotated_left, rotated_right

SPARE_GATES = 2
"""Gates looked at beyond the length of the run before; twice as many where a run is longer."""


FAR = 4.0
"""Length of a line without an end, in sizes of the corridor."""


class Line(NamedTuple):
    """A line with the feet of a run of gates on its left, or on it, and the tips on its right."""

    place: FloatArray
    """(2,) a point of it."""
    along: FloatArray
    """(2,) in the order of the gates."""

    def meets(self, place: FloatArray, along: FloatArray) -> FloatArray:
        """(2,) where it meets the line through a place along a vector; the place itself where they are parallel."""
        sine = float(cross(self.along, along))
        if sine == 0.0:
            return place
        point: FloatArray = place + float(cross(self.along, self.place - place)) / sine * along
        return point


class Window(NamedTuple):
    """A segment that the next link crosses. Gates are counted on and on around the loop."""

    foot: FloatArray
    """(2,) its end on the inner side, to the left of the link."""
    tip: FloatArray
    """(2,) its end on the outer side."""
    next_foot: int
    """The first gate whose foot the next link has to pass."""
    next_tip: int
    """The first gate whose tip the next link has to pass."""


class Run(NamedTuple):
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
        self.feet, self.tips, self.slack = feet, tips, slack
        self.count = len(feet)
        self.size = float(np.ptp(np.concatenate([feet, tips]), axis=0).sum())
        self._lengths: dict[int, int] = {}
        self._usual = SPARE_GATES

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
        first = self._runs_from(0)  # at most one more than the fewest
        if first <= known:
            return known
        others = range(1, self._length(0) + 1)  # a run of any cover starts in here
        return first - any(self._runs_from(start) < first for start in others)

    def _runs_from(self, start: int) -> int:
        """Longest runs, one after the other, from a gate on and around."""
        place, runs = start, 0
        while place < start + self.count:
            place, runs = place + self._length(place % self.count), runs + 1
        return runs

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
        return Window(self.feet[k], self.tips[k], number + 1, number + 1)

    def _length(self, start: int) -> int:
        """Gates in the longest run from a gate on."""
        if start not in self._lengths:
            self._lengths[start] = self._longest(self._gate(start), start + self.count - 1).missed - start
        return self._lengths[start]

    def _passes(self, line: Line, gate: int) -> bool:
        """Whether a line passes between foot and tip of a gate."""
        k = gate % self.count
        left = float(cross(line.along, self.feet[k] - line.place)) >= 0.0
        return left and float(cross(line.along, self.tips[k] - line.place)) <= 0.0

    def _longest(self, window: Window, last: int) -> Run:
        """The longest run from a window on, up to a last gate at most."""
        size = self._usual
        while True:
            stop = min(min(window.next_foot, window.next_tip) + size, last + 1)
            begin = min(window.next_foot, window.next_tip)
            feet, tips = np.arange(window.next_foot, stop), np.arange(window.next_tip, stop)
            angles = self._angles(window, feet, tips)
            apart = _ranges(angles, feet - begin + 1, tips - begin + 1, stop - begin) > np.pi + self.slack
            if apart.any():
                k = int(apart.argmax())
                self._usual = k + SPARE_GATES
                i, j = begin + k + 1 - window.next_foot, begin + k + 1 - window.next_tip
                before = max(i - 1, 0), max(j - 1, 0)
                return self._ended(window, begin + k, angles, before, (max(i, 0), max(j, 0)))
            if stop == last + 1:
                return Run(last + 1, None, window, last, last)
            size *= 2

    def _angles(self, window: Window, f: IntArray, t: IntArray) -> FloatArray:
        """(F + 1, T + 1) angles between the window and the directions from tips to feet, those of the window first."""
        feet = np.concatenate([window.foot[None], self.feet[f % self.count]])
        tips = np.concatenate([window.tip[None], self.tips[t % self.count]])
        return _angles_between(feet, tips)

    def _ended(
        self, window: Window, missed: int, angles: FloatArray, before: tuple[int, int], after: tuple[int, int]
    ) -> Run:
        """The run that misses a gate. before, after: last places of feet and tips without and with that gate."""
        passed = angles[: before[0] + 1, : before[1] + 1]
        of_tip, of_foot = angles[: before[0] + 1, before[1] + 1 : after[1] + 1], angles[before[0] + 1 : after[0] + 1, :]
        tip_turn = self._turn_missing(passed, of_tip)
        foot_turn = self._turn_missing(passed, of_foot[:, : before[1] + 1])
        beyond_tip = tip_turn != 0
        turn = tip_turn or foot_turn
        i, j = (int(n) for n in np.unravel_index(int(passed.argmin() if turn > 0 else passed.argmax()), passed.shape))
        foot_gate, tip_gate = window.next_foot - 1 + i, window.next_tip - 1 + j
        foot = window.foot if i == 0 else self.feet[foot_gate % self.count]
        tip = window.tip if j == 0 else self.tips[tip_gate % self.count]
        line = Line(foot, foot - tip if foot_gate > tip_gate else tip - foot)
        if (tip_turn == 0) == (foot_turn == 0) or beyond_tip != (foot_gate > tip_gate) or foot_gate == tip_gate:
            # a sharp turn, with the gate edge-on: no more is known than that the next link passes it
            return Run(missed, line if foot_gate != tip_gate else None, self._gate(missed), foot_gate, tip_gate)
        if beyond_tip:
            after_it = Window(foot, self._end(line, foot, self.tips, missed), foot_gate + 1, missed)
        else:
            after_it = Window(self._end(line, tip, self.feet, missed), tip, missed, tip_gate + 1)
        return Run(missed, line, after_it, foot_gate, tip_gate)

    def _turn_missing(self, passed: FloatArray, added: FloatArray) -> int:
        """Which way the lines of angles that are passed have to turn, and cannot, for others too; 0 if they can."""
        if added.size == 0:
            return 0
        middle = 0.5 * (passed.max() + passed.min())
        turned = middle + np.mod(added - middle + np.pi, 2.0 * np.pi) - np.pi
        if turned.max() - passed.min() > np.pi + self.slack:
            return 1
        return -1 if passed.max() - turned.min() > np.pi + self.slack else 0

    def _end(self, line: Line, contact: FloatArray, side: FloatArray, missed: int) -> FloatArray:
        """(2,) where the part of a line from a contact on ends that the next link may start from.

        Links that are made start before the chord of two ends on one side. For those that are only counted, it is all
        of the line on the near side of the missed gate, where a link that passes the gate begins.
        """
        k = missed % self.count
        across, chord = self.tips[k] - self.feet[k], side[k - 1] - side[k]
        if self.slack == 0.0:
            is_point = float(np.hypot(*chord)) <= NEGLIGIBLE * float(np.hypot(*across))
            return line.meets(side[k], across if is_point else chord)
        forward = rotated_left(across)
        end = line.meets(self.feet[k], across)
        if float(line.along @ forward) > 0.0 and float((end - contact) @ line.along) > 0.0:
            return end
        far: FloatArray = contact + FAR * self.size / float(np.hypot(*line.along)) * line.along
        return far

    def _closing(self, window: Window, first: Run, before: int) -> Line | None:
        """A line from a window to the part of the first line before it touches a gate; None if there is none.

        before: the last gate that the first line does not pass, going back.
        """
        line, count = first.line, self.count
        assert line is not None
        k = before % count
        from_foot = first.foot_gate < first.tip_gate
        side = self.tips if from_foot else self.feet
        end = line.meets(side[k], side[(k + 1) % count] - side[k])
        touched = min(first.foot_gate, first.tip_gate)
        near, far = np.arange(window.next_foot, touched + count), np.arange(window.next_tip, before + 1 + count)
        if not from_foot:
            near, far = np.arange(window.next_foot, before + 1 + count), np.arange(window.next_tip, touched + count)
        at = (self.feet if from_foot else self.tips)[touched % count]
        feet = np.concatenate([window.foot[None], self.feet[near % count], (at if from_foot else end)[None]])
        tips = np.concatenate([window.tip[None], self.tips[far % count], (end if from_foot else at)[None]])
        return _between(feet, tips)

    def _closed_by_gate(self, lines: list[Line], window: Window, last: int) -> FloatArray | None:
        """The corners of a walk with a line from a window to the last gate, and along it to the first line."""
        near, far = np.arange(window.next_foot, last + 1), np.arange(window.next_tip, last + 1)
        feet = np.concatenate([window.foot[None], self.feet[near % self.count]])
        tips = np.concatenate([window.tip[None], self.tips[far % self.count]])
        line, k = _between(feet, tips), last % self.count
        if line is None:
            return None
        return _corners([*lines, line, Line(self.feet[k], self.tips[k] - self.feet[k])])


def _angles_between(feet: FloatArray, tips: FloatArray) -> FloatArray:
    """(F, T) angles of the directions from tips to feet, from that between the first ones."""
    across = feet[0] - tips[0]
    (x, u), (y, v) = ((feet @ axis, tips @ axis) for axis in (across, rotated_left(across)))
    angles: FloatArray = np.arctan2(y[:, None] - v, x[:, None] - u)
    return angles


def _ranges(angles: FloatArray, foot_gate: IntArray, tip_gate: IntArray, count: int) -> FloatArray:
    """(count,) range of the angles (F + 1, T + 1) of all feet and tips up to each gate.

    foot_gate, tip_gate: (F,), (T,) the gate of each foot and tip from the second one on, counted from 1.
    """
    foot_gate, tip_gate = np.append(0, foot_gate), np.append(0, tip_gate)
    tip_is_last = tip_gate > foot_gate[:, None]
    extremes = []
    for reduction, nothing in ((np.maximum, -np.inf), (np.minimum, np.inf)):
        of_gate = np.full(count + 1, nothing)
        of_gate[foot_gate] = reduction.reduce(np.where(tip_is_last, nothing, angles), axis=1)
        of_gate[tip_gate] = reduction(
            of_gate[tip_gate], reduction.reduce(np.where(tip_is_last, angles, nothing), axis=0)
        )
        extremes.append(reduction.accumulate(of_gate)[1:])
    ranges: FloatArray = extremes[0] - extremes[1]
    return ranges


def _between(feet: FloatArray, tips: FloatArray) -> Line | None:
    """A line midway between feet (F, 2), on its left, and tips (T, 2); None if there is none."""
    angles = _angles_between(feet, tips)
    if angles.max() - angles.min() > np.pi:
        return None
    turn = 0.5 * float(angles.max() + angles.min())
    across = feet[0] - tips[0]
    normal = np.cos(turn) * across + np.sin(turn) * rotated_left(across)
    gap = float((feet @ normal).min() + (tips @ normal).max())
    size = float(normal @ normal)
    return Line(0.5 * gap / size * normal, rotated_right(normal)) if size > 0.0 else None


def _corners(lines: list[Line]) -> FloatArray | None:
    """(k, 2) where lines meet that follow each other in a circle; None for fewer than three."""
    if len(lines) < LEAST_PER_LOOP:
        return None
    return np.array(
        [one.meets(other.place, other.along) for one, other in zip(lines, [*lines[1:], lines[0]], strict=True)]
    )
