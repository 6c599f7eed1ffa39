"""Results to objects: one collection per drawing with its fine mesh and one object per cage, replacing what was there
from before.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ..animation import shape_keys, visibility
from ..animation.shape_keys import Span, StoredPhases, Timing
from ..errors import Refusal, say
from ..generation.generate import CageLevel, Result
from . import display
from .ownership import LEVEL, SOURCE, collection_of, member, members
from .rollback import TRANSFORM, Replaced

# Custom properties of output collections and cages.
MARKERS = "nested_cages_markers"
NAME = "nested_cages_name"
FRAME_END = "nested_cages_frame_end"
PHASES = "nested_cages_phases"


def length(collection: bpy.types.Collection, timing: Timing) -> int | None:
    """Frames that the steps of an output would play with other timing, or None if it has none."""
    cages = members(collection)[1:]
    if not cages or any(PHASES not in cage for cage in cages):
        return None
    timeline = shape_keys.spans([StoredPhases(*cage[PHASES]) for cage in cages], timing)
    return shape_keys.last_frame(timeline, timing) - timing.start_frame + 1


def write(
    scene: bpy.types.Scene, results: Sequence[Result], timing: Timing, thickness: float = 0.0
) -> list[bpy.types.Collection]:
    """Writes the output of each drawing. Raises: Refusal, before anything is changed, if earlier output cannot be
    replaced.
    """
    earlier = [_earlier(scene, result) for result in results]
    for collection in earlier:
        _check_replaceable(collection)
    replaced = Replaced(scene, (collection for collection in earlier if collection is not None))
    try:
        collections = [
            _write_one(scene, result, timing, collection, replaced)
            for result, collection in zip(results, earlier, strict=True)
        ]
        for result, collection in zip(results, collections, strict=True):
            for obj in members(collection):
                display.set_thickness(obj, obj[LEVEL], thickness / result.drawing.frame.scale)
    except BaseException:
        replaced.restore()
        raise
    replaced.finish()
    return collections


def _earlier(scene: bpy.types.Scene, result: Result) -> bpy.types.Collection | None:
    """The output that the result will replace."""
    source = result.drawing.source
    return collection_of(scene, source) if source is not None else None


def _check_replaceable(collection: bpy.types.Collection | None) -> None:
    for obj in members(collection) if collection else ():
        if obj.mode != "OBJECT":
            raise Refusal(
                "'{name}' is about to be replaced but is being edited: go back to Object Mode first", name=obj.name
            )
        if not obj.is_editable:
            raise Refusal("'{name}' cannot be replaced because it is linked from another file", name=obj.name)


def _write_one(
    scene: bpy.types.Scene,
    result: Result,
    timing: Timing,
    collection: bpy.types.Collection | None,
    replaced: Replaced,
) -> bpy.types.Collection:
    """Writes one output into its collection, a new one if there is none."""
    source, first = result.drawing.source, result.levels[0]
    name = source.name if source is not None else result.drawing.name
    if collection is None:
        collection = bpy.data.collections.new(say("{name} Cages", name=name))
        scene.collection.children.link(collection)
    for obj in members(collection):
        replaced.set_aside(obj)
    _rename(collection, name)
    forget_frames(scene, collection)
    timeline = shape_keys.spans(result.levels, timing)

    fine = _member_with_mesh(
        collection, 0, say("{name} Fine", name=name), first.fine_edges, first.fine_steps[-1], result
    )
    _play(fine, first.fine_steps, first, timeline, timing, 1)
    _describe(fine, {LEVEL: 0, "nested_cages_vertices": len(fine.data.vertices)})
    for number, (level, span) in enumerate(zip(result.levels, timeline, strict=True), 1):
        cage = _member_with_mesh(
            collection,
            number,
            say("{name} Cage {number}", name=name, number=number),
            level.cage_edges,
            level.cage,
            result,
        )
        _play(cage, level.cage_steps, level, timeline, timing, number)
        if number < len(result.levels):
            inner = result.levels[number]
            _play(cage, inner.fine_steps, inner, timeline, timing, number + 1, from_rest=True)
        gone = shape_keys.mirrored(span.flow, timeline[-1].end, timing)
        visibility.hide_until(cage, span.flow, round(gone) if timing.loop_back else None)
        _describe(cage, _facts(result, level, span, number))
    for surplus in [o for o in members(collection) if o[LEVEL] > len(result.levels)]:
        replaced.drop(surplus)

    if source is not None:
        collection[SOURCE] = source
    _describe(collection, {NAME: name, "nested_cages_levels": len(result.levels), "nested_cages_end": timeline[-1].end})
    collection[MARKERS] = json.dumps(shape_keys.add_markers(scene, timeline))
    last = shape_keys.last_frame(timeline, timing)
    if scene.frame_end < last:
        collection[FRAME_END] = [scene.frame_end, last]
        scene.frame_end = last
    return collection


def _play(
    obj: bpy.types.Object,
    steps: NDArray[np.float32],
    level: CageLevel,
    timeline: Sequence[Span],
    timing: Timing,
    number: int,
    *,
    from_rest: bool = False,
) -> None:
    """Animates the steps of the level of that number on one object."""
    shown = steps if timing.show_flow else steps[level.flow_end :]
    frames = shape_keys.step_frames(level, timeline[number - 1], timing)
    back = shape_keys.mirrored(frames, timeline[-1].end, timing) if timing.loop_back else None
    shape_keys.add_steps(obj, shown, frames, f"Level {number}", back=back, from_rest=from_rest)


def _member_with_mesh(
    collection: bpy.types.Collection,
    level: int,
    name: str,
    edges: NDArray[np.int64],
    vertices: NDArray[np.float32],
    result: Result,
) -> bpy.types.Object:
    """The collection's object of a level with a new mesh that lies where the drawing does; the object is kept if there
    is one.
    """
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.edges.add(len(edges))
    mesh.vertices.foreach_set("co", result.drawing.frame.points(vertices).astype(np.float32).ravel())
    mesh.edges.foreach_set("vertices", edges.astype(np.int32).ravel())
    mesh.update()
    obj = member(collection, level)
    if obj is None:
        obj = bpy.data.objects.new(name, mesh)
        obj[LEVEL] = level
        collection.objects.link(obj)
        display.dress(obj, level)
    else:
        obj.data = mesh
    _place(obj, result)
    return obj


def _place(obj: bpy.types.Object, result: Result) -> None:
    """Puts the object where the drawing is; with the very numbers of the source's transform if that can be."""
    source = result.drawing.source
    stands_there = source is not None and np.array_equal(np.array(source.matrix_world), result.drawing.frame.matrix)
    if result.drawing.frame.own and stands_there and source.parent is None and not source.constraints:
        copy_transform(source, obj)
    else:
        obj.matrix_world = Matrix(result.drawing.frame.matrix.tolist())


