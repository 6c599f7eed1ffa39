"""Which objects belong to which drawing: an output collection knows the drawing's object, whatever it is called."""

from __future__ import annotations

import bpy

# Custom properties that say where an output comes from, and which level an object of it is; 0 is the fine mesh.
SOURCE = "nested_cages_source"
LEVEL = "nested_cages_level"


def collection_of(scene: bpy.types.Scene, source: bpy.types.Object) -> bpy.types.Collection | None:
    """The collection that holds the output of an object, if there is one in the scene."""
    return next((c for c in scene.collection.children_recursive if c.get(SOURCE) == source), None)


def collection_about(scene: bpy.types.Scene, obj: bpy.types.Object) -> bpy.types.Collection | None:
    """The output that an object belongs to or is the source of."""
    if LEVEL in obj:
        return next((c for c in obj.users_collection if SOURCE in c), None)
    return collection_of(scene, obj)


def source_of(collection: bpy.types.Collection) -> bpy.types.Object | None:
    """The object that an output was made of; None if it has been deleted, even though the collection knows it still."""
    source = collection.get(SOURCE)
    return source if source is not None and source.users_scene else None


def member(collection: bpy.types.Collection, level: int) -> bpy.types.Object | None:
    """The object of a level in an output collection; level 0 is the fine mesh."""
    return next((o for o in collection.objects if o.get(LEVEL) == level), None)


def members(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """All output objects of a collection, the fine mesh first; copies that the user made of them do not count."""
    found: dict[int, bpy.types.Object] = {}
    for obj in collection.objects:
        if LEVEL in obj:
            found.setdefault(obj[LEVEL], obj)
    return [found[level] for level in sorted(found)]
