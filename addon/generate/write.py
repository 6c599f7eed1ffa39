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
from ..animation.timeline import Span, Timing
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
    bound: bool = True,
) -> list[CageSet]:
    """Writes the cages of each drawing and returns their sets; what was bound and posed before is so again. tell: what
    of the artist's work could not be kept.

    still: without the animation of its steps; jump: to the frame of the result. Raises: UserError, before anything is
    changed, if earlier cages cannot be replaced. Any other fault leaves a scene that is half
    written, which Blender's undo takes back.
    """
    sources = [_source(result) for result in results]
    replaced = list[CageSet | None]()
    for result, source in zip(results, sources, strict=True):
        earlier_set = _earlier_set(result, source)
        replaced.append(None if earlier_set in replaced else earlier_set)  # drawings may be cages of one set
    for cage_set in filter(None, replaced):
        check_free(cage_set.members)
    complete()
    earlier = [_Earlier(cage_set, tell) for cage_set in replaced]
    visibility.leave(*filter(None, replaced))
    dropped = [visibility.stop_playing(cage_set) for cage_set in replaced if cage_set is not None]
    home = _home(scene, [source for source, before in zip(sources, replaced, strict=True) if before is None])
    sets = list[CageSet]()
    for result, source, before in zip(results, sources, earlier, strict=True):
        sets.append(_write_one(result, source, timing, before, home))
        _set_thickness(sets[-1], result, thickness)
    _play(scene, sets, dropped)
    surplus = [obj for each in earlier for obj in each.surplus]
    shape_keys.discard(surplus, list(map(mesh_of, surplus)), ())
    for cage_set in sets if still else ():
        visibility.end(scene, cage_set)
    if jump:
        scene.frame_set(max(cage_set.record.frames[1] for cage_set in sets))
    for cage_set, before in zip(sets, earlier, strict=True):
        before.give(cage_set, bound=bound)
    return sets


def _source(result: Result) -> Object:
    source = result.drawing.source
    if source is None:
        raise UserError(f"'{result.drawing.name}' was deleted meanwhile, so its cages were discarded")
    return source


def _play(scene: Scene, sets: Sequence[CageSet], dropped: Sequence[visibility.Mark]) -> None:
    """Lets new cages play in a scene; several together, with one marker, on the last result."""
    ends = [cage_set.record.frames[1] for cage_set in sets]
    shared = (f"{len(sets)} Drawings", max(ends))
    markers = [shared if len(sets) > 1 else (each.record.title, end) for each, end in zip(sets, ends, strict=True)]
    for cage_set, marker in zip(sets, markers, strict=True):
        visibility.play_in(cage_set, marker)
    visibility.settle(scene, dropped, markers)
    for cage_set in sets:
        if not visibility.is_in(scene, cage_set):  # made in another one
            drawer = selection.drawer_of(cage_set) or cage_set.finest.users_collection[0]
            selection.home_of(scene, cage_set.source).children.link(drawer)
        visibility.enter(cage_set)


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


def _home(scene: Scene, sources: Sequence[Object]) -> Collection:
    """The collection for new outputs: that of the first drawing, or for several outputs a new one in it."""
    own = selection.home_of(scene, next(iter(sources), None))
    if len(sources) < 2:
        return own
    run = bpy.data.collections.new(f"Cages of {len(sources)} Drawings")
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


def _earlier_set(result: Result, source: Object) -> CageSet | None:
    """The set that a result will replace, if there is one: its own, or one that its drawings share."""
    others = [each.source for each in result.drawing.others]
    for obj in filter(None, (source, *others)):
        cage_set = CageSet.beside(obj, inside=result.inside)
        if cage_set is not None and (obj == source or len(cage_set.parts) > 1):
            return cage_set
    return None


def _write_one(result: Result, source: Object, timing: Timing, before: _Earlier, home: Collection) -> CageSet:
    """Writes one set, in place of the one before or into a new collection."""
    inside, frame, levels, name = result.inside, result.drawing.frame, result.levels, source.name
    title = f"{name} {'Inner Cages' if inside else 'Cages'}"
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
        points = frame.points(shape.vertices)
        if there is None:
            label = f"{name} {'Inner ' if inside else ''}{what}"
            there = bpy.data.objects.new(label, new_mesh(label, points, shape.edges))
            for drawer in drawers:
                drawer.objects.link(there)
            display.apply_display(there, number, colours)
        else:
            before.reshape(there, points, shape.edges)
        placement.place(there, source, frame)
        return there

    played, action = timeline.spans(levels, timing), shape_keys.new_action(title)

    def key(obj: Object, steps: NDArray[np.float32], level: int, *, from_rest: bool = False) -> None:
        frames = played[level].steps
        shown = steps[len(steps) - len(frames) :]  # the flow may be left out
        shape_keys.add_steps(obj, shown, frames, f"Level {level + 1}", from_rest=from_rest, action=action)

    fine = object_of(0, "Fine", levels[0].fine)
    key(fine, _fine_steps(levels[0]), 0)
    cages = []
    for number, (level, span) in enumerate(zip(levels, played, strict=True)):
        cage = object_of(number + 1, f"Cage {number + 1}", level.cage)
        key(cage, _cage_steps(level), number)
        if number + 1 < len(levels):
            key(cage, _fine_steps(levels[number + 1]), number + 1, from_rest=True)
        visibility.hide_until(cage, span.flow, action)
        cages.append(cage)
    if action is not None and not action.users:  # all have actions of the artist's
        bpy.data.actions.remove(action)
    before.leave([fine, *cages])

    cage_set = CageSet.make(fine, cages)
    for cage, level, span in zip(cages, levels, played, strict=True):
        _describe(cage, result, level, span)
    cage_set.take([source, *filter(None, (part.source for part in result.drawing.others))], inside=inside)
    noted = cage_set.record
    noted.title, noted.colours, noted.kinds, noted.moving = name, colours, ", ".join(result.kinds), False
    noted.frames = (played[0].flow, played[-1].end, played[-1].end)
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
