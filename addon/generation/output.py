"""Results as objects: one collection per drawing with its fine mesh and one object per cage, in place of earlier
output.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple

import bpy
import numpy as np
from bpy.types import Collection, Object, Scene
from numpy.typing import NDArray

from .. import record
from ..animation import shape_keys, timeline, visibility
from ..animation.timeline import Phases, Span, Timing
from ..core import core
from ..rigging.rig import Rig, is_rigged
from ..scene import display, ownership, placement
from ..scene.ownership import check_free, colours_of, level_of, member, members
from .generate import Result
from .replaced import Replaced


def duration(collection: Collection, timing: Timing) -> int | None:
    """Frames that the steps of an output would take with other timing; None if it has no steps."""
    stored = [Phases.stored(cage) for cage in members(collection)[1:]]
    phases = [each for each in stored if each is not None]
    if not stored or len(phases) < len(stored):
        return None
    return timeline.spans(phases, timing)[-1].end - timing.start_frame + 1


def write(
    scene: Scene, results: Sequence[Result], timing: Timing, thickness: float = 0.0, *, still: bool = False
) -> tuple[list[Collection], list[str]]:
    """Writes the output of each drawing; returns the collections, and sentences about the artist's work on earlier
    output that could not be transferred. still: without the animation of its steps. Raises: UserError, before anything
    is changed, if earlier output cannot be replaced. Any other fault leaves a scene that is half written, which
    Blender's undo takes back.
    """
    earlier = earlier_outputs(scene, results)
    for collection in filter(None, earlier):
        check_free(members(collection))
    visibility.leave(*filter(None, earlier))
    home = _home(scene, [result for result, before in zip(results, earlier, strict=True) if before is None])
    all_played = [timeline.spans(list(map(Phases.of, result.levels)), timing) for result in results]
    # Several play together: one marker, on the last result.
    end = max(played[-1].end for played in all_played)
    marker = (f"{len(results)} Drawings", end) if len(results) > 1 else None
    dropped: list[timeline.Mark] = []
    added: list[timeline.Mark] = []
    collections, replaced = [], Replaced()
    for result, played, before in zip(results, all_played, earlier, strict=True):
        collection = before or _new_collection(home, result)
        dropped += timeline.stop_playing(scene, collection)
        _write_one(result, timing, played, collection, replaced)
        added.append(timeline.play_in(collection, played, marker))
        record.keep(collection)
        collections.append(collection)
    timeline.settle(scene, dropped, added)
    for result, collection in zip(results, collections, strict=True):
        _set_thickness(collection, result, thickness)
    for collection in collections:
        if not any(scene.objects.get(obj.name) == obj for obj in members(collection)):  # made in another scene
            ownership.home_of(scene, ownership.source_of(collection)).children.link(collection)
        visibility.enter(collection)
    replaced.remove()
    for collection in collections if still else ():
        visibility.end(scene, collection)
        record.keep(collection)
    return collections, replaced.lost


def _home(scene: Scene, results: Sequence[Result]) -> Collection:
    """The collection for new outputs: that of the first drawing, or for several outputs a new one in it."""
    source = results[0].drawing.source if results else None
    own = ownership.home_of(scene, source)
    if len(results) < 2:
        return own
    run = bpy.data.collections.new(f"Cages of {len(results)} Drawings")
    own.children.link(run)
    return run


def _new_collection(home: Collection, result: Result) -> Collection:
    """A collection for the output of a drawing."""
    source = result.drawing.source
    kind = "Inner Cages" if result.inside else "Cages"
    collection = bpy.data.collections.new(f"{source.name if source is not None else result.drawing.name} {kind}")
    record.new(collection)
    home.children.link(collection)
    return collection


def _set_thickness(collection: Collection, result: Result, thickness: float) -> None:
    """Gives lines a thickness in renders, in scene units; 0: the cages alone, in proportion to the drawing."""
    automatic = display.AUTOMATIC_PART * result.levels[0].fine.diagonal
    for obj in members(collection):
        if thickness > 0.0:
            display.set_thickness(obj, thickness / result.drawing.frame.scale)
        else:
            wanted = automatic if level_of(obj) else 0.0
            display.set_thickness(obj, wanted, display.AUTOMATIC_THICKNESS)


def earlier_outputs(scene: Scene, results: Sequence[Result]) -> list[Collection | None]:
    """The output that each result will replace, if there is one: its own, or one that its drawings share."""
    known = ownership.by_drawing(scene)
    earlier: list[Collection | None] = []
    for result in results:
        drawings = [each.source for each in (result.drawing, *result.drawing.others) if each.source is not None]
        outputs = [(obj, known.get((obj, result.inside))) for obj in drawings]
        theirs = (o for obj, o in outputs if o and (obj == drawings[0] or len(record.of(o).sources) > 1))
        earlier.append(next(theirs, None))
    return earlier


def _write_one(
    result: Result, timing: Timing, played: Sequence[Span], collection: Collection, replaced: Replaced
) -> None:
    """Writes one output into its collection."""
    source, first = result.drawing.source, result.levels[0]
    name = source.name if source is not None else result.drawing.name
    cage_set = record.of(collection)
    cage_set.colours = colours_of(collection)
    before = members(collection)
    for obj in before:
        replaced.set_aside(obj)
    _rename(collection, name)

    inner, action = "Inner " if result.inside else "", shape_keys.new_action(collection.name)
    fine = _member_with_mesh(collection, 0, f"{name} {inner}Fine", first.fine, result, replaced)
    _key_steps(fine, _fine_steps(first), first, played, timing, 1, action)
    made = [fine]
    for number, (level, span) in enumerate(zip(result.levels, played, strict=True), 1):
        cage = _member_with_mesh(collection, number, f"{name} {inner}Cage {number}", level.cage, result, replaced)
        _key_steps(cage, _cage_steps(level), level, played, timing, number, action)
        if number < len(result.levels):
            following = result.levels[number]
            _key_steps(cage, _fine_steps(following), following, played, timing, number + 1, action, from_rest=True)
        visibility.hide_until(cage, span.flow, action)
        _describe(cage, result, level, span)
        made.append(cage)
    if action is not None and not action.users:  # all have actions of the artist's
        bpy.data.actions.remove(action)
    for surplus in [obj for obj in before if obj not in made]:
        (replaced.kept if is_rigged(surplus) else replaced.surplus).append(surplus)

    record.refer(cage_set.sources, filter(None, (source, *(part.source for part in result.drawing.others))))
    record.refer(cage_set.levels, made)
    cage_set.title, cage_set.inside, cage_set.kinds, cage_set.moving = (
        name,
        result.inside,
        ", ".join(result.kinds),
        False,
    )
    cage_set.known = result.used is not None
    if result.used is not None:
        record.assign(cage_set.settings, result.used)
    for number, obj in enumerate(made):
        member_of_it = record.node_of(obj)
        member_of_it.level, member_of_it.of, member_of_it.home = number, source, collection


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


def _member_with_mesh(
    collection: Collection, level: int, name: str, shape: core.Mesh, result: Result, replaced: Replaced
) -> Object:
    """An object of a level with a new mesh, in the drawing's place; an existing one with the artist's work on it."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(shape.vertices))
    mesh.edges.add(len(shape.edges))
    mesh.vertices.foreach_set("co", result.drawing.frame.points(shape.vertices).astype(np.float32).ravel())
    mesh.edges.foreach_set("vertices", shape.edges.astype(np.int32).ravel())
    mesh.update()
    obj = member(collection, level)
    if obj is None:
        obj = bpy.data.objects.new(name, mesh)
        record.new_node(obj).role = record.CAGE if level else record.FINE
        collection.objects.link(obj)
        display.apply_display(obj, level, record.of(collection).colours)
    else:
        rig = Rig.of(obj)
        obj.data = mesh
        replaced.lose(obj, rig.give(obj))
    placement.place(obj, result.drawing.source, result.drawing.frame)
    return obj


def _describe(obj: Object, result: Result, level: core.Level, span: Span) -> None:
    """What is certified of a cage, how it came about and when it plays; lengths in scene units."""
    node, report = record.node_of(obj), level.report
    node.inside = level.inside
    node.clearance, node.excess = report.clearance * result.drawing.frame.scale, report.excess
    node.most, node.start, node.seconds = report.excess, str(report.start), float(sum(report.seconds.values()))
    node.certified = {"LOOPS"} if level.cage.has_loops_like(level.fine) else set()
    node.frames = (span.flow, span.reinflation, span.tightening, span.end)
    node.phases = astuple(Phases.of(level))
    node.check, node.stamp = "NONE", record.stamp(obj)
    record.set_notes(node, report.notes, result.drawing.frame.scale)


def _rename(collection: Collection, name: str) -> None:
    """Renames an output if its drawing was renamed; names given by the user stay."""
    before = record.of(collection).title
    if before in ("", name):
        return
    for block in (collection, *members(collection)):
        if block.name.startswith(f"{before} "):
            block.name = name + block.name.removeprefix(before)
