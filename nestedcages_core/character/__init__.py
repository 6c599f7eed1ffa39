"""Bones that move a cage: suggested along the limbs of a shape, with weights computed inside it.

- `Bone`, `suggest_bones`: a skeleton along the limbs, to be edited or taken.
- `with_joints`: a cage with vertices where limbs bend.
- `bone_weights`: how much each bone moves each vertex of a cage; `skinned`: the vertices under a pose of the bones,
  blended with `PreserveVolume` or `Linear`.
- `Field`, `field_of`: the weights of a mesh that carries the motion of a cage to anything in it. `folded`: where a pose
  lays it on itself; `holding`: where a shape is in it.
- `Character`: a drawing with its cage, bones and all weights, to be posed.
"""

from .bones import Bone, with_joints
from .character import Character
from .field import Field, field_of, folded, holding
from .skeleton import Skeleton, suggest_bones
from .skins import Linear, PreserveVolume, Skin
from .weights import bone_weights, skinned

__all__ = [
    "Bone",
    "Character",
    "Field",
    "Linear",
    "PreserveVolume",
    "Skeleton",
    "Skin",
    "bone_weights",
    "field_of",
    "folded",
    "holding",
    "skinned",
    "suggest_bones",
    "with_joints",
]
