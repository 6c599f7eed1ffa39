"""Writes cages that follow, and the drawing they follow, as keyed shape keys on children of its object."""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import replace
from typing import Any

import numpy as np
from bpy.types import Scene

from .. import cage_sets
from ..animation.timeline import Timing
from ..blender import shape_keys
from ..cage_sets import CageSet, changes
from ..core import blamed, certify, core
from ..drawing.planar import Drawing
from ..drawing.plane import Frame, scale_of
from ..errors import FloatArray, UserError
from ..generate.run import Result
from ..generate.write import Tell
from ..generate.write import write as write_results
from .motion import Moving


def write(
    scene: Scene,
    results: Sequence[Moving],
    thickness: float = 0.0,
    used: dict[str, Any] | None = None,
    edited: Set[int] = frozenset(),
    *,
    tell: Tell,
) -> None:
    """Writes the output of each drawing. Raises: UserError.

    edited: session IDs of drawings that have changed meanwhile. tell: what of earlier output is lost.
    """
    for result in results:
        source = result.poses.drawing.source
        earlier = CageSet.beside(source) if source is not None else None
        if earlier is not None and earlier.bound:
            raise UserError(f"'{earlier.name}' is bound to its cages, which move it: unbind it first")
    start = round(float(results[0].poses.frames[0]))
    timing = Timing(start_frame=start, frames_per_step=1, show_flow=False)
    standing = [replace(_standing(result), used=used) for result in results]
    sets = write_results(scene, standing, timing, tell, thickness, still=True)
    for cage_set, result in zip(sets, results, strict=True):
        _play(cage_set, result)
    changes.settle(sets, edited)


def _standing(result: Moving) -> Result:
    """The first pose with its cages as a result for one frame. Raises: UserError."""
    drawing, levels = result.poses.drawing, []
    inner = drawing.mesh()
    for cage in result.cages:
        least, excess = _measures(cage)
        report = core.NestingReport(
            True, True, least, least, float(np.median(excess)), "flow", {}, {"following": cage.report.seconds},
            cage.report.notes,
        )  # fmt: skip
        with blamed(f"'{drawing.name}'"):
            levels.append(certify.standing(inner, cage.cage, report, least))
        inner = cage.cage
    return Result(_in_world(drawing, result.poses.scale), tuple(levels))


def _measures(cage: core.MovingLevel) -> tuple[float, FloatArray]:
    """The least clearance of all keys, and their excess (K,)."""
    certificates = cage.report.certificates
    return min(float(each.clearance) for each in certificates), np.array([each.excess for each in certificates])


def _in_world(drawing: Drawing, scale: float) -> Drawing:
    """A drawing in its object's space converted to scene space; scale: the world length of its unit."""
    source, frame = drawing.source, drawing.frame
    world = np.array(source.matrix_world, dtype=np.float64)
    return replace(drawing, frame=Frame(world @ frame.matrix, frame.height, scale, frame.own))


def _play(cage_set: CageSet, result: Moving) -> None:
    """Keys the shapes of the objects of an output, which are children of the drawing's object."""
    poses = result.poses
    fine, cages = cage_set.fine, cage_set.cages
    assert fine is not None
    action = shape_keys.new_action(cage_set.name)
    held = result.held
    points = poses.points.astype(np.float32)
    shape_keys.add_steps(fine, points, poses.frames, "Level 1", held=held, action=action)
    for number, (obj, cage) in enumerate(zip(cages, result.cages, strict=True), 1):
        steps, name = cage.cage_steps.astype(np.float32), f"Level {number}"
        shape_keys.add_steps(obj, steps, cage.times, name, held=held, action=action)
        noted, (clearance, excess) = cage_sets.new_node(obj), _measures(cage)
        noted.clearance, noted.certified = clearance * poses.scale, {"MOTION"}
        noted.excess, noted.most = float(np.median(excess)), float(excess.max())
        noted.frames = (round(float(poses.frames[0])), -1, -1, round(float(poses.frames[-1])))
    first, last = round(float(poses.frames[0])), round(float(poses.frames[-1]))
    cage_set.record.moving, cage_set.record.frames = True, (first, last, last)


def write_still(scene: Scene, result: Result, used: dict[str, Any]) -> None:
    """Writes the finished cages of a drawing in its object's space, without animation. Raises: UserError.

    used: the settings that they were made with.
    """
    source = result.drawing.source
    if source is None:
        raise UserError(f"'{result.drawing.name}' was deleted meanwhile, so its cages were discarded")
    levels = [
        certify.rerouted(level, certify.Path.at_rest(level.fine, level.cage), level.report.stored)
        for level in result.levels
    ]
    timing = Timing(start_frame=scene.frame_current, frames_per_step=1, show_flow=False)
    drawing = _in_world(result.drawing, scale_of(source))
    made = Result(drawing, tuple(levels), result.kinds, used)
    write_results(scene, [made], timing, still=True)
