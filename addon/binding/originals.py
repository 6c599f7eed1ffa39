"""The original object of a drawing follows its cages too, where Blender allows it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress

import bpy
from mathutils import Matrix

from .. import keys
from ..errors import UserError
from ..scene import convert, display, ownership
from . import deform_modifiers, node_groups, strokes, weights

ORIGINAL_MODIFIER = "Nested Cages Follow"


@contextmanager
def unposed(objects: Iterable[bpy.types.Object]) -> Iterator[None]:
    """Temporarily shows the own shapes of originals that follow their cages."""
    found = [m for obj in objects for m in obj.modifiers if m.name == ORIGINAL_MODIFIER and m.show_viewport]
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
    """Makes the original of a bound collection follow, a mesh by `method`; returns how it follows, or why it does
    not."""
    fine = levels[0]
    source = ownership.source_of(collection)
    if source is None or source == fine:
        return f"The original object is gone; '{fine.name}' follows"
    if source.name not in context.view_layer.objects or not source.is_editable or not convert.readable(source):
        return f"'{source.name}' cannot be changed here; '{fine.name}' follows in its place"
    solid = source.type in {"CURVE", "FONT"} and (source.data.bevel_depth or source.data.extrude)
    if source.type == "MESH" or solid or (source.type == "CURVE" and source.data.bevel_mode == "OBJECT"):
        kind = _bind_shape(context, source, levels[1], method if source.type == "MESH" else deform_modifiers.PRISM)
        if kind is None:
            return f"'{source.name}' cannot be bound itself; '{fine.name}' follows in its place"
        source[keys.FOLLOWS] = collection
        words = deform_modifiers.NAMES[kind]
        if kind == deform_modifiers.PRISM:
            words += ", which is exact to a few per cent"
        return f"'{source.name}' follows by {words}"
    # In the drawing's own space, so that copies and instances show the same where they are.
    shown = (
        fine if fine.parent == source and fine.matrix_local == Matrix() else deform_modifiers.surface_of(source, fine)
    )
    if source.type == "GREASEPENCIL":
        problem = strokes.why_not(source)
        if problem:
            return f"'{fine.name}' follows in place of '{source.name}': {problem}"
        return _follows(strokes.add(source, fine, shown), source, collection, fine)
    flat = source.type == "FONT" or (source.type == "CURVE" and source.data.dimensions == "2D")
    if flat and source.data.fill_mode != "NONE":
        modifier = node_groups.add(source, node_groups.AREA, Object=shown, Material=source.active_material)
    else:
        modifier = node_groups.add(source, node_groups.CURVES, Object=shown)
    return _follows(modifier, source, collection, fine)


def _follows(
    modifier: bpy.types.Modifier, source: bpy.types.Object, collection: bpy.types.Collection, fine: bpy.types.Object
) -> str:
    """Marks an original that follows the fine mesh."""
    modifier.name = ORIGINAL_MODIFIER
    source[keys.FOLLOWS] = collection
    return f"'{source.name}' shows what '{fine.name}' does"


def _bind_shape(
    context: bpy.types.Context, source: bpy.types.Object, cage: bpy.types.Object, method: str
) -> str | None:
    """Binds an object with faces or thickness directly; returns the method that succeeded, if any."""
    methods = [method]
    if method in weights.KINDS:
        # Objects with generated vertices or that are not flat have no weights; Surface Deform handles them.
        plain = len(deform_modifiers.evaluated_points(context, source)) == len(source.data.vertices)
        methods = (
            [method, deform_modifiers.SURFACE] if plain and weights.fits(source, cage) else [deform_modifiers.SURFACE]
        )
    reach = 2.0 * max(abs(corner[2]) for corner in source.bound_box)
    for kind in methods:
        with suppress(UserError):
            modifier = deform_modifiers.bind_modifier(context, source, cage, kind, reach, in_place=True)
            if deform_modifiers.is_bound(modifier):
                modifier.name = ORIGINAL_MODIFIER
                return kind
            display.remove_modifier(source, modifier)
    return None


def release(collection: bpy.types.Collection) -> None:
    """Restores the own shapes of the objects that follow a collection."""
    for obj in bpy.data.objects:
        modifier = obj.modifiers.get(ORIGINAL_MODIFIER)
        if modifier is not None and obj.get(keys.FOLLOWS) == collection:
            display.remove_modifier(obj, modifier)
            if obj.type == "MESH":
                weights.clear(obj)
            if obj.type == "GREASEPENCIL":
                strokes.clear(obj)
            del obj[keys.FOLLOWS]
