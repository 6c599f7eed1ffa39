"""Results as objects: per drawing a fine mesh and one object per cage, in a collection, or in place of earlier ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal, TypeAlias

import bpy
import numpy as np
from bpy.types import Collection, Object, Scene
from numpy.typing import NDArray

from .. import cage_sets, transfer
from ..animation import timeline, visibility
from ..animation.timeline import Phases, Span, Timing
from ..bind import bind
from ..bind.copies import complete
from ..blender import display, shape_keys
from ..blender.mesh_data import mesh_of, new_mesh
from ..cage_sets import CageSet, selection
from ..cage_sets.selection import check_free, colours_of
from ..core import core
from ..drawing import placement
from ..errors import FloatArray, UserError
from .run import Result

# Says a sentence.
Kind: TypeAlias = Literal["INFO", "WARNING"]
Tell: TypeAlias = Callable[[Kind, str], None]


def write(
    scene: Scene,
    results: Sequence[Result],
    timing: Timing,
    tell: Tell = lambda _kind, _sentence: None,
    thickness: float = 0.0,
    *,
    still: bool = False,
    jump: bool = False,
) -> list[CageSet]:
    """Writes the cages of each drawing and returns their sets; what was bound and posed before is so again. tell: what
    of the artist's work could not be kept.

    still: without the animation of its steps, and not bound; jump: to the frame of the result. Raises: UserError,
    before anything is changed, if earlier cages cannot be replaced. Any other fault leaves a scene that is half
    written, which Blender's undo takes back.
    """
    gone = next((result.drawing.name for result in results if result.drawing.source is None), None)
    if gone is not None:
        raise UserError(f"'{gone}' was deleted meanwhile, so its cages were discarded")
    replaced = _earlier_sets(results)
    for cage_set in filter(None, replaced):
        check_free(cage_set.members)
    complete()
    earlier = [_Earlier(cage_set, tell) for cage_set in replaced]
    visibility.leave(*filter(None, replaced))
    home = _home(scene, [result for result, before in zip(results, replaced, strict=True) if before is None])
    all_played = [timeline.spans(list(map(Phases.of, result.levels)), timing) for result in results]
    # Several play together: one marker, on the last result.
    end = max(played[-1].end for played in all_played)
    marker = (f"{len(results)} Drawings", end) if len(results) > 1 else None
    dropped: list[timeline.Mark] = []
    added: list[timeline.Mark] = []
    sets = list[CageSet]()
    for result, played, before in zip(results, all_played, earlier, strict=True):
        dropped += timeline.stop_playing(before.cage_set) if before.cage_set is not None else []
        cage_set = _write_one(result, timing, played, before, home)
        added.append(timeline.play_in(cage_set, played, marker))
        sets.append(cage_set)
    timeline.settle(scene, dropped, added)
    for result, cage_set in zip(results, sets, strict=True):
        _set_thickness(cage_set, result, thickness)
        if not any(scene.objects.get(obj.name) == obj for obj in cage_set.members):  # made in another scene
            drawer = selection.drawer_of(cage_set) or cage_set.finest.users_collection[0]
            selection.home_of(scene, cage_set.source).children.link(drawer)
        visibility.enter(cage_set)
    surplus = [obj for each in earlier for obj in each.surplus]
    shape_keys.discard(surplus, list(map(mesh_of, surplus)), ())
    for cage_set in sets if still else ():
        visibility.end(scene, cage_set)
    if jump:
        scene.frame_set(max(cage_set.record.frames[1] for cage_set in sets))
    for cage_set, before in zip(sets, earlier, strict=True):
        before.give(cage_set, bound=not still)
    return sets


class _Earlier:
    """A set that is to be replaced, if there is one: its objects, released and without our animation, and how they
    were bound and posed. ``surplus``: objects that are not written again, and go at the end.
    """

    def __init__(self, cage_set: CageSet | None, tell: Tell) -> None:
        self.cage_set, self.surplus, self._tell = cage_set, list[Object](), tell
        self.fine, self.cages = (cage_set.fine, cage_set.cages) if cage_set is not None else (None, [])
        objects, source = (cage_set.members, cage_set.source) if cage_set is not None else ([], None)
        self._poses = {obj: transfer.Pose.of(obj, source) for obj in objects}
        self._offsets = dict[Object, FloatArray]()
        self._method = bind.forget(cage_set) if cage_set is not None else ""
        for obj in objects:
            shape_keys.remove_steps(obj)
            visibility.always_show(obj)

    def reshape(self, obj: Object, points: FloatArray, edges: NDArray[np.int64]) -> None:
        """Gives one of the objects another outline."""
        lost, self._offsets[obj] = transfer.reshape(obj, points, edges)
        for part in lost:
            self._tell("WARNING", f"'{obj.name}': {part} could not be kept")

    def leave(self, written: Sequence[Object]) -> None:
        """Lets go what is not written again; it stays in the scene if an artist worked on it."""
        for obj in [each for each in self._poses if each not in written]:
            if not transfer.is_rigged(obj):
                self.surplus.append(obj)
                continue
            for modifier in [modifier for modifier in obj.modifiers if display.is_ours(modifier)]:
                display.remove_modifier(obj, modifier)
            cage_sets.remove(obj)
            self._tell("WARNING", f"'{obj.name}' is no longer a level; it was kept for your work on it")

    def give(self, cage_set: CageSet, *, bound: bool) -> None:
        """Places as before, and binds by the same method; if that fails, the cages stay and the user is told."""
        if self._method and bound:
            try:
                with transfer.unmoved(cage_set.members):
                    bind.bind(bpy.context, cage_set, self._method)
            except UserError as error:
                self._tell("WARNING", f"Not bound again, and poses were lost: {error}")
        for obj in [each for each in cage_set.members if each in self._offsets]:
            self._poses[obj].give(obj, self._offsets[obj], bound=bool(cage_set.bound))


def _home(scene: Scene, results: Sequence[Result]) -> Collection:
    """The collection for new outputs: that of the first drawing, or for several outputs a new one in it."""
    source = results[0].drawing.source if results else None
    own = selection.home_of(scene, source)
    if len(results) < 2:
        return own
    run = bpy.data.collections.new(f"Cages of {len(results)} Drawings")
    own.children.link(run)
    return run


def _set_thickness(cage_set: CageSet, result: Result, thickness: float) -> None:
    """Gives lines a thickness in renders, in scene units; 0: the cages alone, in proportion to the drawing."""
    automatic = display.AUTOMATIC_PART * result.levels[0].fine.diagonal
    for level, obj in enumerate(cage_set.members):
        if thickness > 0.0:
            display.set_thickness(obj, thickness / result.drawing.frame.scale)
        else:
            wanted = automatic if level else 0.0
            display.set_thickness(obj, wanted, display.AUTOMATIC_THICKNESS)


def _earlier_sets(results: Sequence[Result]) -> list[CageSet | None]:
    """The set that each result will replace, if there is one: its own, or one that its drawings share."""
    earlier: list[CageSet | None] = []
    for result in results:
        drawings = [each.source for each in (result.drawing, *result.drawing.others) if each.source is not None]
        sets = [(obj, CageSet.beside(obj, inside=result.inside)) for obj in drawings]
        earlier.append(next((s for obj, s in sets if s and (obj == drawings[0] or len(s.parts) > 1)), None))
    return earlier


def _write_one(result: Result, timing: Timing, played: Sequence[Span], before: _Earlier, home: Collection) -> CageSet:
    """Writes one set, in place of the one before or into a new collection."""
    source, first = result.drawing.source, result.levels[0]
    name = source.name if source is not None else result.drawing.name
    title = f"{name} {'Inner Cages' if result.inside else 'Cages'}"
    colours = colours_of(before.cage_set)
    if before.cage_set is not None:
        _rename(before.cage_set, name)
        drawers = before.cages[0].users_collection
    else:
        drawer = bpy.data.collections.new(title)
        home.children.link(drawer)
        drawers = (drawer,)

    def object_of(number: int, what: str, shape: core.Mesh) -> Object:
        there = before.fine if number == 0 else before.cages[number - 1] if number <= len(before.cages) else None
        points = result.drawing.frame.points(shape.vertices)
        if there is None:
            label = f"{name} {'Inner ' if result.inside else ''}{what}"
            there = bpy.data.objects.new(label, new_mesh(label, points, shape.edges))
            for drawer in drawers:
                drawer.objects.link(there)
            display.apply_display(there, number, colours)
        else:
            before.reshape(there, points, shape.edges)
        placement.place(there, source, result.drawing.frame)
        return there

    action = shape_keys.new_action(title)
    fine = object_of(0, "Fine", first.fine)
    _key_steps(fine, _fine_steps(first), first, played, timing, 1, action)
    cages = []
    for number, (level, span) in enumerate(zip(result.levels, played, strict=True), 1):
        cage = object_of(number, f"Cage {number}", level.cage)
        _key_steps(cage, _cage_steps(level), level, played, timing, number, action)
        if number < len(result.levels):
            following = result.levels[number]
            _key_steps(cage, _fine_steps(following), following, played, timing, number + 1, action, from_rest=True)
        visibility.hide_until(cage, span.flow, action)
        cages.append(cage)
    if action is not None and not action.users:  # all have actions of the artist's
        bpy.data.actions.remove(action)
    before.leave([fine, *cages])

    cage_set = CageSet.make(fine, cages)
    for cage, level, span in zip(cages, result.levels, played, strict=True):
        _describe(cage, result, level, span)
    drawings = filter(None, (source, *(part.source for part in result.drawing.others)))
    cage_set.take(drawings, inside=result.inside)
    noted = cage_set.record
    noted.title, noted.colours, noted.kinds, noted.moving = name, colours, ", ".join(result.kinds), False
    noted.known = result.used is not None
    if result.used is not None:
        cage_sets.assign(noted.settings, result.used)
    return cage_set


def _fine_steps(level: core.Level) -> NDArray[np.float32]:
    """Flow and reinflation of the drawing in one sequence (S, n, 2)."""
    return np.concatenate([level.flow.steps[:-1], level.reinflation.fine_steps]).astype(np.float32)


def _cage_steps(level: core.Level) -> NDArray[np.float32]:
    """The same of the cage (S, m, 2), which rests during the flow."""
    resting = np.broadcast_to(level.coarse.vertices, (len(level.flow.steps) - 1, *level.coarse.vertices.shape))
    return np.asarray(np.concatenate([resting, level.reinflation.cage_steps]), np.float32)


def _key_steps(
    obj: Object,
    steps: NDArray[np.float32],
    level: core.Level,
    played: Sequence[Span],
    timing: Timing,
    number: int,
    action: bpy.types.Action | None,
    *,
    from_rest: bool = False,
) -> None:
    """Animates the steps of a level, given by its number, on one object."""
    phases = Phases.of(level)
    shown = steps if timing.show_flow else steps[phases.flow_end :]
    frames = timeline.step_frames(phases, played[number - 1], timing)
    shape_keys.add_steps(obj, shown, frames, f"Level {number}", from_rest=from_rest, action=action)


def _describe(obj: Object, result: Result, level: core.Level, span: Span) -> None:
    """What is certified of a cage, how it came about and when it plays; lengths in scene units."""
    node, report = cage_sets.new_node(obj), level.report
    node.clearance, node.excess = report.clearance * result.drawing.frame.scale, report.excess
    node.most, node.start, node.seconds = report.excess, str(report.start), float(sum(report.seconds.values()))
    node.certified = {"LOOPS"} if level.cage.has_loops_like(level.fine) else set()
    node.frames = (span.flow, span.reinflation, span.tightening, span.end)
    node.check, node.stamp = "NONE", cage_sets.stamp(obj)
    cage_sets.set_notes(node, report.notes, result.drawing.frame.scale)


def _rename(cage_set: CageSet, name: str) -> None:
    """Renames the objects of a set, their meshes and their collection if its drawing was renamed; names given by the
    user stay.
    """
    before, drawer = cage_set.record.title, selection.drawer_of(cage_set)
    if before in ("", name):
        return
    meshes = map(mesh_of, cage_set.members)
    for block in (*cage_set.members, *meshes, *([drawer] if drawer is not None else [])):
        if block.name.startswith(f"{before} "):
            block.name = name + block.name.removeprefix(before)
