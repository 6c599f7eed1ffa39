"""Copies become sets of their own: duplicated, appended or instanced drawings with their cages, and sets without their
collection.

The fine mesh carries the record with it, and Blender makes the pointers of copied objects refer to the copies.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import bpy

from .. import keys, record
from ..scene import display, ownership
from .deform_modifiers import target_of


def waiting(obj: bpy.types.Object | None) -> list[bpy.types.Object]:
    """The fine meshes without a set of the drawing that an object is, or belongs to."""
    if obj is None:
        return []
    mine = record.member(obj).of or obj
    return [fine for fine in bpy.data.objects if _is_waiting(fine, mine)]


def _is_waiting(fine: bpy.types.Object, drawing: bpy.types.Object) -> bool:
    found: Any = fine.nested_cages_member  # type: ignore[attr-defined]
    return (
        found.level == 0
        and found.of == drawing
        and found.kept.version > 0
        and fine.is_editable
        and ownership.exists(fine)
        and ownership.home_of_member(fine) is None
        and ownership.level_of(fine) is not None
    )


def adopt(scene: bpy.types.Scene, objects: Iterable[bpy.types.Object]) -> list[bpy.types.Collection]:
    """Makes sets of the waiting fine meshes of objects and their cages; returns the new collections."""
    fines = dict.fromkeys(fine for obj in objects for fine in waiting(obj))
    return [_adopted(scene, fine) for fine in fines]


def _adopted(scene: bpy.types.Scene, fine: bpy.types.Object) -> bpy.types.Collection:
    """A collection with the record of a fine mesh, and the objects of its set in it."""
    kept = record.described(fine).kept
    drawing, before = record.described(fine).of, record.described(fine).home
    parts = [part.object for part in kept.levels]
    objects = [obj for obj in parts if obj is not None and ownership.home_of_member(obj) is None]
    if before is not None:
        copied = {part.object: obj for part, obj in zip(record.of(before).levels, objects, strict=False)}
        for obj in (*objects, *((drawing,) if ownership.exists(drawing) else ())):
            _own_helpers(obj, copied)
    helpers = [obj for obj in bpy.data.objects if _helps(obj, objects)]
    title = drawing.name if ownership.exists(drawing) else fine.name
    collection = bpy.data.collections.new(f"{title} {'Inner Cages' if kept.inside else 'Cages'}")
    ownership.home_of(scene, drawing).children.link(collection)
    found, latest = record.written(collection), kept if before is None else record.written(before)
    own = {"sources": record.values(kept)["sources"], "colours": -1, "markers": [], "title": title}
    record.assign(found, {**record.values(latest), **own})
    record.fill(found.levels, objects)
    found.colours = ownership.colours_of(collection)
    for level, obj in enumerate(objects):
        record.described(obj).home, record.described(obj).level = collection, level
        display.apply_display(obj, level, found.colours)
        _own_meshes(obj)
    for obj in (*objects, *helpers):
        if before is not None and obj.name in before.objects:
            before.objects.unlink(obj)
        if obj.name not in collection.objects and (obj in helpers or not obj.users_collection or before is not None):
            collection.objects.link(obj)
    if ownership.exists(drawing) and keys.has(drawing, keys.FOLLOWS):
        drawing[keys.FOLLOWS] = collection
    record.keep(collection)
    return collection


def _helps(obj: bpy.types.Object, objects: list[bpy.types.Object]) -> bool:
    shown = (keys.SURFACE_OF, keys.PRISM_OF, keys.LINES_OF)
    return keys.flag(obj, keys.HELPER) and any(keys.block(obj, key, bpy.types.Object) in objects for key in shown)


def _own_helpers(obj: bpy.types.Object, copied: dict[bpy.types.Object, bpy.types.Object]) -> None:
    """Copies the hidden helpers that a copied object still shares with the original: duplicating leaves them out."""
    for modifier in obj.modifiers:
        shared = target_of(modifier)
        if shared is None or not keys.flag(shared, keys.HELPER) or shared.parent == obj:
            continue
        helper = shared.copy()
        helper.data, helper.parent = shared.data.copy(), obj
        for key in (keys.SURFACE_OF, keys.PRISM_OF):
            cage = keys.block(shared, key, bpy.types.Object)
            if cage is not None:
                helper[key] = copied.get(cage, cage)
        for shows in helper.modifiers:
            if isinstance(shows, bpy.types.NodesModifier):
                cage = display.get_input(shows, "Object")
                display.set_input(shows, "Object", copied.get(cage, cage))
        for home in shared.users_collection:
            home.objects.link(helper)
        if isinstance(modifier, bpy.types.NodesModifier):
            display.set_input(modifier, "Object", helper)
        elif isinstance(modifier, bpy.types.MeshDeformModifier):
            modifier.object = helper
        elif isinstance(modifier, bpy.types.SurfaceDeformModifier):
            modifier.target = helper


def _own_meshes(obj: bpy.types.Object) -> None:
    """Meshes that the object shares with the one that it is a copy of become its own."""
    if obj.data.users > 1:
        obj.data = obj.data.copy()
    mesh = keys.block(obj, keys.STORED_MESH, bpy.types.Mesh)
    if mesh is not None and mesh.users > 1:
        obj[keys.STORED_MESH] = mesh.copy()
