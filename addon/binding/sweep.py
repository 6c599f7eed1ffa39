"""Before a file is saved, sets of which all that is seen was deleted are removed: their pointers to each other would
keep them in the file for ever.
"""

from __future__ import annotations

from typing import Any

import bpy
from bpy.types import Collection, Object

from .. import record
from ..animation import shape_keys, timeline, visibility
from ..scene import display, filling, ownership


def sweep() -> None:
    """Removes the hidden objects of these sets, and what was deleted, unless something else uses it."""
    homes = (*bpy.data.collections, *(scene.collection for scene in bpy.data.scenes))
    there = {obj for home in homes for obj in home.objects}  # instances show collections that are in no scene
    nodes = {obj: record.node_of(obj) for obj in bpy.data.objects if record.has_node(obj)}
    gone = {obj for obj in nodes if obj not in there and not obj.use_fake_user and obj.library is None}
    for collection in [each for each in bpy.data.collections if ownership.is_output(each) and each.is_editable]:
        cage_set = record.of(collection)
        levels = [part.object for part in cage_set.levels]
        drawings = [part.object for part in cage_set.sources if part.object is not None]
        drawings += [obj for drawing in drawings for obj in record.shown_in(drawing)]
        copies = [obj for obj, node in nodes.items() if node.home == collection and obj not in levels]
        if gone.issuperset({*drawings, *levels[1:], *copies} - {None}):
            _remove(collection, [obj for obj in levels[:1] if obj is not None and obj not in gone])
    ours = [record.of(each) for each in bpy.data.collections if ownership.is_output(each)]
    listed = {part.object for cage_set in ours for items in (cage_set.sources, cage_set.levels) for part in items}
    dead = gone - listed
    for obj in dead:
        record.set_before(obj, record.Before())
        record.remove(obj)
    used = bpy.data.user_map(subset=dead) if dead else {}
    bpy.data.batch_remove([obj for obj, users in used.items() if users <= dead])


def _remove(collection: Collection, fine: list[Object]) -> None:
    """Removes what is left of a set."""
    dropped = timeline.stop_playing(bpy.data.scenes[0], collection)
    visibility.leave(collection)
    cage_set = record.of(collection)
    own = {part.object for items in (cage_set.levels, cage_set.sources) for part in items} - {None}
    helpers = [obj for obj in bpy.data.objects if record.shown(obj, record.FIELD, record.LINES, record.PROXY) in own]
    hidden = [*fine, *helpers]
    meshes = [*map(filling.mesh_of, hidden), *filter(None, (record.before(obj).mesh for obj in own))]
    for obj in hidden:
        for modifier in list(obj.modifiers):
            display.remove_modifier(obj, modifier)
    cage_set.levels.clear()
    cage_set.sources.clear()
    shape_keys.discard(hidden, meshes, [])
    if not len(collection.all_objects):
        bpy.data.collections.remove(collection)
    for scene in bpy.data.scenes:
        timeline.settle(scene, dropped)


@bpy.app.handlers.persistent  # type: ignore[untyped-decorator]
def _on_save(*_: Any) -> None:
    sweep()


def register() -> None:
    bpy.app.handlers.save_pre.append(_on_save)


def unregister() -> None:
    bpy.app.handlers.save_pre.remove(_on_save)
