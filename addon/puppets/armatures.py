"""Armatures of puppets, of vector drawings and of layered paintings alike: bones marked with the parts that they move,
limited to what is proved of them. An armature is the draft: made again, it is drawn as it is changed now, and what
is not ours in it stays.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from math import radians
from typing import Any

import bpy
import numpy as np
from bpy.types import Collection, Context, Object
from mathutils import Matrix

from .. import keys
from ..bind import field
from ..blender import mesh_data
from ..cage_sets.selection import select
from ..core import core
from ..drawing.painted import paints
from ..drawing.plane import Frame, scale_of, world_matrix
from ..errors import FloatArray
from .one_cage import add_bones

# What Blender adds to a name that another block has.
COUNTED = re.compile(r"\.\d{3}$")
# Bones shorter than this fraction of what they were have been subdivided.
SUBDIVIDED = 0.95
# Name of the constraint with the proved range of a bone.
RANGE = "Proved Range"
# Colours of the bones of parts that may hang on another one, and of others.
DOUBTFUL, CERTAIN = "THEME01", "DEFAULT"
# A joint stays where it is if it lies on its part or at most so far off it, in lengths of its bone.
OFF_PART = 0.25


def part_of(block: Any) -> str:
    """The name of the part that a bone or a hidden mesh of a puppet was made for; empty for others."""
    return str(block.get(keys.PART, "")) if block is not None else ""


def owner_of(bone: Any) -> Any:
    """The nearest bone of a part from a bone towards the root, itself included; None if there is none."""
    while bone is not None and not part_of(bone):
        bone = bone.parent
    return bone


def is_puppet(obj: Object) -> bool:
    """Whether an object is the armature of a puppet."""
    return obj.type == "ARMATURE" and any(map(part_of, obj.data.bones))


def puppet_of(objects: Sequence[Object]) -> Object | None:
    """The armature of the puppet that the first of some objects is or belongs to; None if there is none."""
    armatures = (obj if obj.type == "ARMATURE" else obj.parent for obj in objects)
    return next((each for each in armatures if each is not None and is_puppet(each)), None)


def drawings_of(armature: Object) -> list[Object]:
    """The drawings that a puppet moves."""
    drawings = [child for child in armature.children if not part_of(child) and not is_cap(child)]
    return [obj for obj in drawings if paints(obj) or field.shown_by(obj) != obj]


def is_cap(obj: Object) -> bool:
    """Whether an object is a cap, which keeps a joint painted."""
    return bool(obj.get(keys.CAP))


def carried_by(obj: Object, armature: Object) -> str:
    """The name of the part whose bone or hidden mesh moves a drawing; empty if none does."""
    if obj.parent != armature:
        return ""
    if obj.parent_type == "BONE":
        return part_of(armature.data.bones.get(obj.parent_bone))
    if is_skinned(obj):
        weights = mesh_data.weights_of(mesh_data.mesh_of(obj), len(obj.vertex_groups))
        strongest = obj.vertex_groups[int(np.nansum(weights, axis=1).argmax())]
        return part_of(armature.data.bones.get(strongest.name))
    return part_of(field.followed(obj))


def is_skinned(obj: Object) -> bool:
    """Whether bones bend a drawing itself, by weights of its own, as paintings."""
    return any(isinstance(each, bpy.types.ArmatureModifier) and each.object == obj.parent for each in obj.modifiers)


def frame_of(armature: Object) -> Frame:
    """The plane of a puppet."""
    height = next(bone.head_local.z for bone in armature.data.bones if part_of(bone))
    return Frame(world_matrix(armature), height, scale_of(armature), own=True)


def bones_at_rest(bones: Iterable[Any], unit: float = 1.0) -> tuple[core.Bone, ...]:
    """Bones of an armature at rest, in units of a length; the parent of each is the nearest of them above it."""
    number: dict[str, int] = {}
    found = []
    for bone in bones:
        above = bone.parent
        while above is not None and above.name not in number:
            above = above.parent
        head, tail = ((end.x / unit, end.y / unit) for end in (bone.head_local, bone.tail_local))
        found.append(core.Bone(head, tail, number[above.name] if above is not None else None, bone.name))
        number[bone.name] = len(number)
    return tuple(found)


def figure_of(armature: Object) -> core.puppets.Figure:
    """What clips need of a puppet, as its bones are now."""
    own, limbs = [bone for bone in armature.data.bones if part_of(bone)], dict[str, list[str]]()
    for bone in own:
        limbs.setdefault(bone.get(keys.LIMB, ""), []).append(bone.name)
    kinds: dict[str, list[tuple[str, ...]]] = {kind: [] for kind in core.puppets.Limbs._fields}
    for name, chain in sorted(limbs.items()):
        if name:
            kinds[name.split()[0]].append(tuple(chain))
    ranges = tuple(core.puppets.JointRange(*bone[keys.PROVED]) for bone in own)
    found = core.puppets.Limbs(**{kind: tuple(chains) for kind, chains in kinds.items()})
    return core.puppets.Figure(bones_at_rest(own), ranges, found, float(armature.data.get(keys.AHEAD, 1.0)))


def choices_in(
    armature: Object,
    parts: Sequence[core.puppets.PuppetPart],
    drawings: Mapping[str, Object],
    in_parts: Callable[[FloatArray], FloatArray],
) -> dict[str, core.puppets.PartChoice]:
    """What an armature says of parts: on which others they hang, where they turn and by how many bones they bend.

    drawings: one of each part that the armature moves, by its name; in_parts: takes points (n, 3) of the armature to
    the parts' coordinates.
    """
    known = {part.name: part for part in parts}
    choices: dict[str, core.puppets.PartChoice] = {}
    chains = chains_of(armature.data.bones)
    for name, obj in drawings.items():
        host = carried_by(obj, armature) if name in known and name not in chains else ""
        if host in known and obj.get(keys.DRAWN, name) == name:  # a copy of a part hangs where it lies now
            choices[name] = core.puppets.PartChoice(parent=host, hold=core.puppets.Hold.RIDES)
    for name, chain in chains.items():
        if name not in known:
            continue
        ends = np.array([*(bone.head_local for bone in chain), chain[-1].tail_local])
        places = tuple((float(x), float(y)) for x, y in in_parts(ends))
        stays = known[name].distance(places[0]) <= OFF_PART * chain[0].length
        inside = all(known[name].distance(place) == 0.0 for place in places[1:-1])
        here = core.puppets.PartChoice(bones=len(chain), chain=places if stays and inside else None)
        if any(owner_of(bone.parent) != before for before, bone in pairwise(chain)):
            here = core.puppets.PartChoice()  # it forks
        above = first = owner_of(chain[0].parent)
        while above is not None and part_of(above) not in known:
            above = owner_of(above.parent)
        joint = places[0] if stays else None
        if first is None:
            choices[name] = replace(here, parent="")
        elif above is None:  # all that it hung on is gone
            choices[name] = replace(here, joint=joint)
        else:
            choices[name] = replace(here, parent=part_of(above), joint=joint, hold=core.puppets.Hold.JOINT)
    return choices


def mark_subdivided(armature: Object) -> None:
    """Marks bones that come from bones of parts subdivided by hand, of which Blender forgets what they are for."""
    for bone in [each for each in armature.data.bones if part_of(each)]:
        whole = bone.get(keys.LENGTH, 0.0)
        length, last = bone.length, bone
        while length < SUBDIVIDED * whole:
            alike = (each for each in last.children if COUNTED.sub("", each.name) == COUNTED.sub("", bone.name))
            last = next((each for each in alike if each.use_connect and not part_of(each)), None)
            if last is None:
                break
            length += last.length
            last[keys.PART] = part_of(bone)
            armature.pose.bones[last.name].rotation_mode = "XYZ"


def chains_of(bones: Any) -> dict[str, list[Any]]:
    """The bones of each part, from its joint to its tip."""
    found: dict[str, list[Any]] = {}
    for bone in bones:  # parents first
        if part_of(bone):
            found.setdefault(part_of(bone), []).append(bone)
    return found


def add_armature(context: Context, home: Collection | None, frame: Frame, name: str) -> Object:
    """A new armature without bones, in the plane of a drawing."""
    made = add_bones(context, home, frame, (), name=f"{name} Puppet")
    made.data.name, made.data.display_type = name, "STICK"
    return made


def hang_as(armature: Object, objects: Sequence[Object]) -> None:
    """Makes what all of some objects have as their parent that of a new armature, which stays where it is."""
    parent, kind = objects[0].parent, objects[0].parent_type
    if (
        parent is not None
        and kind == "OBJECT"
        and all((obj.parent, obj.parent_type) == (parent, kind) for obj in objects)
    ):
        armature.parent = parent
        armature.matrix_parent_inverse = parent.matrix_world.inverted_safe()


def parents_of(
    parts: Sequence[core.puppets.PuppetPart], drawings: Sequence[Sequence[Object]]
) -> dict[str, core.puppets.PartChoice]:
    """On which others parts hang by the parents of their drawings; nothing if these all have the same one.

    drawings: those of each part.
    """
    owner: dict[Object | None, str] = {obj: part.name for part, own in zip(parts, drawings, strict=True) for obj in own}
    above = {part.name: owner.get(own[0].parent, part.name) for part, own in zip(parts, drawings, strict=True)}
    above = {name: parent for name, parent in above.items() if parent != name}
    if len({*above.values()}) < 2:
        return {}
    return {name: core.puppets.PartChoice(parent=parent) for name, parent in above.items()}


def draw_bones(
    context: Context,
    armature: Object,
    frame: Frame,
    puppet: core.puppets.Puppet,
    limits: Sequence[core.puppets.JointRange],
) -> core.puppets.Puppet:
    """Draws the bones of a puppet into an armature in its frame; those that its parts have keep names and poses, and
    bones of others stay. Returns the puppet with the names that they have.

    limits: the range that each bone is limited to; none for no limits.
    """
    owners = [puppet.draft.parts[owner].name for owner in puppet.draft.part_of]
    select(context, armature)
    bpy.ops.object.mode_set(mode="EDIT")
    bones = armature.data.edit_bones
    known = chains_of(bones)
    for bone in bones:
        bone.use_connect = False
    drawn, fresh = list[Any](), list[Any]()
    for bone, part in zip(puppet.bones, owners, strict=True):
        chain = known.get(part, [])
        there = chain.pop(0) if chain else bones.new(bone.name)
        fresh += [] if part_of(there) else [there]
        there.head, there.tail = (*bone.head, frame.height), (*bone.tail, frame.height)
        there[keys.PART] = part
        drawn.append(there)
    for bone, there in zip(puppet.bones, drawn, strict=True):
        wanted: Any = drawn[bone.parent] if bone.parent is not None else None
        if owner_of(there.parent) != wanted:
            there.parent = wanted
        there.use_connect = wanted is not None and there.parent == wanted and there.head == wanted.tail
    for gone in (bone for chain in known.values() for bone in chain):
        for child in gone.children:
            child.parent = gone.parent
        bones.remove(gone)
    names, new = [str(bone.name) for bone in drawn], {bone.name for bone in fresh}
    bpy.ops.object.mode_set(mode="OBJECT")
    named = tuple(replace(bone, name=name) for bone, name in zip(puppet.bones, names, strict=True))
    puppet = replace(puppet, draft=replace(puppet.draft, bones=named))
    _mark(armature, puppet)
    allowed = limits or [core.puppets.JointRange()] * len(names)
    for name, limit in zip(names, allowed, strict=True):
        posed: Any = armature.pose.bones[name]
        posed.rotation_mode = "XYZ" if name in new else posed.rotation_mode
        _limit(posed, limit)
    return puppet


def _mark(armature: Object, puppet: core.puppets.Puppet) -> None:
    """Notes what the bones are for and what is proved of them, and colours those in doubt."""
    figure, doubtful = puppet.figure, set(puppet.draft.doubtful)
    data: Any = armature.data
    data[keys.AHEAD] = figure.ahead
    for bone, proved in zip(figure.bones, figure.ranges, strict=True):
        made: Any = data.bones[bone.name]
        made[keys.PROVED] = [proved.low, proved.high, proved.simple_low, proved.simple_high]
        made[keys.LIMB], made[keys.LENGTH] = "", made.length
        if part_of(made) in doubtful or made.color.palette == DOUBTFUL:
            made.color.palette = DOUBTFUL if part_of(made) in doubtful else CERTAIN
    for kind, limbs in figure.limbs._asdict().items():
        for number, chain in enumerate(limbs):
            for name in chain:
                data.bones[name][keys.LIMB] = f"{kind} {number:03}"


def _limit(posed: Any, allowed: core.puppets.JointRange) -> None:
    """Limits the turn of a bone to a range, or no longer."""
    limit = posed.constraints.get(RANGE)
    if allowed == core.puppets.JointRange():
        if limit is not None:
            posed.constraints.remove(limit)
        return
    limit = limit or posed.constraints.new("LIMIT_ROTATION")
    limit.name, limit.owner_space, limit.use_limit_z = RANGE, "LOCAL", True
    limit.min_z, limit.max_z = radians(allowed.low), radians(allowed.high)
    limit.use_transform_limit = True


def hang(obj: Object, armature: Object, bone: str = "") -> None:
    """Makes a bone move an object, or the armature as a whole. The object's own transform and keys stay."""
    above = obj.matrix_world @ obj.matrix_basis.inverted_safe()
    there = armature.matrix_world
    obj.parent, obj.parent_type = armature, "BONE" if bone else "OBJECT"
    if bone:
        posed: Any = armature.pose.bones[bone]
        obj.parent_bone = bone
        there = there @ posed.matrix @ Matrix.Translation((0.0, posed.bone.length, 0.0))
    obj.matrix_parent_inverse = there.inverted_safe() @ above
