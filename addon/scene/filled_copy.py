"""The moving copy: an object that fills the outline of a fine mesh on every frame, in the drawing's own materials."""

from __future__ import annotations

from typing import Any

import bpy

from .. import record
from . import nodes
from .display import add_nodes_modifier


def make(collection: bpy.types.Collection, fine: bpy.types.Object, source: bpy.types.Object | None) -> bpy.types.Object:
    """A new object that fills the outline of `fine`, next to the drawing that it stands for."""
    name = f"{source.name if source is not None else fine.name} Moving"
    mesh = bpy.data.meshes.new(name)
    copy = bpy.data.objects.new(name, mesh)
    record.make_helper(copy, record.FILL, fine)
    copy.parent = fine
    copy.location.z = fine.data.vertices[0].co.z  # the filled area is flat, at height 0
    copy.hide_select = True
    if source is not None:
        copy.color = source.color
    for home in (source.users_collection if source is not None else ()) or (collection,):
        home.objects.link(copy)
    material = main_material(source) if source is not None else None
    add_nodes_modifier(copy, nodes.FILL, nodes.group(nodes.FILL), {"Object": fine, "Material": material})
    return copy


def copies_of(fine: bpy.types.Object) -> list[bpy.types.Object]:
    """The objects that fill a fine mesh."""
    return [child for child in fine.children if record.shown(child, record.FILL) == fine]


def main_material(source: bpy.types.Object) -> bpy.types.Material | None:
    """The material of most faces of an object; the active one if there are no faces."""
    slots = [slot.material for slot in source.material_slots]
    if source.type == "MESH" and len(source.data.polygons) and len(slots) > 1:
        counts = [0] * len(slots)
        for polygon in source.data.polygons:
            counts[min(polygon.material_index, len(slots) - 1)] += 1
        return slots[counts.index(max(counts))]
    found = source.active_material or next((material for material in slots if material is not None), None)
    return _of_strokes(found) if found is not None and getattr(found, "is_grease_pencil", False) else found


def _of_strokes(material: bpy.types.Material) -> bpy.types.Material:
    """A material for faces in the colour of a Grease Pencil material, which faces cannot have; one per file."""
    name = f"{material.name} Fill"
    found = bpy.data.materials.get(name)
    if found is None:
        found = bpy.data.materials.new(name)
        style: Any = material.grease_pencil
        found.diffuse_color = style.fill_color if style.show_fill else style.color
        if found.node_tree is None:  # always there since Blender 5.0
            found.use_nodes = True
        shader = next((node for node in found.node_tree.nodes if "Base Color" in node.inputs), None)
        if shader is not None:
            shader.inputs["Base Color"].default_value = found.diffuse_color
    return found
