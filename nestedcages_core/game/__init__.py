"""Puppets for game engines: meshes with textures and bones, written for Godot and Spine.

- `read_painting`: the painted parts of a layered file, a layered SVG or a folder of pictures; `picture_of`, one of a
  vector shape, and `painted_as_one`, of several.
- `game_puppet`: a `GamePuppet` from the painted parts; `meshed` from a draft of them.
- `write_puppet`: its files for one of the `ENGINES`; `puppet_files`: their contents.
- `Animation`: keys of its bones.
- `texture_of`, `certify`, `engine_weights`, `proved_ranges`: for meshes that were edited elsewhere.
"""

from .animation import Animation
from .atlas import texture_of
from .engines import ENGINES, Engine, engine_for, puppet_files, undrawn, write_puppet
from .islands import certify, stored
from .mesh import MOST_BONES, PartMesh, Placement, engine_weights
from .paintings import PAINTINGS, Painting, read_painting
from .proved import proved_ranges
from .puppet import HULL_VERTICES, GamePuppet, game_puppet, meshed, puppet_parts_of
from .vector import LONGER_SIDE, painted_as_one, picture_of

__all__ = [
    "ENGINES",
    "HULL_VERTICES",
    "LONGER_SIDE",
    "MOST_BONES",
    "PAINTINGS",
    "Animation",
    "Engine",
    "GamePuppet",
    "Painting",
    "PartMesh",
    "Placement",
    "certify",
    "engine_for",
    "engine_weights",
    "game_puppet",
    "meshed",
    "painted_as_one",
    "picture_of",
    "proved_ranges",
    "puppet_files",
    "puppet_parts_of",
    "read_painting",
    "stored",
    "texture_of",
    "undrawn",
    "write_puppet",
]
