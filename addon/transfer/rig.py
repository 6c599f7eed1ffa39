"""The artist's work on an object's mesh, read before the mesh is replaced and transferred to the new one.

The object itself stays, with its modifiers, parents, constraints, drivers, animation and custom properties. The data in
the mesh is transferred: vertex groups and weights, shape keys with drivers and animation, point attributes, materials,
custom properties; and so are vertex indices in hooks and vertex parents.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from bpy.types import Mesh, Object
from numpy.typing import NDArray

from .. import cage_sets, keys
from ..blender import display, shape_keys
from ..blender.mesh_data import loop_edges, mesh_of, points_of, stored, weights_of
from ..drawing import placement
from ..errors import FloatArray
from .outline_map import Outline, OutlineMap, outline_map

# Point attributes that can be interpolated: Blender's type, and numbers per value.
WIDTHS = {"FLOAT": 1, "FLOAT2": 2, "FLOAT_VECTOR": 3, "FLOAT_COLOR": 4, "BYTE_COLOR": 4}
PROPERTY_OF = {"FLOAT": "value", "FLOAT2": "vector", "FLOAT_VECTOR": "vector"}
# Blender's own attributes, which the new mesh has too.
BUILT_IN = ("position", "material_index", "sharp_face", "sharp_edge", "shade_smooth")
# The properties of a shape key other than its points.
KEY_VALUES = ("slider_min", "slider_max", "value", "mute", "vertex_group", "interpolation", "lock_shape")


@dataclass(frozen=True)
class Group:
    """A vertex group: weights (n,) and which vertices (n,) belong to it."""

    name: str
    locked: bool
    weights: FloatArray
    belongs: NDArray[np.bool_]


@dataclass(frozen=True)
class ShapeKey:
    """A shape key: offsets (n, 3) from the key that it is relative to, empty for the basis, and its values."""

    name: str
    offsets: FloatArray
    relative_to: str
    values: dict[str, Any]


@dataclass(frozen=True)
class Rig:
    """The artist's work on the mesh of an object, and the unposed outline that it refers to."""

    outline: Outline
    groups: tuple[Group, ...]
    active_group: str
    keys: tuple[ShapeKey, ...]
    active_key: str
    key_block: bpy.types.Key | None
    attributes: dict[str, tuple[str, FloatArray]]
    slots: tuple[tuple[str, bpy.types.Material | None, bpy.types.Material | None], ...]
    properties: dict[str, Any]
    left_behind: tuple[str, ...]

    @classmethod
    def of(cls, obj: Object) -> Rig:
        """The work on an object's mesh."""
        mesh = mesh_of(obj)
        attributes, left_behind = _attributes(mesh)
        block = mesh.shape_keys
        if block is not None and block.animation_data is not None and len(block.animation_data.nla_tracks):
            left_behind.append("NLA tracks of its shape keys")
        active, key = obj.vertex_groups.active, obj.active_shape_key
        return cls(
            mesh_outline(mesh),
            tuple(
                Group(group.name, group.lock_weight, np.nan_to_num(own), ~np.isnan(own))
                for group, own in zip(obj.vertex_groups, weights_of(mesh, len(obj.vertex_groups)), strict=True)
            ),
            active.name if active is not None else "",
            _shape_keys(block),
            key.name if key is not None else "",
            block,
            attributes,
            tuple(
                (slot.link, slot.material if slot.link == "OBJECT" else None, material)
                for slot, material in zip(obj.material_slots, mesh.materials, strict=True)
            ),
            {key: mesh[key] for key in mesh.keys() if not key.startswith(keys.PREFIX)},  # noqa: SIM118 - no mapping
            tuple(left_behind),
        )

    def give(self, obj: Object, *, same_vertices: bool = False) -> list[str]:
        """Transfers everything to the object's new mesh, in place of what is there; returns what could not go along.
        same_vertices: vertices keep their numbers if there are as many as before, wherever they are.
        """
        mesh = mesh_of(obj)
        new = mesh_outline(mesh)
        if (same_vertices and len(new.points) == len(self.outline.points)) or np.array_equal(
            new.points, self.outline.points
        ):
            places = OutlineMap.identity(len(new.points))
        else:
            places = outline_map(self.outline, new)
            self._renumber(obj, places)
        self._give_groups(obj, places)
        self._give_slots(obj)
        for name, (kind, values) in self.attributes.items():
            known: Any = mesh.attributes
            attribute = known.get(name) or known.new(name, kind, "POINT")
            attribute.data.foreach_set(PROPERTY_OF.get(kind, "color"), places.of(values).astype(np.float32).ravel())
        keys.store(mesh, self.properties)
        self._give_keys(obj, places)
        if obj.vertex_groups.get(self.active_group) is not None:
            obj.vertex_groups.active = obj.vertex_groups[self.active_group]
        return list(self.left_behind)

    @property
    def blank(self) -> bool:
        """Whether there is no work of an artist on the mesh."""
        return not (self.groups or self.keys or self.attributes or self.left_behind)

    def _give_groups(self, obj: Object, places: OutlineMap) -> None:
        if [group.name for group in obj.vertex_groups] or self.groups:
            obj.vertex_groups.clear()
        for group in self.groups:
            made = obj.vertex_groups.new(name=group.name)
            weights, belongs = places.of(group.weights), places.of(group.belongs.astype(float)) > 0.0
            for weight in np.unique(weights[belongs]):
                made.add(np.flatnonzero(belongs & (weights == weight)).tolist(), float(weight), "REPLACE")
            made.lock_weight = group.locked

    def _give_slots(self, obj: Object) -> None:
        materials: Any = obj.data.materials
        materials.clear()
        for _, _, material in self.slots:
            materials.append(material)
        for slot, (link, own, _) in zip(obj.material_slots, self.slots, strict=True):
            slot.link = link  # type: ignore[assignment]
            if link == "OBJECT":
                slot.material = own

    def _give_keys(self, obj: Object, places: OutlineMap) -> None:
        for key in artists_keys(obj.data.shape_keys):
            obj.shape_key_remove(key)
        if not self.keys:
            return
        shape_keys.add_basis(obj)
        block: Any = obj.data.shape_keys
        block.use_relative = True
        basis = points_of(block.reference_key)
        block.reference_key.name = next((key.name for key in self.keys if not len(key.offsets)), "Basis")
        made: dict[str, Any] = {
            key.name: obj.shape_key_add(name=key.name, from_mix=False) for key in self.keys if len(key.offsets)
        }
        known = {key.name: key for key in self.keys}

        def shape(name: str, seen: tuple[str, ...] = ()) -> FloatArray:
            key = known.get(name)
            if key is None or not len(key.offsets) or name in seen:
                return basis
            return shape(key.relative_to, (*seen, name)) + places.of(key.offsets)

        for name, target in made.items():
            target.points.foreach_set("co", shape(name).astype(np.float32).ravel())
            for attribute, value in known[name].values.items():
                setattr(target, attribute, value)
            target.relative_key = block.key_blocks.get(known[name].relative_to, block.reference_key)
        shape_keys.give_animation(self.key_block, block, f"{obj.name} Steps")
        index = block.key_blocks.find(self.active_key)
        obj.active_shape_key_index = max(index, 0)

    def _renumber(self, obj: Object, places: OutlineMap) -> None:
        """Changes vertex indices in hooks and vertex parents to the nearest new vertices."""
        points, count = self.outline.points, len(self.outline.points)
        for hook in hooks_of(obj):
            old = [index for index in hook.vertex_indices if index < count]
            hook.vertex_indices_set(sorted({places.nearest(points, index) for index in old}))
        for child in obj.children:
            if child.parent_type in {"VERTEX", "VERTEX_3"}:
                old = [index for index in child.parent_vertices if index < count]
                child.parent_vertices = [places.nearest(points, index) for index in old] + [0] * (3 - len(old))


