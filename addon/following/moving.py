"""From poses to certified cages as Blender stores them. Does not touch the scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from ..core import core, memory
from ..errors import UserError
from ..generation.generate import (
    AUTOMATIC_CLEARANCES,
    FLOAT32_ROUNDING,
    MARGIN,
    MARGINS,
    Generation,
    Options,
    Request,
)
from ..generation.job import Progress, Work
from ..generation.levels import OWN, Level, Wanted, are_counts, wanted_levels
from ..generation.memory import known, remembered
from .poses import Poses


@dataclass(frozen=True)
class MovingCage:
    """One level as Blender stores it: vertices (K, m, 2), float32, on frames (K,), some of which may be fractions.

    Each key is certified against what the cage encloses there, and so is the straight motion between keys. ``excess``
    and ``clearance``, in the drawing's units, are those of the keys. A still cage has one key.
    """

    edges: NDArray[np.int64]
    frames: NDArray[np.float64]
    steps: NDArray[np.float32]
    certificates: tuple[core.Certificate, ...]
    seconds: float
    notes: tuple[str, ...] = ()

    @property
    def excess(self) -> NDArray[np.float64]:
        """(K,) excess of each key, or of a still cage on each pose."""
        return np.array([certificate.excess for certificate in self.certificates])

    @property
    def clearance(self) -> float:
        """The least clearance of all keys."""
        return min(float(certificate.clearance) for certificate in self.certificates)


@dataclass(frozen=True)
class Moving:
    """A moving drawing, on frames (T,) and points (T, n, 2), and its cages, each around the one before."""

    poses: Poses
    edges: NDArray[np.int64]
    cages: tuple[MovingCage, ...]


def wanted_cages(levels: Sequence[Level], poses: Poses) -> tuple[Wanted, ...]:
    """Vertex counts of the cages, with notes. Raises: UserError."""
    if OWN in levels:
        raise UserError("Cages that follow have vertex counts: leave own objects (*) out of the levels")
    if not are_counts(levels):
        raise UserError("Cages that follow have vertex counts: leave distances and excesses out of the levels")
    if not levels:
        raise UserError("Give a vertex count for at least one level, such as 64")
    return wanted_levels(levels, poses.drawing.mesh(), (), poses.drawing.name)


def follow(poses: Poses, options: Options, *, cyclic: bool = False) -> Work[Moving]:
    """Cages of constant topology that follow the poses. Raises: UserError, with the frame.

    options: its clearance is in the drawing's units. cyclic: the last cage equals the first; a last pose equal to the
    first is added if necessary.
    """
    fine, wanted = poses.drawing.mesh(), wanted_cages(options.levels, poses)
    if cyclic and not np.array_equal(poses.points[0], poses.points[-1]):
        frames = poses.frames
        closing = frames[-1] + (frames[-1] - frames[0]) / (len(frames) - 1)
        poses = replace(
            poses, frames=np.append(frames, closing), points=np.concatenate([poses.points, poses.points[:1]])
        )
    inner, frames, points = fine, poses.frames, poses.points
    cages: list[MovingCage] = []
    for number, level in enumerate(wanted, 1):
        name = f"{poses.drawing.name}, level {number}"
        assert not isinstance(level.level, core.Within)
        for step in _known_or_made(name, inner, frames, points, level.level, options, cyclic):
            if isinstance(step, MovingCage):
                cages.append(replace(step, notes=(*level.notes, *step.notes)))
            else:
                yield Progress((number - 1 + step.fraction) / len(wanted), f"{name}: {step.message}")
        frames, points = cages[-1].frames, cages[-1].steps.astype(np.float64)
        inner = core.Mesh(points[0], cages[-1].edges)
    return Moving(poses, fine.edges, tuple(cages))


def _known_or_made(
    name: str,
    inner: core.Mesh,
    frames: NDArray[np.float64],
    points: NDArray[np.float64],
    wanted: int | core.Mesh,
    options: Options,
    cyclic: bool,
) -> Iterator[Progress | MovingCage]:
    """As `_level`, but a cage that is remembered is not made again."""
    key = memory.key_of(
        "moving level", inner, frames, points, wanted, options.methods,
        options.clearance, options.clearance_share, cyclic,
    )  # fmt: skip
    found = known().get(key)
    if found is not None:
        yield found
        return
    for step in _level(name, inner, frames, points, wanted, options, cyclic):
        if isinstance(step, MovingCage):
            known().put(key, step, step.steps.nbytes)
        yield step


def _level(
    name: str,
    inner: core.Mesh,
    frames: NDArray[np.float64],
    points: NDArray[np.float64],
    wanted: int | core.Mesh,
    options: Options,
    cyclic: bool,
) -> Iterator[Progress | MovingCage]:
    """Progress, and at the end the cage of one level. Raises: UserError."""
    problem = ""
    margin = MARGIN * FLOAT32_ROUNDING * float(np.abs(points).max())
    settings = options.methods.settings()
    shares = [options.clearance_share] if options.clearance_share > 0.0 else AUTOMATIC_CLEARANCES
    automatic = [part * inner.diagonal for part in shares]
    for clearance in [options.clearance] if options.clearance > 0.0 else automatic:
        for margins in MARGINS:
            asked = replace(settings, clearance=clearance + margins * margin)
            run = core.AnimatedCagesRun(inner, points, [wanted], asked, times=frames, cyclic=cyclic)
            try:
                yield Progress(0.0, "first cage")
                for step in run:
                    yield Progress(0.9 * step.fraction, "following")
            except core.NestedCagesError as error:
                problem = problem or _said(error, frames)
                break
            finally:
                run.close()
            stored = yield from _stored(inner, run.moving.levels[0], clearance)
            if isinstance(stored, MovingCage):
                yield stored
                return
            problem = stored
    raise UserError(f"'{name}': {problem}")


def _said(error: core.NestedCagesError, frames: NDArray[np.float64]) -> str:
    """An error of the core with its frame, and with advice that Blender has: a smaller Step."""
    pose = error.data.get("pose")
    if pose is None:
        return str(error)
    frame = frames[min(pose, len(frames) - 1)]
    if error.code not in ("motion.blocked", "motion.collides"):
        return f"frame {frame:g}: {error.__cause__ or error}"
    advice = "lower Step" if (np.diff(frames) > 1.0).any() else "slow the motion down there"
    return f"frame {frame:g}: the cage cannot follow the drawing here; {advice}, or use more vertices or clearance"


def _stored(inner: core.Mesh, level: core.MovingLevel, clearance: float) -> Work[MovingCage | str]:
    """The core's level in float32 with its certificate, or why that fails."""
    steps = level.cage_steps.astype(np.float32)
    cages, fines, cage = steps.astype(np.float64), level.fine_steps, level.cage
    certificates: list[core.Certificate] = []
    for key, frame in enumerate(level.times):
        yield Progress(0.9 + 0.1 * key / len(steps), "checking")
        certificates.append(core.verify(cage.moved(cages[key]), inner.moved(fines[key]), clearance))
        problems = certificates[-1].problems
        if key and not problems and not core.verify_motion(cage, inner, *_pair(cages, fines, key)).free:
            problems = (core.Fault("it touches the drawing before this frame", "motion.collides"),)
        if problems:
            return (
                f"frame {frame:g}: the cage does not hold in Blender's single precision ({'; '.join(problems)}); move "
                "the drawing closer to its object's origin, or ask for more clearance"
            )
    return MovingCage(cage.edges, level.times, steps, tuple(certificates), level.report.seconds, level.report.notes)


