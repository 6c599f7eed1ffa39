"""The object that a drawing was read from follows its cages too, where Blender allows it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import bpy

from . import convert, following, nodes, output
from .refusal import say

# Custom property with the collection that an object follows, and its modifier.
ORIGINAL = "nested_cages_follows"
ORIGINAL_MODIFIER = "Nested Cages Follow"


@contextmanager
def unposed(objects: Iterable[bpy.types.Object]) -> Iterator[None]:
    """Originals that follow their cages show their own shape for a moment."""
    found = [m for obj in objects if (m := obj.modifiers.get(ORIGINAL_MODIFIER)) is not None and m.show_viewport]
    for modifier in found:
        modifier.show_viewport = False
    try:
        yield
    finally:
        for modifier in found:
            modifier.show_viewport = True


def follow(
    context: bpy.types.Context,
    collection: bpy.types.Collection,
    levels: list[bpy.types.Object],
    method: str,
) -> str:
    """Makes the original of a bound collection follow, a mesh by `method`; says how it does, or why it does not."""
    fine = levels[0]
    source = bpy.data.objects.get(collection[output.SOURCE])
    if source is None or source == fine:
        return say("The original object is gone; '{fine}' follows", fine=fine.name)
    if source.name not in context.view_layer.objects or not source.is_editable or not convert.readable(source):
        return say("'{name}' cannot be changed here; '{fine}' follows in its place", name=source.name, fine=fine.name)
    solid = source.type in {"CURVE", "FONT"} and (source.data.bevel_depth or source.data.extrude)
    if source.type == "MESH" or solid or (source.type == "CURVE" and source.data.bevel_mode == "OBJECT"):
        kind = method if source.type == "MESH" else following.PRISM
        reach = 2.0 * max(abs(corner[2]) for corner in source.bound_box)
        modifier = following.bind_modifier(context, source, levels[1], kind, reach)
        modifier.name = ORIGINAL_MODIFIER
        if not modifier.is_bound:
            source.modifiers.remove(modifier)
            return say(
                "'{name}' cannot be bound itself; '{fine}' follows in its place", name=source.name, fine=fine.name
            )
        source[ORIGINAL] = collection
        words = "Surface Deform" if kind == following.SURFACE else "Mesh Deform, which is exact to a few per cent"
        return say("'{name}' follows by {kind}", name=source.name, kind=words)
    if source.type not in {"CURVE", "FONT", "CURVES"}:
        return say(
            "Blender has no modifier that lets a Grease Pencil follow; '{fine}' follows in place of '{name}'",
            name=source.name,
            fine=fine.name,
        )
    flat = source.type == "FONT" or (source.type == "CURVE" and source.data.dimensions == "2D")
    if flat and source.data.fill_mode != "NONE":
        modifier = nodes.add(source, nodes.AREA, Object=fine, Material=source.active_material)
    else:
        modifier = nodes.add(source, nodes.CURVES, Object=fine)
    modifier.name = ORIGINAL_MODIFIER
    source[ORIGINAL] = collection
    return say("'{name}' shows what '{fine}' does", name=source.name, fine=fine.name)


def release(collection: bpy.types.Collection) -> None:
    """Lets the objects that follow a collection show their own shape again."""
    for obj in bpy.data.objects:
        modifier = obj.modifiers.get(ORIGINAL_MODIFIER)
        if modifier is not None and obj.get(ORIGINAL) == collection:
            obj.modifiers.remove(modifier)
            del obj[ORIGINAL]
