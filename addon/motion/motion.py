"""From an animated drawing, read on some frames or while it is edited in the space of its object, to certified cages as
Blender stores them. Does not touch the scene.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from time import perf_counter

import bpy
import numpy as np
from bpy.types import Context, Object

from ..blender.jobs import Progress, Work, mapped
from ..blender.mesh_data import mesh_of
from ..cage_sets.selection import scene_of
from ..core import core, runs
from ..drawing.edge_loops import SMALLEST_LOOP
from ..drawing.planar import Drawing, Outline, ReadingOptions, drawing_in, fine_drawing, read
from ..errors import FloatArray, UserError, counted
from ..generate.levels import OWN, Level, are_counts
from ..generate.options import Options
from ..generate.run import STORED, Generation, Request, clearance_to_curve
from ..memory import key_of, known, remember, remembered
from ..verify.check import same_frame
from . import redrawn
from .redrawn import Poses


def read_poses(context: Context, obj: Object, frames: Sequence[int], options: ReadingOptions) -> Work[Poses]:
    """Reads an object on increasing frames; afterwards the scene is on its frame again. Raises: UserError, with the
    frame.

    All frames from the first to the last are visited, as simulations require.
    """
    scene, wanted = scene_of(context), set(frames)
    drawings: list[Drawing] = []
    scale, redraws = 1.0, redrawn.is_redrawn(obj, frames)
    if redraws and len(frames) <= frames[-1] - frames[0]:
        raise UserError(f"'{obj.name}' has new drawings from frame to frame: set Step to 1")
    with same_frame(scene):
        for frame in range(frames[0], frames[-1] + 1):
            yield Progress((frame - frames[0]) / (frames[-1] + 1 - frames[0]), f"{obj.name}: reading frame {frame}")
            scene.frame_set(frame)
            if frame not in wanted:
                continue
            try:
                outline = read(context, obj, options)
                if not drawings:
                    scale = float(np.linalg.norm(outline.matrix[:3, :3], axis=0).mean())
                own = in_own_space(outline)
                drawing = drawing_in(drawings[0].frame, own, options) if drawings else fine_drawing(own, options)
                drawing.mesh()
                if drawings and not redraws:
                    _check_topology(drawings[0], drawing)
                drawings.append(drawing)
            except UserError as error:
                raise UserError(f"Frame {frame}: {error}", error.fault) from error
    points = np.stack([np.concatenate(drawing.loops) for drawing in drawings[: 1 if redraws else None]])
    times = np.array(frames, dtype=np.float64)
    return Poses(drawings[0], times, points, scale, tuple(drawings) if redraws else ())


def in_own_space(outline: Outline) -> Outline:
    """The same outline, of an object that stands at the origin of the world."""
    return replace(outline, matrix=np.eye(4))


def _check_topology(first: Drawing, drawing: Drawing) -> None:
    """Raises: UserError unless two drawings have as many loops with as many vertices, in the same order."""
    if [len(loop) for loop in first.loops] != [len(loop) for loop in drawing.loops]:
        before, now = (
            f"{counted(len(d.loops), 'loop')} of {sum(map(len, d.loops))} vertices" for d in (first, drawing)
        )
        raise UserError(
            f"'{drawing.name}' has {now} instead of {before} on the first frame: end before that frame, or turn "
            "off what changes it"
        )


def drawing_now(context: Context, obj: Object, options: ReadingOptions) -> Drawing:
    """The current drawing, in any mode, in its object's space. Raises: UserError."""
    return fine_drawing(in_own_space(_outline(context, obj, options)), options)


def _outline(context: Context, obj: Object, options: ReadingOptions) -> Outline:
    if obj.mode != "EDIT":
        return read(context, obj, options)
    obj.update_from_editmode()
    if obj.type != "MESH":
        return read(context, obj, options)
    # Of a mesh in Edit Mode only the selection would be read; a copy is read completely.
    copy, data = obj.copy(), mesh_of(obj).copy()
    try:
        copy.data = data
        context.scene.collection.objects.link(copy)
        outline = read(context, copy, options)
    finally:
        bpy.data.objects.remove(copy)
        bpy.data.meshes.remove(data)
    return replace(outline, name=obj.name, identity=obj.session_uid)