def copy_transform(source: bpy.types.Object, target: bpy.types.Object) -> None:
    """Gives an object the very numbers of another one's transform, which a matrix would round."""
    for channel in TRANSFORM:
        setattr(target, channel, getattr(source, channel))


def _facts(result: Result, level: CageLevel, span: Span, number: int) -> dict[str, Any]:
    """What the panel and other programs can read from a cage; lengths are those of the scene."""
    certificate, report = level.certificate, level.report
    clearance = certificate.clearance * result.drawing.frame.scale
    sentence = (
        "Certified as stored: simple, all loops kept, strictly encloses level {inner}; clearance {clearance:.3g}, "
        "excess {excess:.2f} %"
        if certificate.loops_kept
        else "Certified as stored: simple, with loops of its own, strictly encloses level {inner}; clearance "
        "{clearance:.3g}, excess {excess:.2f} %"
    )
    return {
        LEVEL: number,
        "nested_cages_vertices": len(level.cage),
        "nested_cages_clearance": clearance,
        "nested_cages_excess": float(certificate.excess),
        "nested_cages_begins_from": str(report.start),
        "nested_cages_seconds": float(sum(report.seconds.values())),
        "nested_cages_notes": "; ".join(report.notes),
        "nested_cages_flow_start": span.flow,
        "nested_cages_reinflation_start": span.reinflation,
        "nested_cages_tightening_start": span.tightening,
        "nested_cages_end": span.end,
        PHASES: [level.flow_end, level.tightening, level.last],
        "nested_cages_certificate": say(
            sentence, inner=number - 1, clearance=clearance, excess=100.0 * certificate.excess
        ),
    }


def _describe(owner: Any, properties: dict[str, Any]) -> None:
    for name, value in properties.items():
        owner[name] = value


def forget_frames(scene: bpy.types.Scene, collection: bpy.types.Collection) -> None:
    """Takes back the markers and the end frame that this collection's earlier output brought."""
    shape_keys.remove_markers(scene, [(name, frame) for name, frame in json.loads(collection.get(MARKERS, "[]"))])
    before, after = collection.get(FRAME_END, (0, 0))
    if before and scene.frame_end == after:
        scene.frame_end = before
    if FRAME_END in collection:
        del collection[FRAME_END]


def _rename(collection: bpy.types.Collection, name: str) -> None:
    """Names an output after its drawing again if that was renamed; names that the user gave stay."""
    before = collection.get(NAME, name)
    if before == name:
        return
    for block in (collection, *members(collection)):
        if block.name.startswith(f"{before} "):
            block.name = name + block.name.removeprefix(before)
