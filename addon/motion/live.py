"""Live: while it is on, the cages of a drawing follow its edits.

The watcher notes changes of the drawing; a job in the background does the work. If the topology is unchanged, one step
moves the cages to the current drawing; otherwise they are made again in slices. The fine mesh is an object in the
scene, so undo, which changes it together with the cages, needs no special handling.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import bpy
import numpy as np
from bpy.types import Object, Scene

from .. import cage_sets
from ..animation import visibility
from ..blender import mesh_data
from ..blender.jobs import LOOK_INTERVAL, Job, Progress, Work
from ..cage_sets import CageSet, changes
from ..cage_sets.selection import scene_again, scene_of
from ..core import core
from ..drawing.planar import Drawing, ReadingOptions
from ..drawing.plane import scale_of
from ..errors import UserError
from ..generate.levels import wanted_levels
from ..generate.options import Options
from ..generate.run import STORED, Generation, Request
from ..keys import found_object
from . import writing
from .motion import drawing_now

# Seconds that a drawing must rest before its cages are checked, or made again. A step needs no rest: it only waits as
# long as the last one took, which leaves at least half of the time to Blender.
REST = 0.3


class Live:
    """Follows the edits of one drawing, with the settings that its cages were made with.

    ``behind``: whether the cages are out of date; ``problem``: why they cannot follow; ``seconds``: time of the last
    step; ``job``: what works on it.
    """

    job: Job

    def __init__(
        self,
        scene: Scene,
        source: Object,
        options: Options,
        reading: ReadingOptions,
        used: dict[str, Any],
        changed: Callable[[], None],
    ) -> None:
        self.identity, self.scene, self._used = source.session_uid, scene.name, used
        self.options, self.reading, self._changed = options, reading, changed
        self.behind, self.problem, self.seconds = True, "", 0.0
        self._marked = self._since = time.perf_counter()
        self._dirty, self._frame, self._left = True, scene.frame_current_final, ""

    def mark(self) -> None:
        """Note that the drawing may have changed, so its cages may be out of date."""
        self._dirty, self._marked = True, time.perf_counter()
        if not self.behind:
            self.behind = True
            self._changed()

    def look_at(self, depsgraph: bpy.types.Depsgraph) -> None:
        """Notes changes to the shape of the drawing: to its object, or to its data, which alone is tagged in Edit Mode;
        and cages that are others than this has left, as after undo.
        """
        source = found_object(self.identity)
        if source is None:
            return
        ours = {source.session_uid, source.data.session_uid if source.data is not None else 0}
        for update in depsgraph.updates:
            block: Any = update.id.original
            drawn = block.session_uid in ours and (update.is_updated_geometry or block != source)
            if drawn or (
                isinstance(block, Object) and cage_sets.level_of(block) == 0 and self._is_other(block, source)
            ):
                self.mark()
                return

    def _is_other(self, fine: Object, source: Object) -> bool:
        cage_set = CageSet.of(fine)
        return cage_set is not None and cage_set.source == source and cage_sets.stamp(fine) != self._left

    def work(self) -> Work[None]:
        """Keeps the cages up to date, as long as they can follow."""
        while (followed := self._followed()) is not None:
            before = (self.behind, self.problem)
            if self._frame != (frame := bpy.data.scenes[self.scene].frame_current_final):
                self._frame, self._dirty, self._marked = frame, True, time.perf_counter()
            shown = scene_of(bpy.context).name == self.scene
            if self._dirty and shown and time.perf_counter() - self._since >= self.seconds:
                try:
                    yield from self._follow(*followed)
                except UserError as error:
                    self._dirty, self.behind, self.problem = False, True, str(error)
            if (self.behind, self.problem) != before:
                self._changed()
            yield Progress(0.0, "", LOOK_INTERVAL)

    def _followed(self) -> tuple[Object, CageSet] | None:
        """The drawing and the output that follows it; None if that has ended."""
        scene, source = bpy.data.scenes.get(self.scene), found_object(self.identity)
        cage_set = CageSet.beside(source) if scene is not None and source is not None else None
        if source is None or cage_set is None or why_not(cage_set) or visibility.is_animated(cage_set):
            return None
        return source, cage_set

    def _follow(self, source: Object, cage_set: CageSet) -> Work[None]:
        """Updates the cages, or makes them again. Raises: UserError."""
        now = time.perf_counter()
        drawing = drawing_now(bpy.context, source, self.reading)
        done = self._step(cage_set, drawing, drawing.mesh(), scale_of(source))
        self._since = time.perf_counter()
        self.seconds = self._since - now
        self.behind, self.problem = not done, ""
        self._leave(cage_set)
        if done or now - self._marked >= REST:
            self._dirty = False
        if done or self._dirty:
            return
        for progress in self._again(cage_set, drawing, scale_of(source)):
            yield progress
            self._changed()
            if self._dirty:  # edited meanwhile
                return
            if self.job.cancelled:
                self.job.cancelled = False
                raise UserError("Cancelled: edit the drawing, and its cages follow again")
        self.behind = False
        self._leave(CageSet.beside(source))

    def _leave(self, cage_set: CageSet | None) -> None:
        """Notes how the cages are left."""
        fine = cage_set.fine if cage_set is not None else None
        self._left = cage_sets.stamp(fine) if fine is not None else ""
        if cage_set is not None and not self.behind:
            changes.settle([cage_set])

    def _step(self, cage_set: CageSet, drawing: Drawing, after: core.Mesh, unit: float) -> bool:
        """Moves the cages by one step if necessary; returns whether they enclose the current drawing."""
        objects = cage_set.members
        if cage_set.fine is None or any(obj.mode != "OBJECT" for obj in objects):
            return False
        before, *cages = (mesh_data.shape_of(obj) for obj in objects)
        if not np.array_equal(before.edges, after.edges):
            return False
        if np.array_equal(before.vertices, after.vertices):
            return True
        settings = replace(self.options.methods(), stored=STORED)
        wanted_of, scale = self._tolerances(drawing.name, after, unit, len(objects) - 1), scale_of(objects[0])
        moved, certificates, met = [after], [], []
        for cage, tolerance in zip(cages, wanted_of, strict=True):
            wanted = self._clearance(after, unit)
            moved_cage = core.followed(cage, before, moved[-1], wanted, settings)
            if moved_cage is None or (tolerance is not None and not tolerance.is_met(moved_cage, after)):
                return False
            certificates.append(core.verify(moved_cage, moved[-1], wanted))
            met.append(
                ()
                if tolerance is None
                else (tolerance.note(len(moved_cage.vertices), tolerance.measured(moved_cage, after)),)
            )
            before, moved = cage, [*moved, moved_cage]
        for obj, mesh in zip(objects, moved, strict=True):
            data, points = mesh_data.mesh_of(obj), drawing.frame.points(mesh.vertices).astype(np.float32).ravel()
            data.vertices.foreach_set("co", points)
            if data.shape_keys is not None:
                data.shape_keys.reference_key.points.foreach_set("co", points)
            data.update()
        for obj, certificate, notes in zip(objects[1:], certificates, met, strict=True):
            cage_sets.restate(obj, float(certificate.clearance) * scale, float(certificate.excess), notes, scale)
        return True

    def _clearance(self, fine: core.Mesh, scale: float) -> float:
        """The wanted clearance, in the drawing's units; scale: the scene's length of one."""
        wanted = self.options.clearance / scale or self.options.clearance_share * fine.diagonal
        return wanted or float(core.levels.DEFAULT_CLEARANCE * fine.diagonal)

    def _tolerances(self, name: str, fine: core.Mesh, scale: float, count: int) -> list[core.Within | None]:
        """The distance or excess that each cage keeps, in the drawing's units; None for a number of vertices."""
        levels = [level if isinstance(level, core.Within) else 3 for level in self.options.levels]
        wanted = wanted_levels(levels, fine, (), name, scale) if len(levels) == count else ()
        return [each if isinstance(each, core.Within) else None for each in wanted] or [None] * count

    def _again(self, cage_set: CageSet, drawing: Drawing, unit: float) -> Work[None]:
        """Makes cages again, within the same tolerance or with the same vertex counts as far as possible."""
        fine, cages = drawing.mesh(), cage_set.cages
        tolerances = self._tolerances(drawing.name, fine, unit, len(cages))
        levels = tuple(
            tolerance or min(len(fine.vertices), len(mesh_data.mesh_of(obj).vertices))
            for tolerance, obj in zip(tolerances, cages, strict=True)
        )
        clearance = self._clearance(fine, unit) if self.options.clearance > 0.0 else 0.0
        options = replace(self.options, levels=levels, clearance=clearance, show_flow=False)
        generation = Generation([Request(drawing)], options)
        yield from generation
        writing.write_still(scene_again(self.scene), generation.results[0], self._used)


