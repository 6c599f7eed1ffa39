"""Which objects belong to which drawing: an output collection refers to the drawing's object, whatever its name."""

from __future__ import annotations

import bpy

from .. import keys


def depth_of(obj: bpy.types.Object) -> int:
    """The place of an object in its nest, from the inside out: inner cages below 0, 0 for the drawing, cages above."""
    level = level_of(obj) or 0
    return -level if is_inside(obj) else level


def level_of(obj: bpy.types.Object) -> int | None:
    """The level of an output object, 0 for the fine mesh; None for other objects."""
    level = keys.integer(obj, keys.LEVEL) if obj.type == "MESH" else None
    return level if level is not None and level >= 0 else None


def helpers(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """The hidden helper objects of an output."""
    return [obj for obj in collection.objects if keys.flag(obj, keys.HELPER) and level_of(obj) is None]


def is_output(collection: bpy.types.Collection) -> bool:
    """Whether a collection holds the output of a drawing."""
    return keys.has(collection, keys.SOURCE)


def is_bound(collection: bpy.types.Collection) -> bool:
    """Whether the cages of an output collection are bound."""
    return bool(keys.text(collection, keys.BOUND))


def is_inside(owner: bpy.types.ID) -> bool:
    """Whether an output, or a cage, lies inside the drawing."""
    return keys.flag(owner, keys.INSIDE)


def outputs_of(scene: bpy.types.Scene, source: bpy.types.Object) -> list[bpy.types.Collection]:
    """The collections that hold the output of an object in the scene: of the cages around it, and of those inside."""
    found = [c for c in scene.collection.children_recursive if c.get(keys.SOURCE) == source]
    return sorted(found, key=is_inside)


def collection_of(
    scene: bpy.types.Scene, source: bpy.types.Object, *, inside: bool = False
) -> bpy.types.Collection | None:
    """The collection of the cages around an object, or of those inside, if there is one in the scene."""
    return next((c for c in outputs_of(scene, source) if is_inside(c) == inside), None)


def outputs_about(scene: bpy.types.Scene, obj: bpy.types.Object) -> list[bpy.types.Collection]:
    """The output that an object belongs to, or those that it is a source of."""
    obj = keys.block(obj, keys.HANDLES_OF, bpy.types.Object) or obj
    if level_of(obj) is not None:
        return [c for c in obj.users_collection if is_output(c)][:1]
    return outputs_of(scene, obj) or [
        c for c in scene.collection.children_recursive if is_output(c) and obj in originals(c)
    ]


def collection_about(scene: bpy.types.Scene, obj: bpy.types.Object) -> bpy.types.Collection | None:
    """The same; of the cages around an object and those inside, the former."""
    return next(iter(outputs_about(scene, obj)), None)


def source_of(collection: bpy.types.Collection) -> bpy.types.Object | None:
    """The source object of an output; None if it was deleted, even if the collection still refers to it."""
    source = keys.block(collection, keys.SOURCE, bpy.types.Object)
    return source if source is not None and source.users_scene else None


def originals(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """The source objects of an output, first the one that it is named after, and those whose silhouette they are;
    without deleted ones.
    """
    first = collection.get(keys.SOURCE)
    stored = [first, *_others(collection), *(_others(first) if isinstance(first, bpy.types.Object) else ())]
    found = [obj for obj in stored if isinstance(obj, bpy.types.Object) and obj.users_scene]
    return list(dict.fromkeys(found))


def _others(owner: bpy.types.ID) -> list[object]:
    """Other objects that an output, or a silhouette, was made of."""
    others = owner.get(keys.OTHERS)
    return list(others.values()) if hasattr(others, "values") else []


def colours_of(scene: bpy.types.Scene, collection: bpy.types.Collection) -> int:
    """The number of the colours of an output, one that no other output in the scene has."""
    own = keys.integer(collection, keys.COLOURS)
    if own is not None and own >= 0:
        return own
    used = {keys.integer(other, keys.COLOURS) for other in scene.collection.children_recursive}
    return next(number for number in range(len(used) + 1) if number not in used)


def member(collection: bpy.types.Collection, level: int) -> bpy.types.Object | None:
    """The object of a level in an output collection; level 0 is the fine mesh."""
    return next((o for o in collection.objects if level_of(o) == level), None)


def members(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """All output objects of a collection, the fine mesh first; without copies made by the user."""
    found: dict[int, bpy.types.Object] = {}
    for obj in collection.objects:
        level = level_of(obj)
        if level is not None:
            found.setdefault(level, obj)
    return [found[level] for level in sorted(found)]


def home_of(scene: bpy.types.Scene, source: bpy.types.Object | None) -> bpy.types.Collection:
    """The collection for the output of an object: its own one in the scene, or the scene's."""
    own = source.users_collection if source is not None else ()
    there = set(scene.collection.children_recursive)
    return next((c for c in own if c in there and c.is_editable and not is_output(c)), scene.collection)


def why_locked(obj: bpy.types.Object) -> str:
    """Why an output object cannot be changed; empty if it can. Overrides can be posed, but lose additions."""
    if obj.override_library is not None:
        return (
            f"'{obj.name}' is an override of another file: it can be posed and keyed here, but for this open that "
            "file, or make it local first (Object > Relations > Make Local)"
        )
    if not obj.is_editable or not obj.data.is_editable:
        return f"'{obj.name}' is linked from another file: open that file, or make it local first"
    return ""