def is_rigged(obj: Object) -> bool:
    """Whether an output object carries work of an artist that would be lost with it."""
    modifiers = [modifier for modifier in obj.modifiers if not display.is_ours(modifier)]
    children = [child for child in obj.children if not cage_sets.is_helper(child, cage_sets.FIELD, cage_sets.LINES)]
    animated = shape_keys.action_of(obj) is not None
    constrained = len(obj.constraints) > (placement.constraint_of(obj) is not None)
    return bool(not Rig.of(obj).blank or constrained or modifiers or children or animated)


def hooks_of(obj: Object) -> list[bpy.types.HookModifier]:
    """The hooks of an object that refer to vertices by index."""
    hooks = [modifier for modifier in obj.modifiers if isinstance(modifier, bpy.types.HookModifier)]
    return [hook for hook in hooks if len(hook.vertex_indices)]


def rest_points(mesh: Mesh) -> FloatArray:
    """Vertices (n, 3) of a mesh at rest: as bound, or of the basis of its shape keys."""
    attribute: Any = mesh.attributes.get(keys.REST)
    if attribute is not None and attribute.data_type == "FLOAT_VECTOR" and attribute.domain == "POINT":
        return stored(attribute.data, "vector", 3).astype(np.float64)
    return points_of(mesh if mesh.shape_keys is None else mesh.shape_keys.reference_key)


def mesh_outline(mesh: Mesh) -> Outline:
    """The outline of a mesh at rest."""
    return Outline.of(rest_points(mesh), loop_edges(mesh))


def artists_keys(block: bpy.types.Key | None) -> list[bpy.types.ShapeKey]:
    """The shape keys of a mesh that are neither its basis nor steps of our animation."""
    blocks = block.key_blocks if block is not None else ()
    return [key for key in blocks if key != block.reference_key and not shape_keys.STEP.fullmatch(key.name)]


def _shape_keys(block: bpy.types.Key | None) -> tuple[ShapeKey, ...]:
    """The artist's keys; if there are any, after the basis with its name."""
    own = artists_keys(block)
    if block is None or not own:
        return ()
    keys = [ShapeKey(block.reference_key.name, np.empty((0, 3)), "", {})]
    for key in own:
        values = {name: getattr(key, name) for name in KEY_VALUES if hasattr(key, name)}
        offsets = points_of(key) - points_of(key.relative_key)
        keys.append(ShapeKey(key.name, offsets, key.relative_key.name, values))
    return tuple(keys)


def _attributes(mesh: Mesh) -> tuple[dict[str, tuple[str, FloatArray]], list[str]]:
    """The artist's point attributes, and what else there is, in words."""
    kept: dict[str, tuple[str, FloatArray]] = {}
    others: list[str] = []
    attributes: Any = mesh.attributes
    for attribute in attributes:
        name, kind = attribute.name, attribute.data_type
        if name.startswith((".", keys.PREFIX)) or name in BUILT_IN:
            continue
        if attribute.domain == "POINT" and kind in WIDTHS:
            values = stored(attribute.data, PROPERTY_OF.get(kind, "color"), WIDTHS[kind])
            kept[name] = (kind, values.astype(np.float64))
        else:
            others.append(f"the attribute '{name}'")
    return kept, others
