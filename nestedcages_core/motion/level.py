"""One level of a motion: the first cage, the cages that follow it, and collision-free motion between them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from ..errors import Fault, NestedCagesError, NestingError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..levels import Settings, Within
from ..levels.certify import lost_loops
from ..levels.settings import type_name
from ..levels.units import SolverUnits
from ..levels.work import clearances_for
from .between import Instant, Straightener, around
from .following import Follower
from .gate import Key, MotionGate, Posed
from .poses import LOOK_AHEAD, WINDOW, Pose, look_ahead
from .promises import Promises
from .starts import first_cage


@dataclass(frozen=True)
class Allowance:
    """What a motion is allowed where it failed without."""

    reductions: int = 0
    """How often the default clearance is reduced."""
    rooms: float = 1.0
    """Multiples of what rounding takes, kept in reserve."""


class LevelMotion:
    """Makes the moving cage of one level; `keys` gives its keys as they are certified."""

    topology: Mesh
    """The cage's edges, and its vertices at the first pose before they are pushed for the motion."""
    clearance: float
    """The clearance aimed at, in input units; where none was asked for, keys are certified without one."""

    def __init__(
        self, fine: Mesh, wanted: int | Mesh, settings: Settings, *, cyclic: bool, allowance: Allowance = Allowance()
    ) -> None:
        if isinstance(wanted, Within):
            raise NestingError(f"A moving cage needs a number of vertices, not {wanted!r}.", code="level.invalid")
        if settings.convex:
            raise NestingError(
                "A cage that follows a motion does not stay convex; leave out convex.", code="setting.conflict"
            )
        self.fine, self.wanted, self.settings, self.cyclic = fine, wanted, settings, cyclic
        self.allowance, self.stored = allowance, type_name(settings.stored)
        self.notes: list[Fault] = []

    def keys(self, poses: Iterator[Pose]) -> Iterator[Key]:
        """The keys of all poses, and those added between them. Raises NestedCagesError that names the pose."""
        ahead, poses = look_ahead(poses, None if self.cyclic else LOOK_AHEAD)
        first = self.fine.moved(ahead[0].vertices).validated()
        self.clearance = clearances_for(self.settings, first)[self.allowance.reductions]
        self.settings = replace(self.settings, clearance=self.clearance) if self.allowance.reductions else self.settings
        self.promises = Promises.of(self.settings, first)
        self.notes += self.promises.notes
        self.units = SolverUnits.of(first, self._room(ahead))

        def follower(cage: Mesh, pose: Mesh) -> Follower:
            return Follower.of(cage, pose, self.units, self.clearance, self.promises)

        meshes = [self.fine.moved(pose.vertices).validated() for pose in ahead]
        self.topology = first_cage(meshes, self.wanted, self.promises, follower)
        self._follower = follower(self.topology, first)
        self._straightener = Straightener(self._follower, self._is_free)
        keys = self._ring([*ahead, *poses]) if self.cyclic else self._stream(chain(ahead, poses))
        wanted = 0.0 if self.settings.clearance is None else self.clearance
        self._gate = MotionGate(self.promises.plan, self.topology, wanted)
        before: Key | None = None
        for instant in keys:
            key = self._gate.key(self._posed(instant), before)
            if before is None:
                self.notes += lost_loops(self.topology, first, key.certificate)
            before = key
            yield key

    def _room(self, poses: Iterable[Pose]) -> float:
        """What rounding to the numbers of the type that stores the cages may take from the clearance."""
        if self.stored is None:
            return 0.0
        from ..constraints.numbers import Numbers

        largest = max(float(np.abs(pose.vertices).max()) for pose in poses)
        return self.allowance.rooms * Numbers(None, self.stored, largest).room

    def _stream(self, poses: Iterable[Pose]) -> Iterator[Instant]:
        """Process one pose after the other, with no more than a window of them in memory."""
        oldest: Instant | None = None
        blocked: NestedCagesError | None = None
        try:
            for newest in self._followed(poses, self.units.points(self.topology.vertices)):
                oldest = newest if oldest is None else oldest
                while oldest.pose.number < newest.pose.number - WINDOW and oldest.after is not None:
                    oldest.handed_out, oldest.before = True, None
                    yield oldest
                    oldest = oldest.after
        except NestedCagesError as error:  # return the keys before the failure
            blocked = error
        if oldest is not None:
            yield from around(oldest)
        if blocked is not None:
            raise blocked

    def _ring(self, poses: list[Pose]) -> Iterator[Instant]:
        """Follow one round to settle, then a second one, and blend both; the last key equals the first."""
        closing = poses[-1]
        if not np.array_equal(closing.vertices, poses[0].vertices):
            time = closing.time + (closing.time - poses[0].time) / (len(poses) - 1)
            closing = Pose(closing.number + 1, time, poses[0].vertices, closing.given)
            poses = [*poses, closing]
        once = list(self._followed(poses, self.units.points(self.topology.vertices)))
        again = list(self._followed(poses, once[-1].cage))
        keys = self._merged(again, once)
        for key, after in zip(keys, [*keys[1:], keys[0]], strict=True):
            key.link(after)
        self._straightener.period = closing.time - poses[0].time
        for key in keys:
            self._straightener.settle(key)
        yield from around(keys[0])
        yield self._straightener.instant(closing, [keys[0].cage])

    def _merged(self, begins: list[Instant], ends: list[Instant]) -> list[Instant]:
        """Keys, all but the last, that blend from the cages of one round to those of another, so that they close."""
        keys: list[Instant] = []
        for number, (one, other) in enumerate(zip(begins[:-1], ends[:-1], strict=True)):
            share = number / (len(ends) - 1)
            guess = (1.0 - share) * one.cage + share * other.cage
            blend = self._follower.restored(one.cage, one.fine, guess, one.fine)
            keys.append(self._straightener.instant(one.pose, [one.cage if blend is None else blend]))
        return keys

    def _followed(self, poses: Iterable[Pose], cage: FloatArray) -> Iterator[Instant]:
        """A key for each pose, the first with the given cage, each with collision-free motion from the one before."""
        key: Instant | None = None
        for pose in poses:
            if key is None:
                key = self._straightener.instant(pose, [cage])
            else:
                cages = self._follower.next(key.cage, key.fine, self.units.points(pose.vertices))
                if cages is None:
                    raise NestingError(
                        f"The cage cannot follow to pose {pose.number}: the drawing blocks its path; give more poses "
                        "before it, or use more cage vertices.",
                        code="motion.blocked",
                        pose=pose.number,
                    )
                after = self._straightener.instant(pose, cages)
                self._straightener.append(key, after)
                key = after
            yield key

    def _is_free(self, begin: Instant, end: Instant) -> bool:
        """Certify the straight motion between two keys in the input's units."""
        return self._gate.is_free(self._posed(begin), self._posed(end))

    def _posed(self, instant: Instant) -> Posed:
        """A key in the input's units."""
        pose = instant.pose
        return Posed(pose.number, pose.time, pose.vertices, self._follower.stored(instant.cage), pose.given)
