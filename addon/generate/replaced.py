"""What new cages replace, removed when they are complete."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
from bpy.types import Mesh, Object

from .. import cage_sets, keys
from ..animation.visibility import detach
from ..blender import display, shape_keys
from ..blender.mesh_data import mesh_of
from ..transfer.rig import is_rigged


class Replaced:
    """Meshes and actions of earlier output. ``surplus``: objects that go at the end; ``kept``: those that leave the
    output but stay in the scene; ``lost``: sentences on the artist's work that could not be transferred.
    """

    def __init__(self) -> None:
        self.surplus: list[Object] = []
        self.kept: list[Object] = []
        self.lost: list[str] = []
        self._meshes: list[Mesh] = []
        self._actions: list[bpy.types.Action | None] = []

    def set_aside(self, obj: Object) -> None:
        """Removes our animation from an object, and frees the names of its mesh, which is about to be replaced."""
        self._meshes.append(mesh_of(obj))
        for mesh in (obj.data, cage_sets.before(obj).mesh):
            shapes = mesh.shape_keys if mesh is not None else None
            for block in (mesh, shapes, shape_keys.action_of(shapes) if shape_keys.has_steps(shapes) else None):
                _free_name(block)
        hiding, own = detach(obj), shape_keys.action_of(obj)
        if own is not None and getattr(obj.animation_data, "action_slot", None) is not None and own.users > 1:
            shape_keys.own_action(obj, obj.name)
        _free_name(hiding)
        self._actions.append(hiding)

    def leave(self, obj: Object) -> None:
        """Lets an object go that is no longer a level, with its field and lines; it stays if an artist worked on it."""
        (self.kept if is_rigged(obj) else self.surplus).append(obj)
        helpers = cage_sets.helpers_of(obj, cage_sets.FIELD, cage_sets.LINES)
        self._meshes += map(mesh_of, helpers)
        self.surplus += helpers

    def lose(self, obj: Object, what: Iterable[str]) -> None:
        """Notes what could not be transferred to the new mesh of an object."""
        self.lost += [f"'{obj.name}': {part} could not be kept" for part in what]

    def remove(self) -> None:
        """Removes it all, in one pass over the file for each type: one by one, each removal takes a pass."""
        before = [cage_sets.before(obj).mesh for obj in (*self.surplus, *self.kept)]
        for obj in self.kept:
            shape_keys.remove_steps(obj)
            for modifier in [modifier for modifier in obj.modifiers if display.is_ours(modifier)]:
                display.remove_modifier(obj, modifier)
            cage_sets.remove(obj)
            self.lost.append(f"'{obj.name}' is no longer a level; it was kept for your work on it")
        shape_keys.discard(self.surplus, [*self._meshes, *filter(None, before)], self._actions)


def _free_name(block: bpy.types.ID | None) -> None:
    """Frees the name of a data-block for the one that replaces it."""
    if block is not None:
        block.name = f"{keys.PREFIX}replaced"