def why_not(cage_set: CageSet) -> str:
    """Why the cages of an output cannot follow edits; empty if they can."""
    if cage_set.inside:
        return "Only cages around a drawing follow its edits: make inner cages again with Generate"
    if cage_set.bound:
        return "Unbind the drawing from its cages first"
    if not cage_set.record.known:
        return "These cages have no settings that they could be made again with: make them with Generate"
    if len(cage_set.parts) > 1:
        return "Several drawings share these cages: make them again with Generate"
    kinds = cage_set.record.kinds
    if kinds:
        return f"These cages are {kinds}, which following edits would undo: make them again with Generate"
    if cage_set.record.moving:
        return "The cages follow an animation: remove that first"
    return ""


_current: list[Live] = []


def current() -> Live | None:
    """The drawing that is followed, if Live is on."""
    return _current[0] if _current else None


def start(live: Live) -> None:
    """Switches Live on for a drawing, and off for any other."""
    stop()
    _current.append(live)
    live.job = Job(live.work(), live.scene, background=True)
    live.job.start(stop)


def stop(*_: object) -> None:
    """Switches Live off and removes its job."""
    while _current:
        _current.pop().job.stop()


def look_at(depsgraph: bpy.types.Depsgraph) -> None:
    """Notes changes of the drawing that is followed."""
    live = current()
    if live is not None:
        live.look_at(depsgraph)
