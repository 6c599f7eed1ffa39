"""Results as objects: per drawing a fine mesh and one object per cage, in a collection, in place of earlier ones."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from bpy.types import Collection, Object, Scene
from numpy.typing import NDArray

from .. import cage_sets
from ..animation import timeline, visibility
from ..animation.timeline import Phases, Span, Timing
from ..blender import display, shape_keys
from ..cage_sets import CageSet, selection
from ..cage_sets.selection import check_free, colours_of
from ..core import core
from ..drawing import placement
from ..transfer.rig import Rig
from .replaced import Replaced
from .run import Result


def write(
    scene: Scene, results: Sequence[Result], timing: Timing, thickness: float = 0.0, *, still: bool = False
) -> tuple[list[CageSet], list[str]]:
    """Writes the cages of each drawing; returns their sets, and sentences about the artist's work on earlier ones that
    could not be transferred. still: without the animation of its steps. Raises: UserError, before anything is changed,
    if earlier cages cannot be replaced. Any other fault leaves a scene that is half written, which Blender's undo takes
    back.
    """
    earlier = earlier_sets(results)
    for cage_set in filter(None, earlier):
        check_free(cage_set.members)
    visibility.leave(*filter(None, earlier))
    home = _home(scene, [result for result, before in zip(results, earlier, strict=True) if before is None])
    all_played = [timeline.spans(list(map(Phases.of, result.levels)), timing) for result in results]
    # Several play together: one marker, on the last result.
    end = max(played[-1].end for played in all_played)
    marker = (f"{len(results)} Drawings", end) if len(results) > 1 else None
    dropped: list[timeline.Mark] = []
    added: list[timeline.Mark] = []
    sets, replaced = list[CageSet](), Replaced()
    for result, played, before in zip(results, all_played, earlier, strict=True):
        dropped += timeline.stop_playing(before) if before is not None else []
        cage_set = _write_one(result, timing, played, before, home, replaced)
        added.append(timeline.play_in(cage_set, played, marker))
        sets.append(cage_set)
    timeline.settle(scene, dropped, added)
    for result, cage_set in zip(results, sets, strict=True):
        _set_thickness(cage_set, result, thickness)
    for cage_set in sets:
        if not any(scene.objects.get(obj.name) == obj for obj in cage_set.members):  # made in another scene
            drawer = selection.drawer_of(cage_set) or cage_set.finest.users_collection[0]
            selection.home_of(scene, cage_set.source).children.link(drawer)
        visibility.enter(cage_set)
    replaced.remove()
    for cage_set in sets if still else ():
        visibility.end(scene, cage_set)
    return sets, replaced.lost


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


def earlier_sets(results: Sequence[Result]) -> list[CageSet | None]:
    """The set that each result will replace, if there is one: its own, or one that its drawings share."""
    earlier: list[CageSet | None] = []
    for result in results:
        drawings = [each.source for each in (result.drawing, *result.drawing.others) if each.source is not None]
        sets = [(obj, CageSet.beside(obj, inside=result.inside)) for obj in drawings]
        earlier.append(next((s for obj, s in sets if s and (obj == drawings[0] or len(s.parts) > 1)), None))
    return earlier


def _write_one(
    result: Result, timing: Timing, played: Sequence[Span], before: CageSet | None, home: Collection, replaced: Replaced
) -> CageSet:
    """Writes one set, in place of the one before or into a new collection."""
    source, first = result.drawing.source, result.levels[0]
    name = source.name if source is not None else result.drawing.name
    title = f"{name} {'Inner Cages' if result.inside else 'Cages'}"
    old_fine, old_cages = (before.fine, before.cages) if before is not None else (None, [])
    old = [obj for obj in (old_fine, *old_cages) if obj is not None]
    colours = colours_of(before)
    for obj in old:
        replaced.set_aside(obj)
    if before is not None:
        _rename(before, name)
        drawers = before.cages[0].users_collection
    else:
        drawer = bpy.data.collections.new(title)
        home.children.link(drawer)
        drawers = (drawer,)

    def object_of(number: int, what: str, shape: core.Mesh) -> Object:
        there = old_fine if number == 0 else old_cages[number - 1] if number <= len(old_cages) else None
        name_of_it = f"{name} {'Inner ' if result.inside else ''}{what}"
        return _with_mesh(there, name_of_it, shape, result, replaced, drawers, number, colours)

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
    for surplus in [obj for obj in old if obj not in (fine, *cages)]:
        replaced.leave(surplus)

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


def _with_mesh(
    obj: Object | None,
    name: str,
    shape: core.Mesh,
    result: Result,
    replaced: Replaced,
    drawers: Sequence[Collection],
    level: int,
    colours: int,
) -> Object:
    """A member with a new mesh, in the drawing's place; an existing one with the artist's work on it."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(shape.vertices))
    mesh.edges.add(len(shape.edges))
    mesh.vertices.foreach_set("co", result.drawing.frame.points(shape.vertices).astype(np.float32).ravel())
    mesh.edges.foreach_set("vertices", shape.edges.astype(np.int32).ravel())
    mesh.update()
    if obj is None:
        obj = bpy.data.objects.new(name, mesh)
        for drawer in drawers:
            drawer.objects.link(obj)
        display.apply_display(obj, level, colours)
    else:
        rig = Rig.of(obj)
        obj.data = mesh
        replaced.lose(obj, rig.give(obj))
    placement.place(obj, result.drawing.source, result.drawing.frame)
    return obj


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
    """Renames the objects of a set and their collection if its drawing was renamed; names given by the user stay."""
    before, drawer = cage_set.record.title, selection.drawer_of(cage_set)
    if before in ("", name):
        return
    for block in (*cage_set.members, *([drawer] if drawer is not None else [])):
        if block.name.startswith(f"{before} "):
            block.name = name + block.name.removeprefix(before)
