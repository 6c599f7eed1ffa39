"""Armatures of puppets, of vector drawings and of layered paintings alike: bones marked with the parts that they move,
and limited to what is proved of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import radians
from typing import Any

from bpy.types import Collection, Context, Object
from mathutils import Matrix

from .. import keys
from ..characters import add_bones
from ..core import core
from ..scene.areas import paints
from ..scene.plane import Frame

# Name of the constraint with the proved range of a bone.
RANGE = "Proved Range"
# Colour of the bones of parts that may hang on another one.
DOUBTFUL = "THEME01"


def add_armature(
    context: Context, home: Collection | None, frame: Frame, puppet: core.puppet.Puppet, *, name: str, limits: bool
) -> Object:
    """The armature of a puppet, whose coordinates are those of the frame, selected and active.

    limits: whether bones are limited to their proved ranges.
    """
    armature = add_bones(context, home, frame, puppet.bones, name=f"{name} Puppet")
    armature.data.name, armature.data.display_type = name, "STICK"
    draft, doubtful = puppet.draft, set(puppet.draft.doubtful)
    for bone, owner, proved in zip(puppet.bones, draft.part_of, puppet.ranges, strict=True):
        made: Any = armature.data.bones[bone.name]
        made[keys.PART], made[keys.PROVED] = draft.parts[owner].name, [proved.low, proved.high]
        if draft.parts[owner].name in doubtful:
            made.color.palette = DOUBTFUL
        posed: Any = armature.pose.bones[bone.name]
        posed.rotation_mode = "XYZ"
        if limits and proved != core.puppet.JointRange():
            limit: Any = posed.constraints.new("LIMIT_ROTATION")
            limit.name, limit.owner_space, limit.use_limit_z = RANGE, "LOCAL", True
            limit.min_z, limit.max_z = radians(proved.low), radians(proved.high)
            limit.use_transform_limit = True
    return armature


def part_of(block: Any) -> str:
    """The name of the part that a bone or a hidden mesh of a puppet was made for; empty for others."""
    return str(block.get(keys.PART, ""))


def is_puppet(obj: Object) -> bool:
    """Whether an object is the armature of a puppet."""
    return obj.type == "ARMATURE" and any(map(part_of, obj.data.bones))


def puppet_of(objects: Sequence[Object]) -> Object | None:
    """The armature of the puppet that the first of some objects is or belongs to; None if there is none."""
    armatures = (obj if obj.type == "ARMATURE" else obj.parent for obj in objects)
    return next((each for each in armatures if each is not None and is_puppet(each)), None)


def drawings_of(armature: Object) -> list[Object]:
    """The drawings that a puppet moves."""
    return [child for child in armature.children if not part_of(child) and paints(child)]


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
