"""Puppets: layered drawings whose parts hang together by joints and move by themselves, in Blender and in engines.

The core works without this package; nothing of the method and of the formats imports it.

- `layers`: `read_painting`, the painted parts of PSD, OpenRaster, Krita, SVG and folders; `puppet_parts`, the
  outlines of an SVG; `picture_of`, a picture of a vector shape, and `painted_as_one`, of several.
- `draft`: `draft_puppet`, which `PuppetPart` hangs on which; `PuppetDraft`, parts, links and bones; `PartChoice`,
  what a user decides about a part.
- `skeleton`: `Bone`; `suggest_bones`, a skeleton along the limbs of one shape; `with_joints`, a cage with vertices
  where they bend.
- `field`: the `BendField` of a part that bends, weights, `PreserveVolume` and `Linear` to blend bones, and the proved
  `JointRange` of each joint.
- `puppet_of`: the `Puppet` of a draft; `walk`: a `Clip` for any that has legs; `Character`: a drawing that a cage
  moves.
- `engines`: `game_puppet`, a `GamePuppet` of textured meshes from painted parts; `write_puppet`, its files.
"""

from .caps import Cap
from .character import Character
from .draft.draft import PuppetDraft, draft_puppet
from .draft.links import Hold, Link, PartChoice
from .draft.sides import Side
from .engines.animation import Animation
from .engines.atlas import texture_of
from .engines.engines import ENGINES, Engine, engine_for, puppet_files, undrawn, write_puppet
from .engines.hulls import certify, stored
from .engines.proved import proved_ranges
from .engines.puppet import HULL_VERTICES, GamePuppet, game_puppet, meshed, puppet_parts_of
from .engines.textured_mesh import MOST_BONES, PartMesh, Placement, engine_weights
from .field.bone_weights import bone_weights, skinned
from .field.mesh import BendField
from .field.ranges import JointRange
from .field.skinning import Linear, PreserveVolume, Skin
from .layers.drawing import LONGER_SIDE, painted_as_one, picture_of
from .layers.drawn_parts import puppet_parts
from .layers.painting import PicturePart
from .layers.reading import PAINTINGS, Painting, read_painting
from .limbs import Figure, Limbs
from .part import PuppetPart
from .puppet import Puppet, puppet_of, reweighted
from .skeleton.bone import Bone, with_joints
from .skeleton.skeleton import Skeleton, suggest_bones
from .walk import Clip, walk

__all__ = [
    "ENGINES",
    "HULL_VERTICES",
    "LONGER_SIDE",
    "MOST_BONES",
    "PAINTINGS",
    "Animation",
    "BendField",
    "Bone",
    "Cap",
    "Character",
    "Clip",
    "Engine",
    "Figure",
    "GamePuppet",
    "Hold",
    "JointRange",
    "Limbs",
    "Linear",
    "Link",
    "Painting",
    "PartChoice",
    "PartMesh",
    "PicturePart",
    "Placement",
    "PreserveVolume",
    "Puppet",
    "PuppetDraft",
    "PuppetPart",
    "Side",
    "Skeleton",
    "Skin",
    "bone_weights",
    "certify",
    "draft_puppet",
    "engine_for",
    "engine_weights",
    "game_puppet",
    "meshed",
    "painted_as_one",
    "picture_of",
    "proved_ranges",
    "puppet_files",
    "puppet_of",
    "puppet_parts",
    "puppet_parts_of",
    "read_painting",
    "reweighted",
    "skinned",
    "stored",
    "suggest_bones",
    "texture_of",
    "undrawn",
    "walk",
    "with_joints",
    "write_puppet",
]
