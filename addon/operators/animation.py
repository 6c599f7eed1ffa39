"""Follow a Moving Drawing: cages around a drawing that moves; Live: cages that follow its edits; Remove Animation."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np
from bpy.types import Context, Scene

from ..animation import visibility
from ..bind.copies import complete
from ..blender.jobs import Work, share
from ..blender.props import flag, whole
from ..blender.views import redraw
from ..cage_sets import CageSet, changes, selection
from ..cage_sets.selection import scene_again, scene_of, set_of_active, sets_of_chosen
from ..drawing.planar import ReadingOptions
from ..errors import UserError, counted
from ..generate import groups
from ..generate.levels import OWN, are_counts, lengths, parse_levels
from ..generate.options import Options
from ..generate.settings import all_values, filled
from ..messages import in_scene, is_told, larger
from ..motion import live, motion, writing
from .base import NOTHING, DialogJobOperator, Operator, why_none
from .generate import DrawingsOperator, sources

# Approximate fraction of the work for reading the frames.
READING_PART = 0.2


class OBJECT_OT_nested_cages_follow(DialogJobOperator, DrawingsOperator, bpy.types.Operator):
    """Wrap the selected animated drawings in cages that move with them and strictly enclose them at every instant"""

    bl_label = "Follow a Moving Drawing"

    frame_start: whole("Start", "First frame; the scene's if it is not set", default=1)
    frame_end: whole("End", "Last frame; the scene's if it is not set", default=250)
    frame_step: whole("Step", "Frames from one pose to the next", default=1, min=1, soft_max=12)
    cyclic: flag("Cyclic", "End with the first cage; if the last pose differs from the first, a frame is added")
    still: flag(
        "One Cage for All Frames",
        "Make still cages around the whole area that the drawing sweeps from the first to the last frame",
    )

    def prepare(self, context: Context) -> None:
        """Takes what is not given from the cages that the active drawing has, or else from the panel."""
        self._set_range(scene_of(context))
        cage_set = set_of_active(context)
        if cage_set is None or not cage_set.record.known or cage_set.inside:
            self.take_from_panel(context, groups.NOT_MOVING)
            return
        given = self.properties.is_property_set("levels")
        self.take_from_panel(context, groups.NOT_MOVING, cage_set.settings)
        levels = parse_levels(self.levels, lengths(scene_of(context)))
        if not given and (OWN in levels or not are_counts(levels)):
            self.levels = ", ".join(str(len(cage.data.vertices)) for cage in cage_set.cages)

    def draw(self, _context: Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "levels")
        groups.draw(layout.column(), self, ("clearance", "clearance_share", "energy"))
        frames = layout.column(align=True)
        frames.prop(self, "frame_start")
        frames.prop(self, "frame_end")
        layout.prop(self, "still")
        following = layout.column()
        following.active = not self.still
        following.prop(self, "frame_step")
        following.prop(self, "cyclic")
        groups.draw(layout.column(), self, groups.READING)

    def work(self, context: Context) -> Work[None]:
        scene, reading = scene_of(context), filled(ReadingOptions, self)
        options = Options.of(self, scene)
        if options.inside:
            raise UserError("Cages that follow a motion lie around the drawing: leave 'Cage Inside' off")
        if options.kinds() or self.weight_group or self.pin_group or self.joint_armature:
            raise UserError(f"Cages that follow a motion do not support '{groups.CONSTRAINTS}': reset its settings")
        name = scene.name
        self._set_range(scene)
        frames = list(range(self.frame_start, self.frame_end + 1, 1 if self.still else self.frame_step))
        if len(frames) < 2:
            raise UserError(
                f"From frame {self.frame_start} to {self.frame_end} in steps of {self.frame_step} there is no motion: "
                "give at least two frames"
            )
        self.exclusive = True  # reading changes the frame
        objects, read = sources(context), []
        shared = next((group for group in selection.with_parts(objects) if len(group) > 1), None)
        if shared is not None:
            others = counted(len(shared) - 1, "drawing")
            raise UserError(f"'{shared[0].name}' shares its cages with {others}: they cannot follow one alone")
        for number, obj in enumerate(objects):
            poses = yield from share(
                motion.read_poses(context, obj, frames, reading), number, len(objects), end=READING_PART
            )
            read.append(poses)
        self.exclusive, before = False, changes.states(objects)
        results = []
        for number, poses in enumerate(read):
            asked = replace(options, clearance=options.clearance / poses.scale)
            work = motion.stand_still(poses, asked) if self.still else motion.follow(poses, asked, cyclic=self.cyclic)
            result = yield from share(work, number, len(read), READING_PART)
            results.append(result)
        edited, used = changes.edited_since(before), all_values(self)
        writing.write(scene_again(name), results, self.thickness, used, edited, tell=self.tell)
        cages = [cage for result in results for cage in result.cages]
        said = (
            in_scene(note, result.poses.scale)
            for result in results
            for cage in result.cages
            for note in cage.report.notes
        )
        for note in dict.fromkeys(note for note in said if is_told(note.code, note.data)):
            self.report({"WARNING"}, note)
        # as the panel has them
        sizes = [
            np.cumprod([1.0 + np.median([each.excess for each in cage.report.certificates]) for cage in result.cages])
            for result in results
        ]
        shown = ", ".join(map(larger, np.concatenate(sizes)))
        between = "" if any(poses.redrawn for poses in read) else " and between them"
        certified = f"certified on {counted(len(frames), 'frame')}{between}"
        self.report({"INFO"}, f"{counted(len(cages), 'cage')} {certified}; typically {shown}")

    def _set_range(self, scene: Scene) -> None:
        """Takes the frames that are not set from the scene."""
        for name in ("frame_start", "frame_end"):
            if not self.properties.is_property_set(name):
                setattr(self, name, getattr(scene, name))


class OBJECT_OT_nested_cages_live(Operator, bpy.types.Operator):
    """Let the cages of the active object follow the edits of its drawing, in any mode, until it is switched off or
    another file is opened. Removes the animation of how the cages form
    """

    bl_label = "Live"
    modes = ()

    @classmethod
    def unavailable(cls, context: Context) -> str:
        if live.current() is not None:
            return ""
        cage_set = set_of_active(context)
        if cage_set is None:
            return NOTHING
        if cage_set.source is None:
            return "The drawing of these cages is gone"
        return live.why_not(cage_set)

    def run(self, context: Context) -> None:
        if live.current() is not None:
            live.stop()
            return
        scene = scene_of(context)
        complete()
        cage_set = set_of_active(context)
        source = cage_set.source if cage_set is not None else None
        assert cage_set is not None and source is not None
        settings = cage_set.settings
        options = Options.of(settings, scene)
        if visibility.is_animated(cage_set):
            visibility.remove(scene, cage_set)
            self.report({"INFO"}, "The animation was removed: Generate makes it again")
        reading, used = filled(ReadingOptions, settings), all_values(settings)
        live.start(live.Live(scene, source, options, reading, used, lambda: redraw(bpy.context)))


class OBJECT_OT_nested_cages_remove_animation(Operator, bpy.types.Operator):
    """Remove the steps, their keyframes and markers, and keep the finished cages"""

    bl_label = "Remove Animation, Keep Cages"

    unavailable = classmethod(lambda _cls, context: why_none(context, _why_not_still))

    def run(self, context: Context) -> None:
        complete()
        for cage_set in sets_of_chosen(context, both=False):
            if not _why_not_still(cage_set):
                visibility.remove(scene_of(context), cage_set)


def _why_not_still(cage_set: CageSet) -> str:
    """Why the animation of a set cannot be removed; empty if it can."""
    if cage_set.bound:
        return "Unbind the drawing from its cages first: its animation is turned off while bound"
    return "" if visibility.is_animated(cage_set) else "The cages have no animation"
