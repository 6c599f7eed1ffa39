"""Puppets for game engines: meshes with textures and bones, written for Godot, Spine and DragonBones.

- `game_puppet`: a `GamePuppet` from the painted parts of a picture; `meshed` from a puppet that was drafted before.
- `write_puppet`: its files for one of the `ENGINES`.
- `Animation`: keys of its bones.
- `to_puppet_json`, `from_puppet_json`: a puppet without its pictures; `repainted`: the puppet of a changed painting,
  with its bones, names and keys; `with_hand_weights`: weights that were painted by hand.
"""

from .animation import Animation
from .engines import ENGINES, Engine, engine_for, undrawn, write_puppet
from .kept import from_puppet_json, to_puppet_json
from .mesh import PartMesh, Placement
from .puppet import HULL_VERTICES, GamePuppet, game_puppet, meshed
from .repainted import Changes, repainted, with_hand_weights

__all__ = [
    "ENGINES",
    "HULL_VERTICES",
    "Animation",
    "Changes",
    "Engine",
    "GamePuppet",
    "PartMesh",
    "Placement",
    "engine_for",
    "from_puppet_json",
    "game_puppet",
    "meshed",
    "repainted",
    "to_puppet_json",
    "undrawn",
    "with_hand_weights",
    "write_puppet",
]