@dataclass(frozen=True)
class Moving:
    """A moving drawing and its cages, each around the one before, in its units; times are frames, and may be fractions.

    Each key is certified against what the cage encloses there, and so is the straight motion between keys, unless they
    are ``held``. A still cage has one key.
    """

    poses: Poses
    cages: tuple[core.MovingLevel, ...]
    held: bool = False


def wanted_cages(levels: Sequence[Level], poses: Poses) -> list[core.levels.Rising]:
    """Vertex counts of the cages. Raises: UserError."""
    if OWN in levels:
        raise UserError("Cages that follow have vertex counts: leave own objects (*) out of 'Cages'")
    if not are_counts(levels):
        raise UserError("Cages that follow have vertex counts: leave distances and areas such as +25% out of 'Cages'")
    if not levels:
        raise UserError("Enter a number of vertices in 'Cages', such as 64")
    numbers = [level for level in levels if not isinstance(level, str)]
    rising = [core.levels.Rising(level) if isinstance(level, int) else level for level in numbers]
    counts = core.levels.wanted_levels(rising, poses.drawing.mesh(), keeps=False)
    return [each.raised(SMALLEST_LOOP) for each in counts if isinstance(each, core.levels.Rising)]


def follow(poses: Poses, options: Options, *, cyclic: bool = False) -> Work[Moving]:
    """Cages of constant topology that follow the poses. Raises: UserError, with the frame.

    options: its clearance is in the drawing's units. cyclic: the last cage equals the first; a last pose equal to the
    first is added if necessary.
    """
    fine, wanted, name = poses.drawing.mesh(), wanted_cages(options.levels, poses), poses.drawing.name
    if poses.redrawn:
        return (yield from _hold(poses, wanted, options))
    if cyclic and not np.array_equal(poses.points[0], poses.points[-1]):
        frames = poses.frames
        closing = frames[-1] + (frames[-1] - frames[0]) / (len(frames) - 1)
        points = np.concatenate([poses.points, poses.points[:1]])
        poses = replace(poses, frames=np.append(frames, closing), points=points)
    asked = options.clearance or options.clearance_share * fine.diagonal or None
    clearance = clearance_to_curve(asked, fine, poses.drawing.deviation)
    settings, cages = replace(options.methods(), clearance=clearance, stored=STORED), list[core.MovingLevel]()
    inner, frames, points = fine, poses.frames, poses.points
    for number, each in enumerate(wanted):
        at = f"{name}, cage {number + 1}"
        key = key_of("moving", inner, frames, points, int(each), settings, cyclic)
        made = known(key)
        if made is None:
            yield Progress(number / len(wanted), f"{at}: first cage")
            run = core.AnimatedCagesRun(inner, points, [int(each)], settings, times=frames, cyclic=cyclic)
            try:
                for step in run:
                    yield Progress((number + step.fraction) / len(wanted), f"{at}: {step.stage}")
            except core.NestedCagesError as error:
                raise UserError(f"'{name}', cage {number + 1}: {_said(error, frames)}") from error
            finally:
                run.close()
            (made,) = run.moving.levels
            remember(key, made, made.cage_steps.nbytes + made.fine_steps.nbytes)
        cages.append(replace(made, report=replace(made.report, notes=(*each.notes(), *made.report.notes))))
        inner, frames, points = made.cage, made.times, made.cage_steps
    return Moving(poses, tuple(cages))


