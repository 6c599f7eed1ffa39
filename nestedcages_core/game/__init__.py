"""Puppets for game engines: meshes with textures and bones, written for Godot, Spine and DragonBones.

- `game_puppet`: a `GamePuppet` from the painted parts of a picture; `meshed` from a puppet that was drafted before.
- `write_puppet`: its files for one of the `ENGINES`.
- `Animation`: keys of its bones.
"""

from .animation import Animation
from .engines import ENGINES, Engine, engine_for, undrawn, write_puppet
from .mesh import PartMesh, Placement
from .puppet import HULL_VERTICES, GamePuppet, game_puppet, meshed

__all__ = [
    "ENGINES",
    "HULL_VERTICES",
    "Animation",
    "Engine",
    "GamePuppet",
    "PartMesh",
    "Placement",
    "engine_for",
    "game_puppet",
    "meshed",
    "undrawn",
    "write_puppet",
]
