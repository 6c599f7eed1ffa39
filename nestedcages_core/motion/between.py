"""Between the keys: collision-free straight motion from one to the next, or another key where that would add less area.

Both ends of an interval keep their distance, but during the linear motion between them an edge that turns while the
drawing slides along it may cut corners. The missing distance is measured at several instants, and the cages of both
keys are pushed outwards by it. Pushing adds area; where it would add too much, a key is inserted in the middle, which
divides the missing distance by about four.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from ..contact.linearisation import measure
from ..contact.pairs import Pairs, find_pairs
from ..energies import signed_area
from ..errors import NestingError
from ..geometry.arrays import FloatArray
from ..tightening.reach_clearance import outward_correction
from .following import RESTORED_REACH, Follower, sides
from .poses import Pose

INSTANTS = np.arange(1, 8) / 8.0
"""Instants of an interval at which distances are measured; exact predicates decide over all of it afterwards."""

ROOM = 0.5
"""Distance that pushing aims at between the keys, in clearances."""

PUSH_FACTOR, LATER_PUSH_FACTOR, LATER = 1.3, 2.0, 4
"""Factor on a push, and a larger one from this round on: the remainder after one push is of second order."""

ROUNDS = 12
"""Number of pushes of one interval before it gets another key."""

PUSHED_AREA = 0.005
"""Fraction of its area that pushing may add to a tight cage before the interval gets another key instead."""

SHORTEST = 1.0 / 32.0
"""Fraction of the time between two given poses below which no keys are added and pushing may add any area."""

MOST_TRIALS = 600
"""Number of intervals that are looked at before a key is given up: pushes reopen those next to them, over and over
where it is tight. Usual keys take up to 25, one of a thin bar that turns by 1.5 radians takes 507."""


@dataclass(eq=False)
class Instant:
    """A key that may still change, and its neighbours in time."""

    pose: Pose
    fine: FloatArray = field(repr=False)
    """(n, 2) the pose in the units of the solvers."""
    cages: list[FloatArray] = field(repr=False)
    """(m, 2) each: the cage as carried by the drawing, and the accepted steps of its tightening."""
    cage: FloatArray = field(init=False, repr=False)
    """(m, 2) the last of them, pushed outwards for the motion."""
    handed_out: bool = False
    """Whether the cage may no longer change."""
    before: Instant | None = field(default=None, repr=False)
    after: Instant | None = field(default=None, repr=False)
    part: float = 1.0
    """Length of the interval to the next key, as a fraction of that between two poses."""
    rounds: int = 0
    """Number of pushes of that interval so far."""

    def __post_init__(self) -> None:
        self.cage = self.cages[-1]

    def loosen(self) -> bool:
        """Undo half of the steps of tightening; returns whether there were any."""
        if self.handed_out or len(self.cages) == 1:
            return False
        self.cages = self.cages[: (len(self.cages) + 1) // 2]
        self.cage = self.cages[-1]
        return True

    def link(self, after: Instant) -> None:
        """Make another key the next one."""
        self.after, after.before = after, self


@dataclass(eq=False)
class Straightener:
    """Makes the straight motion between keys free of contact."""

    follower: Follower
    is_free: Callable[[Instant, Instant], bool]
    """Certifies the motion between two keys."""
    period: float = 0.0
    """Time once around, if the keys are a ring."""

    def instant(self, pose: Pose, cages: list[FloatArray]) -> Instant:
        """A key of a pose with its cages (m, 2)."""
        return Instant(pose, self.follower.units.points(pose.vertices), cages)

    def append(self, last: Instant, key: Instant) -> None:
        """Append a key, with collision-free motion to it. If that fails, raises NestingError without appending."""
        last.link(key)
        try:
            self.settle(last)
        except NestingError:
            last.after = None
            raise

    def settle(self, key: Instant) -> None:
        """Make the interval after a key, and those that change with it, collision-free. Raises NestingError."""
        open_: list[Instant] = [key]
        for _ in range(MOST_TRIALS):
            if not open_:
                return
            begin = open_.pop()
            end = begin.after
            if end is None or self.is_free(begin, end):
                continue
            pushed = self._pushed(begin, end)
            if pushed is not None:
                begin.rounds += 1
                begin.cage, end.cage = pushed
                open_ += [other for other in (begin.before, end, begin) if other is not None]
            elif (end.after is None or end.part < 1.0) and end.loosen():
                begin.rounds = end.rounds = 0
                open_ += [end, begin]
            elif begin.part > SHORTEST and not (begin.handed_out and end.handed_out):
                open_ += self._halved(begin, end)
            else:
                break
        raise NestingError(
            f"The motion from pose {begin.pose.number} to the next could not be certified free of collisions; "
            "give more poses between them, a larger clearance or more cage vertices.",
            code="motion.collides",
            pose=begin.pose.number,
        )

    def _pushed(self, begin: Instant, end: Instant) -> tuple[FloatArray, FloatArray] | None:
        """Cages of both keys pushed outwards by the missing distance; None where another key is better."""
        last_resort = begin.part <= SHORTEST
        if begin.rounds >= (2 * ROUNDS if last_resort else ROUNDS) or (begin.handed_out and end.handed_out):
            return None
        follower, bodies = self.follower, self.follower.bodies
        x0, x1 = (np.concatenate([key.cage, key.fine]) for key in (begin, end))
        pairs = find_pairs(bodies, 0.5 * (x0 + x1), RESTORED_REACH * bodies.cage_edge_length)
        missing = self._missing(pairs, x0, x1)
        short = np.flatnonzero(missing > 0.0)
        push = missing.take(short) * (PUSH_FACTOR if begin.rounds < LATER else LATER_PUSH_FACTOR)
        push *= 2.0 if begin.handed_out or end.handed_out else 1.0
        push[short >= pairs.cage_cage.start] *= 0.5  # both sides move
        cages: list[FloatArray] = []
        for key, x in ((begin, x0), (end, x1)):
            if key.handed_out:
                cages.append(key.cage)
                continue
            pushed = key.cage + outward_correction(bodies, pairs, measure(pairs, x), x, short, push)
            keeps = follower.encloses(pushed, key.fine, follower.clearance)  # a push may lead too close elsewhere
            cage = pushed if keeps else follower.restored(key.cage, key.fine, pushed, key.fine)
            if cage is None:
                return None
            grown = signed_area(cage, bodies.cage.successor) / signed_area(key.cages[-1], bodies.cage.successor) - 1.0
            if grown > PUSHED_AREA and not last_resort and follower.promises.settings.grid is None:
                return None
            cages.append(cage)
        return cages[0], cages[1]

    def _missing(self, pairs: Pairs, x0: FloatArray, x1: FloatArray) -> FloatArray:
        """(K,) missing distance of pairs of cage and fine mesh between x0 and x1 (m + n, 2)."""
        side, aim = sides(pairs, x0), ROOM * self.follower.clearance
        missing = np.full(len(pairs), -np.inf)
        for s in INSTANTS:
            missing = np.maximum(missing, aim - measure(pairs, (1.0 - s) * x0 + s * x1, side).distance)
        missing[pairs.cage_cage] = np.minimum(missing[pairs.cage_cage], 0.0)
        if not (missing > 0.0).any():  # the minimum lies between the instants
            missing[missing > -aim] = aim
        return missing

    def _halved(self, begin: Instant, end: Instant) -> list[Instant]:
        """The two intervals around a new key in the middle."""
        vertices = 0.5 * (begin.pose.vertices + end.pose.vertices)
        until = end.pose.time if end.pose.time > begin.pose.time else end.pose.time + self.period
        pose = Pose(begin.pose.number, 0.5 * (begin.pose.time + until), vertices, given=False)
        cages = self.follower.next(begin.cage, begin.fine, self.follower.units.points(vertices))
        if cages is None:
            raise NestingError(
                f"The cage cannot follow from pose {begin.pose.number} to the next: the drawing blocks it halfway; "
                "give more poses between them, or use more cage vertices.",
                code="motion.blocked",
                pose=begin.pose.number,
            )
        middle = self.instant(pose, cages)
        middle.part = begin.part = 0.5 * begin.part
        middle.link(end)
        begin.link(middle)
        begin.rounds = 0
        return [middle, begin]


def around(first: Instant) -> Iterator[Instant]:
    """The keys from the first one on; once around if they are a ring."""
    key: Instant | None = first
    while key is not None:
        yield key
        key = key.after if key.after is not first else None