def _pair(
    cages: NDArray[np.float64], fines: NDArray[np.float64], key: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The steps before and at a key."""
    return cages[key - 1 : key + 1], fines[key - 1 : key + 1]


def stand_still(poses: Poses, options: Options) -> Work[Moving]:
    """One still cage per level around all positions of a drawing. Raises: UserError, with the frame.

    options: its clearance is in the drawing's units.
    """
    name, fine, began = poses.drawing.name, poses.drawing.mesh(), perf_counter()
    counts = tuple(each.level for each in wanted_cages(options.levels, poses) if isinstance(each.level, int))
    yield Progress(0.0, f"{name}: uniting all positions")
    try:
        union = remembered(lambda: core.swept(fine, poses.points), poses.points.nbytes, "swept", fine, poses.points)
    except core.NestedCagesError as error:
        raise UserError(f"'{name}': {_said(error, poses.frames)}") from error
    whole = replace(poses.drawing, loops=tuple(union.vertices[loop] for loop in union.loops))
    generation = Generation([Request(whole)], replace(options, levels=counts))
    for step in generation:
        yield Progress(0.9 * step.fraction, step.message)
    cages: list[MovingCage] = []
    for level in generation.results[0].levels:
        certificates: tuple[core.Certificate, ...] = (level.certificate,)
        if not cages:
            certificates = yield from _around_all(
                name, core.Mesh(level.cage.astype(np.float64), level.cage_edges), poses
            )
        notes, edges, still = level.report.notes, level.cage_edges, level.cage[None]
        cages.append(MovingCage(edges, poses.frames[:1], still, certificates, perf_counter() - began, notes))
    return Moving(poses, fine.edges, tuple(cages))


def _around_all(name: str, cage: core.Mesh, poses: Poses) -> Work[tuple[core.Certificate, ...]]:
    """The certificates of a still cage on all poses. Raises: UserError if one does not hold."""
    fine, found = poses.drawing.mesh(), []
    cages = np.broadcast_to(cage.vertices, (len(poses.points), *cage.vertices.shape))
    for key, frame in enumerate(poses.frames):
        yield Progress(0.9 + 0.1 * key / len(cages), f"{name}: checking")
        posed = fine.moved(poses.points[key])
        certificate = core.verify(cage, posed, same_loops=cage.has_loops_like(posed))
        free = key == 0 or core.verify_motion(cage, fine, *_pair(cages, poses.points, key)).free
        if not certificate.holds or not free:
            why = "; ".join(certificate.problems) or "the drawing crosses it before this frame"
            raise UserError(f"'{name}': frame {frame:g}: the cage does not hold ({why}); ask for more clearance")
        found.append(certificate)
    return tuple(found)
