"""Puppets: layered drawings whose parts move by themselves, rigid ones with a bone, bending ones with a field.

The armature is the draft: its bones lie along the parts and hang on each other as the parts do. Pressed again, the
button keeps what was changed there: parents and joints.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from bpy.types import Collection, Context, Object

from .. import keys, record
from ..binding import field
from ..characters import removed_on_failure, skin
from ..core import blamed, core
from ..errors import UserError
from ..generation.job import Progress, Work
from ..io import silhouettes
from ..scene import filling
from ..scene.ownership import select
from ..scene.plane import Frame, world_matrix
from . import armatures
from .armatures import part_of

# Joints that were moved by less than this fraction of the bone's length were not moved by hand.
MOVED = 1e-3
# What the import adds to the name of a layer for a shape without a name.
NUMBERED = re.compile(r"[ .]\d+$")
# Directions along the plane's normal are compared as multiples of this fraction of the drawing's size.
SAME_DEPTH = 1e-7


@dataclass(frozen=True)
class Drawn:
    """Drawings in stacking order, the lowest first, as parts in a plane, and why some were left out."""

    frame: Frame
    objects: tuple[tuple[Object, ...], ...]
    """Those of each part: the shapes of a layer that have no names of their own are one."""
    parts: tuple[core.puppet.PuppetPart, ...]
    problems: tuple[UserError, ...]


def drawn(context: Context, objects: Sequence[Object]) -> Work[Drawn]:
    """What objects paint, each by itself, as parts of a puppet. Raises: UserError if nothing is painted."""
    largest = max(sorted(objects, key=lambda obj: obj.name), key=lambda obj: float(obj.dimensions.length))
    frame = silhouettes.plane_of(context, largest, "ACTIVE")
    normal = np.array(frame.matrix)[:3, 2]
    grid = SAME_DEPTH * max(float(obj.dimensions.length) for obj in objects)
    depth = {obj.name: round(float(normal @ np.array(obj.matrix_world.translation)) / grid) for obj in objects}
    shapes: dict[str, list[Object]] = {}
    for obj in sorted(objects, key=lambda obj: (depth[obj.name], obj.name)):
        shapes.setdefault(_part_name(obj), []).append(obj)
    kept, parts, problems = [], [], []
    for number, (name, own) in enumerate(shapes.items()):
        yield Progress(0.3 * number / len(shapes), f"reading '{name}'")
        try:
            loops, left_out = yield from silhouettes.painted_loops(context, own, frame, closed=True)
        except UserError as error:
            problems.append(error)
            continue
        problems += left_out
        kept.append(tuple(own))
        groups = tuple(home.name for home in own[0].users_collection[:1])
        parts.append(core.puppet.PuppetPart(name, core.Mesh.from_loops(loops), groups, name))
    if not parts:
        raise problems[0]
    return Drawn(frame, tuple(kept), tuple(parts), tuple(problems))


def _part_name(obj: Object) -> str:
    """The name of the part that an object belongs to: its own, or that of its layer, which numbers it."""
    layers = [home.name for home in obj.users_collection]
    stem = NUMBERED.sub("", obj.name)
    return stem if stem in layers else obj.name


def articulate(
    context: Context, given: Drawn, old: Object | None, *, limits: bool = True
) -> Work[tuple[Object, core.puppet.Puppet]]:
    """An armature that moves the drawings part by part. Raises: UserError.

    old: the armature of an earlier puppet of theirs, whose parents and joints count, and which is made again. limits:
    whether bones are limited to their proved ranges.
    """
    yield Progress(0.3, "finding joints")
    names = [part.name for part in given.parts]
    with blamed("The puppet"):
        draft = core.puppet.draft_puppet(given.parts)
        for name, choice in (_choices(old, draft, given.frame) if old is not None else {}).items():
            if name in names:
                draft = draft.edited(name, choice)
        yield Progress(0.4, "cages and weights of parts that bend")
        puppet = core.puppet.puppet_of(draft)
    yield Progress(0.9, "making bones")
    new: list[Object] = []
    with removed_on_failure(new):
        home = _home(given)
        name = home.name if home is not None else given.parts[0].name
        armature = armatures.add_armature(context, home, given.frame, puppet, name=name, limits=limits)
        new.append(armature)
        context.view_layer.update()
        carriers: dict[int, Object] = {}
        for number, objects in enumerate(given.objects):
            carrier = puppet.fields[number]
            if carrier is not None and id(carrier) not in carriers:
                carriers[id(carrier)] = made = _carrier(context, objects[0], armature, given.frame, puppet, number)
                new += [made, *record.helpers_of(made, record.FIELD)]
            for obj in objects:
                field.release(obj)
                armatures.hang(obj, armature, "" if carrier else puppet.bones[draft.bone_of[number]].name)
                if carrier is not None:
                    field.follow(obj, carriers[id(carrier)], carriers[id(carrier)])
    if old is not None:
        _replace(old, armature)
    select(context, armature)
    return armature, puppet


def _home(given: Drawn) -> Collection | None:
    """The smallest collection that all drawings are in."""
    everyone = {obj for own in given.objects for obj in own}
    common = [home for home in bpy.data.collections if home.is_editable and everyone.issubset(home.all_objects)]
    return min(common, key=lambda home: len(home.all_objects), default=None)


@contextmanager
def at_rest(context: Context, objects: Sequence[Object], armature: Object | None) -> Iterator[None]:
    """Shows drawings as they were drawn, and if what follows fails as before; else the armature has been replaced."""
    if armature is None:
        with field.unposed(map(field.shown_by, objects)):
            yield
        return
    before, data = armature.data.pose_position, armature.data
    with field.unposed(map(field.shown_by, objects)):
        try:
            data.pose_position = "REST"
            context.view_layer.update()
            yield
        except BaseException:
            data.pose_position = before
            raise


def _carrier(
    context: Context, obj: Object, armature: Object, frame: Frame, puppet: core.puppet.Puppet, number: int
) -> Object:
    """A hidden mesh that bones bend, for a part and what rides on it, with its field."""
    bent = puppet.fields[number]
    assert bent is not None
    grid = bent.grid
    points = np.column_stack([grid.vertices, np.full(len(grid.vertices), frame.height)])
    name = puppet.draft.parts[number].name
    made, still = (
        bpy.data.objects.new(title, filling.new_mesh(title, points, faces=grid.triangles))
        for title in (f"{name} Bend", f"{name} Bend Field")
    )
    for new in (made, still):
        obj.users_collection[0].objects.link(new)
        new.matrix_world = armature.matrix_world
        new.parent, new.matrix_parent_inverse = armature, armature.matrix_world.inverted_safe()
        new.display_type = "WIRE"
        new.hide_viewport = new.hide_render = new.hide_select = True
        new[keys.PART] = name
    record.make_helper(still, record.FIELD, made)
    bones = puppet.bones[bent.first_bone : bent.first_bone + len(bent.bends) + 1]
    skin(made, armature, bones, bent.weights)
    context.view_layer.update()
    field.pose(made, made)
    return made


def _choices(armature: Object, draft: core.puppet.PuppetDraft, frame: Frame) -> Mapping[str, core.puppet.PartChoice]:
    """What was changed in the armature of an earlier puppet: on which parts others hang, and where they turn."""
    matrix = world_matrix(armature)
    first: dict[str, Any] = {}
    for bone in armature.data.bones:  # parents first
        first.setdefault(part_of(bone), bone)
    changed = {}
    for number, part in enumerate(draft.parts):
        bone, link = first.get(part.name), draft.links[number]
        if bone is None or link.hold is core.puppet.Hold.RIDES:
            continue
        above = part_of(bone.parent) if bone.parent is not None else None
        derived = draft.parts[link.parent].name if link.parent is not None else None
        head = frame.from_world((matrix @ np.append(bone.head_local, 1.0))[None, :3])[0][0]
        far = float(np.hypot(*(head - draft.bones[draft.bone_of[number]].head))) > MOVED * bone.length
        if above != derived or (far and above is not None):
            joint = (float(head[0]), float(head[1])) if above is not None and far else None
            changed[part.name] = core.puppet.PartChoice(parent=above or "", joint=joint)
    return changed


def _replace(old: Object, new: Object) -> None:
    """Puts an armature in the place of an earlier one: its name, pose, constraints and animation go on."""
    for posed in old.pose.bones:
        now: Any = new.pose.bones.get(posed.name)
        if now is not None:
            now.rotation_mode, now.matrix_basis = posed.rotation_mode, posed.matrix_basis
            for constraint in posed.constraints:
                if constraint.name != armatures.RANGE:
                    now.constraints.copy(constraint)
    new.matrix_basis, new.parent = old.matrix_basis, old.parent
    if old.parent is not None:
        new.matrix_parent_inverse = old.matrix_parent_inverse
    if old.animation_data is not None and old.animation_data.action is not None:
        data = new.animation_data_create()
        data.action = old.animation_data.action
        if hasattr(data, "action_slot"):
            data.action_slot = old.animation_data.action_slot
    name, data_name = old.name, old.data.name
    bones, gone = old.data, [child for child in old.children if part_of(child)]
    meshes = [child.data for child in gone]
    bpy.data.batch_remove([*gone, *meshes, old, bones])
    new.name, new.data.name = name, data_name
