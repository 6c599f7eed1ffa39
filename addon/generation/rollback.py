"""Rollback: earlier output is restored if new output cannot be finished."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import bpy
from bpy.types import Collection, Object, Scene

from .. import keys, record
from ..animation import shape_keys
from ..animation.visibility import VISIBILITY, VisibilityAnimation, detach
from ..rigging.pose import Placement
from ..rigging.rig import hooks_of
from ..scene import display
from ..scene.filling import mesh_of
from ..scene.ownership import members


class Rollback:
    """The state of the scene's range and of the outputs that are included, to be restored or discarded.

    ``surplus``: objects that go at the end; ``kept``: those that leave the output but stay in the scene.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._range = (scene.frame_start, scene.frame_end, _properties(scene), record.range_of(scene))
        self._markers = [(m.name, m.frame, m.select, m.camera) for m in scene.timeline_markers]
        self._collections: list[tuple[Collection, str, dict[str, Any], dict[str, Any]]] = []
        self._members: dict[Object, _Member] = {}
        self._by_vertices = [obj for obj in bpy.data.objects if "VERTEX" in obj.parent_type]
        self._known = set(_everything())
        self._names: list[tuple[bpy.types.ID, str]] = []
        self.surplus: list[Object] = []
        self.kept: list[Object] = []
        self._lost: list[str] = []

    def include(self, collection: Collection) -> None:
        """Notes an output before it is changed."""
        state = _properties(collection), record.values(record.of(collection))
        self._collections.append((collection, collection.name, *state))
        for obj in members(collection):
            self._members[obj] = _Member(obj, [child for child in self._by_vertices if child.parent == obj])

    def set_aside(self, obj: Object) -> None:
        """Removes our animation from an object, and frees the names of its mesh, which is about to be replaced."""
        for mesh in (obj.data, record.before(obj).mesh):
            shapes = mesh.shape_keys if mesh is not None else None
            for block in (mesh, shapes, shape_keys.action_of(shapes) if shape_keys.has_steps(shapes) else None):
                self._rename(block)
        visibility = detach(obj)
        if visibility.kept and visibility.slot is not None and visibility.action.users > 1:
            shape_keys.own_action(obj, obj.name)
        elif visibility.action is not None and not visibility.kept:
            self._rename(visibility.action)
        self._members[obj].visibility = visibility

    def lose(self, obj: Object, what: Iterable[str]) -> None:
        """Notes what could not be transferred to the new mesh of an object."""
        self._lost += [f"'{obj.name}': {part} could not be kept" for part in what]

    def finish(self) -> tuple[list[str], Iterator[None]]:
        """The new output is complete: removes objects that left it. Returns sentences about what was lost, and the
        removal of what else was replaced.
        """
        stored = [record.before(obj).mesh for obj in (*self.surplus, *self.kept)]
        for obj in self.kept:
            shape_keys.remove_steps(obj)
            for modifier in [modifier for modifier in obj.modifiers if display.is_ours(modifier)]:
                display.remove_modifier(obj, modifier)
            record.remove(obj)
            self._lost.append(f"'{obj.name}' is no longer a level; it was kept for your work on it")
        actions = [member.visibility.action for member in self._members.values() if member.visibility is not None]
        meshes = [member.mesh for member in self._members.values()]
        rest = shape_keys.discarding(self.surplus, [*meshes, *filter(None, stored)], actions)
        next(rest)
        return self._lost, rest

    def restore(self) -> None:
        """The new output failed: restores everything."""
        for member in self._members.values():
            member.restore()
        bpy.data.batch_remove([block for block in _everything() if block not in self._known])
        for block, name in reversed(self._names):
            block.name = name
        for member in self._members.values():
            member.obj.name = member.name
        for collection, name, properties, values in self._collections:
            collection.name = name
            _set_properties(collection, properties)
            record.assign(record.of(collection), values)
        scene = self._scene
        scene.frame_start, scene.frame_end, properties, before = self._range
        record.set_range(scene, before)
        _set_properties(scene, properties)
        if [(m.name, m.frame, m.select, m.camera) for m in scene.timeline_markers] != self._markers:
            scene.timeline_markers.clear()
            for name, frame, select, camera in self._markers:
                marker = scene.timeline_markers.new(name, frame=frame)
                marker.select, marker.camera = select, camera

    def _rename(self, block: bpy.types.ID | None) -> None:
        """Frees the name of a data-block for the one that replaces it."""
        if block is not None:
            self._names.append((block, block.name))
            block.name = f"{keys.PREFIX}{len(self._names)}"


@dataclass(eq=False)
class _Member:
    """An object of earlier output as it was."""

    obj: Object
    by_vertices: Iterable[Object]

    def __post_init__(self) -> None:
        obj = self.obj
        self.name, self.mesh = obj.name, mesh_of(obj)
        self.placement, self.slots = Placement.of(obj), [(slot.link, slot.material) for slot in obj.material_slots]
        self.hooks = [(hook, tuple(hook.vertex_indices)) for hook in hooks_of(obj)]
        self.children = [(child, tuple(child.parent_vertices)) for child in self.by_vertices]
        self.visibility_values = {name: getattr(obj, name) for name in VISIBILITY}
        self.properties, self.values = _properties(obj), record.values(record.member(obj))
        self.thickness = {name: display.thickness_of(obj, name) for name in display.THICKNESSES}
        self.visibility: VisibilityAnimation | None = None

    def restore(self) -> None:
        obj = self.obj
        obj.data = self.mesh
        self.placement.give(obj)
        for name, value in self.visibility_values.items():
            setattr(obj, name, value)
        for slot, (link, material) in zip(obj.material_slots, self.slots, strict=True):
            if link == "OBJECT":
                slot.link, slot.material = link, material
        for hook, indices in self.hooks:
            hook.vertex_indices_set(indices)
        for child, indices in self.children:
            child.parent_vertices = indices
        if self.visibility is not None:
            self.visibility.restore(obj)
        for name, thickness in self.thickness.items():
            if thickness or not any(self.thickness.values()):
                display.set_thickness(obj, thickness, name)
        _set_properties(obj, self.properties)
        record.assign(record.member(obj), self.values)


def _everything() -> Iterator[bpy.types.ID]:
    """All data-blocks of the types that are written."""
    data = bpy.data
    for kind in (data.collections, data.objects, data.meshes, data.actions, data.node_groups, data.materials):
        yield from kind


def _properties(owner: bpy.types.ID) -> dict[str, Any]:
    """Our custom properties of a data-block."""
    return {key: _plain(owner[key]) for key in _custom(owner)}


def _custom(owner: bpy.types.ID) -> list[str]:
    """Our custom properties without registered groups, which Blender before 5.0 lists among them."""
    return [key for key in keys.ours(owner) if key not in owner.bl_rna.properties]


def _set_properties(owner: bpy.types.ID, properties: dict[str, Any]) -> None:
    keys.remove(owner, [key for key in _custom(owner) if key not in properties])
    keys.store(owner, properties)


def _plain(value: Any) -> Any:
    """A value; arrays, which would change with their owner, as copies."""
    if hasattr(value, "to_dict"):
        return dict(value)
    return value if isinstance(value, str | bpy.types.ID) or not hasattr(value, "__len__") else list(value)
