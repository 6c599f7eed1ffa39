"""The evaluated outline of a drawing in the space of its object: on some frames, and while it is edited."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ..errors import UserError
from ..generation.checking import same_frame
from ..generation.job import Progress, Work
from ..scene.convert import Drawing, Outline, ReadingOptions, drawing_in, fine_drawing, read
from ..scene.filling import mesh_of
from ..scene.plane import Frame
from ..scene.selection import scene_of


@dataclass(frozen=True)
class Poses:
    """The outline of an object on frames (T,): points (T, n, 2), float32 values as float64, in the plane of
    ``drawing``, the first pose.

    The frame of the drawing is in the object's space, so the object's own transform is not part of the motion.
    ``scale`` is the world length of its unit on the first frame.
    """

    drawing: Drawing
    frames: NDArray[np.float64]
    points: NDArray[np.float64]
    scale: float


def read_poses(
    context: bpy.types.Context, obj: bpy.types.Object, frames: Sequence[int], options: ReadingOptions
) -> Work[Poses]:
    """Reads an object on increasing frames; afterwards the scene is on its frame again. Raises: UserError, with the
    frame.

    All frames from the first to the last are visited, as simulations require.
    """
    scene, wanted = scene_of(context), set(frames)
    found: list[Drawing] = []
    scale = 1.0
    with same_frame(scene):
        for frame in range(frames[0], frames[-1] + 1):
            yield Progress((frame - frames[0]) / (frames[-1] + 1 - frames[0]), f"{obj.name}: reading frame {frame}")
            scene.frame_set(frame)
            if frame not in wanted:
                continue
            try:
                outline = read(context, obj, options)
                if not found:
                    scale = float(np.linalg.norm(outline.matrix[:3, :3], axis=0).mean())
                found.append(_posed(found[0], in_own_space(outline), options) if found else _first(outline, options))
            except UserError as error:
                raise UserError(f"Frame {frame}: {error}") from error
    points = np.stack([np.concatenate(drawing.loops) for drawing in found])
    return Poses(found[0], np.array(frames, dtype=np.float64), points, scale)


def in_own_space(outline: Outline) -> Outline:
    """The same outline, of an object that stands at the origin of the world."""
    return replace(outline, matrix=np.eye(4))


def same_loops(drawing: Drawing, other: Drawing) -> bool:
    """Whether two drawings have as many loops with as many vertices, in the same order."""
    return [len(loop) for loop in drawing.loops] == [len(loop) for loop in other.loops]


def _first(outline: Outline, options: ReadingOptions) -> Drawing:
    drawing = fine_drawing(in_own_space(outline), options)
    drawing.mesh()
    return drawing


def _posed(first: Drawing, outline: Outline, options: ReadingOptions) -> Drawing:
    """A later pose in the plane of the first one. Raises: UserError if its topology differs."""
    drawing = drawing_in(first.frame, outline, options)
    if not same_loops(first, drawing):
        before, now = (f"{len(d.loops)} loops of {sum(map(len, d.loops))} vertices" for d in (first, drawing))
        raise UserError(
            f"'{outline.name}' changes its topology: {now} instead of {before} on the first frame; end before that "
            "frame, or turn off what changes it"
        )
    drawing.mesh()
    return drawing


def drawing_now(
    context: bpy.types.Context, obj: bpy.types.Object, options: ReadingOptions, frame: Frame | None = None
) -> Drawing:
    """The current drawing, in any mode, in its object's space. Raises: UserError.

    frame: its previous plane; used if the drawing is not flat in its object.
    """
    outline = in_own_space(_outline(context, obj, options))
    drawing = fine_drawing(outline, options)
    if frame is not None and not drawing.frame.own:
        return drawing_in(frame, outline, options)
    return drawing


def _outline(context: bpy.types.Context, obj: bpy.types.Object, options: ReadingOptions) -> Outline:
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
        found = read(context, copy, options)
    finally:
        bpy.data.objects.remove(copy)
        bpy.data.meshes.remove(data)
    return replace(found, name=obj.name, identity=obj.session_uid)
