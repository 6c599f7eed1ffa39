"""Node groups and materials that come with the add-on: appended to a file when first used, so that it works without the
add-on from then on. `packaging/node_groups.py` builds them.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

FILE = Path(__file__).with_name("nodes.blend")
WEIGHTED, SAME, FOLLOW = "Nested Cages Field", "Nested Cages Plain Field", "Nested Cages Follow Field"
EDGES, FILL, THICKNESS = "Nested Cages Follow as Edges", "Nested Cages Fill", "Nested Cages Thickness"
FLAT, CUTOUT = "Nested Cages Flat", "Nested Cages Cutout"


def group(name: str) -> bpy.types.NodeTree:
    """The node group of that name; the file has one."""
    found: bpy.types.NodeTree = bpy.data.node_groups.get(name) or _appended("node_groups", name)
    return found


def remove_unused() -> None:
    """Removes the node groups of bindings that nothing uses."""
    ours = (WEIGHTED, SAME, FOLLOW, EDGES)
    bpy.data.batch_remove([tree for tree in bpy.data.node_groups if tree.name in ours and not tree.users])


def material(kind: str, name: str) -> bpy.types.Material:
    """A new material of a kind, `FLAT` or `CUTOUT`."""
    made: bpy.types.Material = (bpy.data.materials.get(kind) or _appended("materials", kind)).copy()
    made.name = name
    return made


def _appended(kind: str, name: str) -> Any:
    libraries: Any = bpy.data.libraries
    before = set(libraries)
    with libraries.load(str(FILE), link=False) as (_, here):
        getattr(here, kind).append(name)
    (found,) = getattr(here, kind)
    found.use_fake_user = False
    for library in set(libraries) - before:
        libraries.remove(library)  # what was appended is local
    return found
