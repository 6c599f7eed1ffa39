"""animated_cages(): cages of constant topology around a drawing that moves, level by level."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence, Sized
from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import ArrayLike

from ..errors import NestedCagesError, NestingError, note
from ..geometry.mesh import Mesh, MeshLike
from ..geometry.precision import ROUND_OFF
from ..levels import Progress, Settings, Wanted, in_order, listed_levels, wanted_levels
from ..levels.settings import type_name
from ..levels.work import clearances_for
from ..progress import Tick, listened, no_tick
from ..run import Run
from ..verification import verify, verify_motion
from .gate import Key
from .level import Allowance, LevelMotion
from .poses import Pose, read_poses
from .results import MotionReport, MovingCages, MovingLevel

if TYPE_CHECKING:
    from ..levels.keywords import SettingsKeywords

MANY_ROOMS = 64.0
"""Multiples of what rounding takes, kept where less was not enough: rounding can close gaps between parts of a cage."""

UNPOSED = ("poses.invalid", "setting.conflict", "level.invalid", "count.too_small")
"""Codes of errors that no clearance corrects."""


def animated_cages(
    fine: MeshLike,
    poses: ArrayLike | Iterable[ArrayLike],
    levels: Wanted | Sequence[Wanted],
    settings: Settings | None = None,
    *,
    times: ArrayLike | None = None,
    cyclic: bool = False,
    progress: Callable[[Progress], None] | bool | None = None,
    **options: Unpack[SettingsKeywords],
) -> MovingCages:
    """Make cages that follow a moving drawing, each enclosing the one before at every instant.

    Every key is certified by `verify`, and the straight motion between keys by `verify_motion`.

    Parameters
    ----------
    fine : Mesh or what `Mesh.of` reads
        The drawing; it gives the topology.
    poses : (T, n, 2) array, or an iterable of (n, 2) arrays that is read once
        The positions of its vertices.
    levels : int, str, Mesh or a list of these
        For each cage its number of vertices, ``"8%"`` of those of ``fine``, or a coarse mesh of the first pose.
    settings : Settings, optional
        Everything else that can be chosen.
    times : (T,) array, optional
        Increasing; by default 0, 1, ...
    cyclic : bool
        Whether the last cage equals the first. If the last pose differs from the first, the motion back to it is
        added, over the mean interval.
    progress : callable or bool, optional
        Called at every key; may raise to cancel. True: a bar of tqdm, or lines without it.
    **options
        Fields of `Settings` that replace those of ``settings``.

    Returns
    -------
    MovingCages

    Raises
    ------
    NestedCagesError
        Names the pose; its ``partial`` is the MovingCages up to there.
    """
    following = _Following(fine, poses, levels, Settings.of(settings, **options), times, cyclic)
    return listened(following.cages, progress)


class AnimatedCagesRun(Run[Progress, MovingCages]):
    """The work of :func:`animated_cages` as an iterator over its progress; dropping it cancels the work."""

    def __init__(
        self,
        fine: MeshLike,
        poses: ArrayLike | Iterable[ArrayLike],
        levels: Wanted | Sequence[Wanted],
        settings: Settings | None = None,
        *,
        times: ArrayLike | None = None,
        cyclic: bool = False,
        **options: Unpack[SettingsKeywords],
    ) -> None:
        super().__init__(_Following(fine, poses, levels, Settings.of(settings, **options), times, cyclic).cages)

    @property
    def moving(self) -> MovingCages:
        """The result; RuntimeError before the run is over."""
        return self.result


class _Following:
    """What is asked for, and what is known of it while the levels are made."""

    def __init__(
        self,
        fine: MeshLike,
        poses: ArrayLike | Iterable[ArrayLike],
        levels: Wanted | Sequence[Wanted],
        settings: Settings,
        times: ArrayLike | None,
        cyclic: bool,
    ) -> None:
        self._fine, self._cyclic = Mesh.of(fine, strict=True), cyclic
        self._levels: list[Any] = in_order(wanted_levels(listed_levels(levels), self._fine))
        if not self._levels:
            raise NestingError(
                "There are no levels: give at least one vertex count or coarse mesh.", code="level.invalid"
            )
        self._settings = settings
        self._read = partial(read_poses, self._fine, poses, times)
        self._count = len(poses) if isinstance(poses, Sized) else None
        self._again = isinstance(poses, Sequence | np.ndarray)

    def cages(self, report: Callable[[Progress], None]) -> MovingCages:
        """All levels; report: called at every key."""
        finished: list[MovingLevel] = []
        inner, read, settings = self._fine, self._read, self._settings
        for index, wanted in enumerate(self._levels):
            level, keys, seconds = self._level(index, inner, wanted, settings, read, finished, report)
            finished.append(_finished(level, keys, seconds))
            poses = [Pose(key.number, key.time, key.cage, key.given) for key in keys]
            inner, read = level.topology, partial(iter, poses)
            settings = replace(level.promises.of_next_level(inner), clearance=self._settings.clearance)
            self._again, self._count = True, keys[-1].number + 1
        return MovingCages(self._fine, tuple(finished))

    def _level(
        self,
        index: int,
        inner: Mesh,
        wanted: int | Mesh,
        settings: Settings,
        read: Callable[[], Iterator[Pose]],
        finished: list[MovingLevel],
        report: Callable[[Progress], None],
    ) -> tuple[LevelMotion, list[Key], float]:
        """One level with its keys and seconds, with as little allowance as possible. Raises the first error."""
        first: NestedCagesError | None = None
        allowance: Allowance | None = Allowance()
        while allowance is not None:
            level = LevelMotion(inner, wanted, settings, cyclic=self._cyclic, allowance=allowance)
            keys, began = [], perf_counter()
            try:
                for key in level.keys(read()):
                    keys.append(key)
                    report(self._progress(index, key))
                return level, keys, perf_counter() - began
            except NestedCagesError as error:
                made = [_finished(level, keys, perf_counter() - began)] if keys else []
                error.partial = MovingCages(self._fine, (*finished, *made))
                first = first or error
                allowance = _more(allowance, settings, inner, error) if self._again else None
        assert first is not None
        raise first

    def _progress(self, index: int, key: Key) -> Progress:
        """Progress of the run at a key of a level; always one half for an iterable of unknown length."""
        done = 0.5 if self._count is None else (key.number + 1) / self._count
        fraction = (index + min(done, 1.0)) / len(self._levels)
        return Progress(index, "following", fraction, f"Level {index + 1} of {len(self._levels)}: pose {key.number}")


def _more(given: Allowance, settings: Settings, inner: Mesh, error: NestedCagesError) -> Allowance | None:
    """A larger allowance with which a level around a mesh may be made; None if there is none."""
    if error.code == "certificate.failed" and type_name(settings.stored) is not None and given.rooms == 1.0:
        return replace(given, rooms=MANY_ROOMS)
    narrow = error.code == "clearance.no_room" and given.reductions + 1 < len(clearances_for(settings, inner))
    if settings.clearance is None and (narrow or not given.reductions) and error.code not in UNPOSED:
        return Allowance(given.reductions + 1)
    return None


def stream_cages(
    fine: Mesh,
    poses: Iterable[ArrayLike],
    level: int | Mesh,
    settings: Settings | None = None,
    *,
    times: ArrayLike | None = None,
) -> Iterator[Key]:
    """Hand out the keys of one level of `animated_cages` as they are certified, a few poses behind the input.

    Memory does not grow with the length of the motion.

    Parameters
    ----------
    fine, poses, settings, times
        As for `animated_cages`.
    level : int or Mesh
        Number of vertices of the cage, or a coarse mesh of the first pose.

    Yields
    ------
    Key

    Raises
    ------
    NestedCagesError
        Names the pose.
    """
    motion = LevelMotion(fine, level, settings if settings is not None else Settings(), cyclic=False)
    return motion.keys(read_poses(fine, poses, times))


def _finished(level: LevelMotion, keys: list[Key], seconds: float) -> MovingLevel:
    given = np.flatnonzero([key.given for key in keys])
    certificates = tuple(key.certificate for key in keys)
    clearance, notes = level.clearance, tuple(level.notes)
    smallest = (1.0 - ROUND_OFF) * min(certificate.clearance for certificate in certificates)
    if smallest < (1.0 - ROUND_OFF) * clearance:  # no key has to have the default clearance
        clearance, notes = smallest, (*notes, note("note.clearance", on="gaps", wanted=clearance, given=smallest))
    report = MotionReport(certificates, given, clearance, seconds, notes)
    cage = level.topology.moved(keys[0].cage).validated()
    times = np.array([key.time for key in keys])
    return MovingLevel(cage, times, np.stack([k.fine for k in keys]), np.stack([k.cage for k in keys]), report)


def certified_still(
    cage: Mesh,
    fine: Mesh,
    poses: ArrayLike,
    *,
    times: ArrayLike | None = None,
    clearance: float = 0.0,
    tick: Tick = no_tick,
) -> MovingLevel:
    """Certify a cage that stands still around all poses of a drawing and the motion between them.

    Parameters
    ----------
    cage, fine : Mesh
        The cage, and the topology of the drawing.
    poses : (T, n, 2) array
        Positions of the drawing's vertices.
    times : (T,) array, optional
        Increasing; by default 0, 1, ...
    clearance : float
        Distance that the cage keeps from the drawing.
    tick : callable
        Called with the fraction done.

    Returns
    -------
    MovingLevel
        With one key, and the certificates of the poses.

    Raises
    ------
    NestingError
        Names the pose.
    """
    began, given = perf_counter(), list(read_poses(fine, poses, times))
    certificates = []
    same_loops = cage.has_loops_like(fine)
    for number, pose in enumerate(given):
        tick(number / len(given))
        certificate = verify(cage, fine.moved(pose.vertices), clearance, same_loops=same_loops)
        way = np.stack([given[max(number - 1, 0)].vertices, pose.vertices])
        if not certificate or not verify_motion(cage, fine, np.stack([cage.vertices] * 2), way):
            why = " ".join(certificate.problems) or "The drawing crosses it before this pose."
            raise NestingError(
                f"The still cage does not hold at pose {number}: {why} Ask for more clearance.",
                code="certificate.failed",
                problems=certificate.problems,
                pose=number,
            )
        certificates.append(certificate)
    report = MotionReport(tuple(certificates), np.arange(len(given)), clearance, perf_counter() - began)
    first = given[0]
    return MovingLevel(cage, np.array([first.time]), first.vertices[None], cage.vertices[None], report)
