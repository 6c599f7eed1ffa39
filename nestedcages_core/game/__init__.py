"""Puppets for game engines: meshes with textures and bones, written for Godot, Spine and DragonBones.

- `read_painting`: the painted parts of a layered file, a layered SVG or a folder of pictures; `picture_of`, one of a
  vector shape, and `painted_as_one`, of several.
- `game_puppet`: a `GamePuppet` from the painted parts; `meshed` from a draft of them.
- `write_puppet`: its files for one of the `ENGINES`; `puppet_files`: their contents.
- `Animation`: keys of its bones.
- `texture_of`, `certify`, `engine_weights`, `proved_ranges`: for meshes that were edited elsewhere.
- `to_puppet_json`, `from_puppet_json`: a puppet without its pictures; `repainted`: the puppet of a changed painting,
  with its bones, names and keys; `with_hand_weights`: weights that were painted by hand; `values_at`: at other places.
"""

from .animation import Animation
from .atlas import texture_of
from .engines import ENGINES, Engine, engine_for, puppet_files, undrawn, write_puppet
from .islands import certify, stored
from .kept import from_puppet_json, to_puppet_json
from .mesh import MOST_BONES, PartMesh, Placement, engine_weights
from .paintings import PAINTINGS, Painting, read_painting
from .proved import proved_ranges
from .puppet import HULL_VERTICES, GamePuppet, game_puppet, meshed
from .repainted import Changes, repainted, values_at, with_hand_weights
from .vector import LONGER_SIDE, painted_as_one, picture_of

__all__ = [
    "ENGINES",
    "HULL_VERTICES",
    "LONGER_SIDE",
    "MOST_BONES",
    "PAINTINGS",
    "Animation",
    "Changes",
    "Engine",
    "GamePuppet",
    "Painting",
    "PartMesh",
    "Placement",
    "certify",
    "engine_for",
    "engine_weights",
    "from_puppet_json",
    "game_puppet",
    "meshed",
    "painted_as_one",
    "picture_of",
    "proved_ranges",
    "puppet_files",
    "read_painting",
    "repainted",
    "stored",
    "texture_of",
    "to_puppet_json",
    "undrawn",
    "values_at",
    "with_hand_weights",
    "write_puppet",
]
