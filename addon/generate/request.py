"""Cages made, or made again, for the Generate button and for scripts: drawings are read, cages computed and written,
and what was bound or posed before is so again.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace

import bpy
import numpy as np
from bpy.types import Context, Object, Scene

from .. import cage_sets
from ..animation.timeline import Timing
from ..bind import field
from ..blender.jobs import Progress, Work
from ..cage_sets import CageSet, changes, selection
from ..cage_sets.selection import scene_again, scene_of
from ..drawing import painted, planar
from ..drawing.evaluated import Lines, lines_of_all
from ..drawing.grease_pencil import hidden_parts
from ..errors import UserError, counted
from ..messages import in_scene, is_told, larger, note
from .options import Options, Places
from .run import Generation, Request, Result
from .settings import GenerationProperties, all_values, filled
from .write import Tell, write

# Weight in a vertex group from which on a vertex is pinned.
PINNED = 0.5


def make(
    context: Context,
    drawings: Sequence[Object],
    own: Sequence[Object],
    values: GenerationProperties,
    tell: Tell,
    *,
    jump: bool = True,
    still: bool = False,
) -> Work[tuple[list[CageSet], list[UserError]]]:
    """Cages around each drawing, or in common ones; returns their sets, and why some drawings have none.

    The first drawing is the active one. own: objects that are levels. A drawing stands for all that share its cages.
    jump: to the frame of the result; still: without an animation. Raises: UserError if nothing can be caged.
    """
    scene = scene_of(context)
    options, name = Options.of(values, scene), scene.name
    groups = selection.with_parts(drawings, inside=values.inside)
    for group in groups:
        if not set(group) <= set(drawings):
            others = counted(len(group) - 1, "drawing")
            tell("INFO", f"'{group[0].name}' shares its cages with {others}: all are used")
    with field.unposed(itertools.chain(*groups)):
        asked, problems = _requests(context, groups, own, values)
        generation = Generation(asked, options)
    before = changes.states(itertools.chain(*groups))
    yield from generation
    yield Progress(1.0, "writing")
    problems += generation.problems
    edited, used = changes.edited_since(before), all_values(values)
    results = [replace(result, used=used) for result in generation.results]
    return _put(scene_again(name), results, values, edited, tell, jump=jump, still=still), problems


def _put(
    scene: Scene,
    results: Sequence[Result],
    values: GenerationProperties,
    edited: set[int],
    tell: Tell,
    *,
    jump: bool,
    still: bool,
) -> list[CageSet]:
    """Puts the results into the scene; edited: session IDs of drawings that changed meanwhile. Raises: UserError."""
    if bpy.context.mode == "EDIT_MESH":
        # Undo in Edit Mode only covers the edited mesh.
        bpy.ops.object.mode_set(mode="OBJECT")
    sets = write(scene, results, filled(Timing, values), tell, values.thickness, still=still, jump=jump)
    bpy.context.view_layer.update()
    changes.settle(sets, edited)
    cages = [level for result in results for level in result.levels]
    scale = results[0].drawing.frame.scale
    for said in dict.fromkeys(said for level in cages for said in level.report.notes):
        if is_told(said.code, said.data):
            tell("INFO" if said.code == cage_sets.TOLERANCE else "WARNING", in_scene(said, scale))
    sizes = np.concatenate([np.cumprod([1.0 + level.excess for level in result.levels]) for result in results])
    around, shown = "", ", ".join(map(larger, sizes))
    if len(results) > 1:
        around, shown = f" for {len(results)} drawings", f"{larger(sizes.min())} to {larger(sizes.max())}"
    kind = "certified inner cage" if results[0].inside else "certified cage"
    tell("INFO", f"{counted(len(cages), kind)}{around}: {shown}")
    return sets


def _requests(
    context: Context, groups: Sequence[Sequence[Object]], own: Sequence[Object], values: GenerationProperties
) -> tuple[list[Request], list[UserError]]:
    """The requests of drawings: each group with its own cages, or all in common ones; and for several, why some cannot
    be caged. Raises: UserError if none can.
    """
    drawings = [list(itertools.chain(*groups))] if values.together else groups
    asked, problems = [], []
    lines = lines_of_all(context, [*itertools.chain(*drawings), *own])
    for objects in drawings:
        try:
            asked.append(_request(context, objects, own, lines, values))
        except UserError as error:
            problems.append(error)
    if problems and not asked:
        raise problems[0]
    return asked, problems


def _request(
    context: Context,
    objects: Sequence[Object],
    own: Sequence[Object],
    lines: Mapping[Object, Lines],
    values: GenerationProperties,
) -> Request:
    """One drawing, of all objects, and the user's own levels for it. Raises: UserError."""
    reading = filled(planar.ReadingOptions, values)
    outlines = [planar.read(context, obj, reading, lines.get(obj)) for obj in objects]
    fine = planar.fine_drawing(outlines[0], reading)
    layers = [planar.drawing_in(fine.frame, outline, reading, layer=True) for outline in outlines[1:]]
    fine = planar.joined(fine, layers)
    others = [planar.read(context, obj, reading, lines.get(obj)) for obj in own]
    coarse = [planar.drawing_in(fine.frame, outline, reading) for outline in others]
    if values.use_selected_as_levels:
        coarse.sort(key=lambda drawing: -sum(map(len, drawing.loops)))
    return Request(fine, tuple(coarse), _places(context, objects, fine, values))


def _places(context: Context, objects: Sequence[Object], fine: planar.Drawing, values: GenerationProperties) -> Places:
    """Where it matters in a drawing. Raises: UserError."""
    points = np.concatenate(fine.loops)
    missing = [note("drawing.hidden", **hidden) for hidden in hidden_parts(context, objects)]
    places = {}
    for group in filter(None, (values.weight_group, values.pin_group)):
        weights = painted.painted(context, objects, fine.frame, group, points)
        if weights is None or not weights.any():
            missing.append(note("places.empty", name=fine.name, group=group))
        else:
            places[group] = weights
    joints: list[list[float]] = []
    if values.joint_armature:
        armature = context.scene.objects.get(values.joint_armature)
        if armature is None or armature.type != "ARMATURE":
            raise UserError(f"'{values.joint_armature}' is not an armature in the scene: choose one for 'Joints'")
        joints = painted.bone_ends(armature, fine.frame).tolist()
    return Places(
        weights=tuple(places[values.weight_group].tolist()) if values.weight_group in places else (),
        pins=tuple(np.flatnonzero(places[values.pin_group] > PINNED).tolist()) if values.pin_group in places else (),
        joints=tuple((x, y) for x, y in joints),
        notes=tuple(missing),
    )