def _hold(poses: Poses, wanted: Sequence[core.levels.Rising], options: Options) -> Work[Moving]:
    """Cages around each drawing of a redrawn one, held until the next. Raises: UserError, with the frame."""
    began = perf_counter()
    shapes = yield from redrawn.rings(poses, wanted, options)
    numbers = redrawn.runs(poses)
    times = poses.frames[[*numbers, -1]] if poses.frames[numbers[-1]] < poses.frames[-1] else poses.frames[numbers]
    steps = [np.stack([mesh.vertices for mesh in (made + made[-1:])[: len(times)]]) for made in shapes]
    cages = []
    for each, inner, outer, (fine, cage) in zip(wanted, shapes, shapes[1:], pairwise(steps), strict=False):
        found = tuple(core.verify(*pair) for pair in zip(outer, inner, strict=True))
        report = core.motion.MotionReport(found, np.arange(len(found)), 0.0, perf_counter() - began, each.notes())
        cages.append(core.motion.MovingLevel(outer[0], times, fine, cage, report))
    ring = replace(poses.drawing, loops=(shapes[0][0].vertices,), united=True)
    return Moving(replace(poses, drawing=ring, frames=times, points=steps[0]), tuple(cages), held=True)


def _said(error: core.NestedCagesError, frames: FloatArray) -> str:
    """An error of the core with its frame, and with advice that Blender has: a smaller Step."""
    pose = error.data.get("pose")
    if pose is None:
        return str(error)
    frame = frames[min(pose, len(frames) - 1)]
    if error.code not in ("motion.blocked", "motion.collides"):
        return f"frame {frame:g}: {error.__cause__ or error}"
    advice = "lower Step" if (np.diff(frames) > 1.0).any() else "slow the motion down there"
    return f"frame {frame:g}: the cage cannot follow the drawing here; {advice}, or use more vertices or clearance"


def stand_still(poses: Poses, options: Options) -> Work[Moving]:
    """One still cage per level around all positions of a drawing. Raises: UserError, with the frame.

    options: its clearance is in the drawing's units.
    """
    name, wanted = poses.drawing.name, wanted_cages(options.levels, poses)
    given, poses = poses, redrawn.in_one(poses) if poses.redrawn else poses
    fine = poses.drawing.mesh()
    yield Progress(0.0, f"{name}: uniting all positions")
    try:
        union = remembered(lambda: core.swept(fine, poses.points), poses.points.nbytes, "swept", fine, poses.points)
        whole = replace(poses.drawing, loops=tuple(union.vertices[loop] for loop in union.loops))
        generation = Generation([Request(whole)], replace(options, levels=tuple(wanted)))
        for step in generation:
            yield Progress(0.9 * step.fraction, step.message)
        first, *others = generation.results[0].levels

        def work(tick: Callable[[float], None]) -> core.MovingLevel:
            return core.motion.certified_still(first.cage, fine, poses.points, times=poses.frames, tick=tick)

        still = yield from mapped(runs.Run(work), lambda done: Progress(0.9 + 0.1 * done, f"{name}: checking"))
        cages = [_with_report(still, first)]
    except core.NestedCagesError as error:
        raise UserError(f"'{name}': {_said(error, poses.frames)}") from error
    if given.redrawn:
        found = tuple(redrawn.certificates(first.cage, given))
        cages = [replace(cages[0], report=replace(cages[0].report, certificates=found))]
    for level in others:
        certificates = (core.verify(level.cage, level.fine),)
        report = core.motion.MotionReport(certificates, np.zeros(1, int), 0.0, 0.0)
        rest = level.fine.vertices[None], level.cage.vertices[None]
        cages.append(_with_report(core.motion.MovingLevel(level.cage, poses.frames[:1], *rest, report), level))
    return Moving(poses, tuple(cages))


def _with_report(still: core.MovingLevel, level: core.Level) -> core.MovingLevel:
    """A still level with the time and notes of the one that it is."""
    seconds = still.report.seconds + sum(level.report.seconds.values())
    return replace(still, report=replace(still.report, seconds=seconds, notes=tuple(level.report.notes)))
