"""Copies become sets of their own: duplicated, appended or instanced drawings with their cages, and sets without their
collection.

Blender makes pointers of copied objects refer to the copies, and each object carries its set's record with it. What is
hidden is not copied with the rest: the fine mesh and the fields of a binding are copied here.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import bpy
from bpy.types import Collection, Object, Scene

from .. import record
from ..animation import shape_keys, visibility
from ..scene import display, filling, ownership, placement
from . import field


def waiting(objects: Iterable[Object]) -> list[Object]:
    """The objects without a set whose drawing one of some objects is, shares, or is a part of."""
    near = {record.node_of(obj).of or obj for obj in objects if record.has_node(obj)}
    if not near:
        return []
    copies = [each for each in bpy.data.objects if record.node_of(each).of is not None]
    copies = [each for each in copies if len(record.node_of(each).kept.levels) and each.is_editable]
    copies = [each for each in copies if ownership.exists(each) and ownership.home_of_member(each) is None]
    copies = [each for each in copies if ownership.level_of(each) is not None]
    drawings = {own.of for own in map(record.node_of, copies) if near & {own.of, *(p.object for p in own.kept.sources)}}
    return [each for each in copies if record.node_of(each).of in drawings]


def adopt(scene: Scene, objects: Iterable[Object]) -> list[Collection]:
    """Makes sets of what waits for it with some objects; returns their collections."""
    sets: dict[tuple[Object, bool], dict[int, Object]] = {}
    for copy in waiting(objects):
        own = record.node_of(copy)
        sets.setdefault((own.of, own.kept.inside), {}).setdefault(own.level, copy)
    return [_adopted(scene, drawing, copies) for (drawing, _), copies in sets.items()]


def _adopted(scene: Scene, drawing: Object, copies: dict[int, Object]) -> Collection:
    """A set of a drawing and the copies of its objects by level."""
    first = record.node_of(next(iter(copies.values())))
    kept, before, title = first.kept, first.home, drawing.name if ownership.exists(drawing) else "Adopted"
    collection = bpy.data.collections.new(f"{title} {'Inner Cages' if kept.inside else 'Cages'}")
    ownership.home_of(scene, drawing).children.link(collection)
    cage_set, latest = record.new(collection), kept if before is None else record.of(before)
    sources = [part["object"] for part in record.values(kept)["sources"]]
    originals = {} if before is None else {part.object: obj for part, obj in zip(latest.sources, sources, strict=False)}
    old = {number: part.object for number, part in enumerate(latest.levels) if part.object is not None}
    for level, obj in old.items():
        if level not in copies and before is not None:
            copies[level] = _copied(obj, originals)
    objects = [copies[level] for level in sorted(copies)]
    record.assign(cage_set, {**record.values(latest), "colours": -1, "markers": [], "title": title})
    record.refer(cage_set.sources, sources)
    record.refer(cage_set.levels, objects)
    cage_set.colours = ownership.colours_of(collection)
    for level, obj in enumerate(objects):
        own = record.node_of(obj)
        own.home, own.level, own.of = collection, level, drawing
        _own_data(obj)
        if before is not None:
            display.apply_display(obj, level, cage_set.colours)
            for home in obj.users_collection:
                if home == before:
                    home.objects.unlink(obj)
        if not obj.users_collection:
            collection.objects.link(obj)
    if before is not None:
        cages = {old[level]: obj for level, obj in copies.items() if level in old}
        _own_fields(collection, cages, [*objects, *sources], originals)
        for part, earlier in zip(cage_set.sources, latest.sources, strict=False):
            part.hidden = earlier.hidden
        if cage_set.playing:
            visibility.enter(collection)
    record.keep(collection)
    return collection


def _copied(obj: Object, originals: dict[Object, Object]) -> Object:
    """A copy of a hidden object, carried by the copy of its drawing."""
    made = obj.copy()
    made.data = filling.mesh_of(obj).copy()
    carrier, there = placement.carrier_of(obj)
    if carrier in originals:
        placement.carry(made, originals[carrier], there)
    return made


def _own_data(obj: Object) -> None:
    """Meshes and actions that an object shares with the one that it is a copy of become its own."""
    if obj.data.users > 1:
        obj.data = obj.data.copy()
    before = record.before(obj)
    mesh = before.mesh
    if mesh is not None and mesh.users > 1:
        mesh = mesh.copy()
        record.set_before(obj, before._replace(mesh=mesh))
    for owner in (obj, *(each.shape_keys for each in (obj.data, mesh) if each is not None)):
        action = shape_keys.action_of(owner)
        if action is not None and shape_keys.is_shared(owner):
            shape_keys.own_action(owner, action.name)


def _own_fields(
    collection: Collection, cages: dict[Object, Object], followers: list[Object], originals: dict[Object, Object]
) -> None:
    """Copies the fields that followers still share with the originals."""
    made: dict[Object, Object] = {}
    for obj in followers:
        shared = field.followed(obj)
        cage = record.shown(shared, record.FIELD) if shared is not None else None
        if shared is None or cage not in cages:
            continue
        if shared not in made:
            own = made[shared] = _copied(shared, originals)
            record.make_helper(own, record.FIELD, cages[cage])
            collection.objects.link(own)
            for shows in own.modifiers:
                if isinstance(shows, bpy.types.NodesModifier):
                    display.set_input(shows, "Object", cages[cage])
        modifier = display.nodes_modifier(obj, field.FOLLOW)
        assert modifier is not None
        display.set_input(modifier, "Object", made[shared])
        field.shown_by(obj).update_tag()
    for own in made.values():
        own.update_tag()


@bpy.app.handlers.persistent  # type: ignore[untyped-decorator]
def _on_import(context: Any) -> None:
    """Removes the objects that *Append* makes of meshes that bound objects keep for later."""
    came = {item.id for item in context.import_items}
    parked = {mesh for obj in bpy.data.objects if (mesh := record.before(obj).mesh) in came and mesh is not None}
    for stray in [obj for obj in bpy.data.objects if obj.data in parked and record.node_of(obj).role == "NONE"]:
        bpy.data.objects.remove(stray)


_HANDLERS: list[Any] = getattr(bpy.app.handlers, "blend_import_post", [])  # since Blender 4.3


def register() -> None:
    _HANDLERS.append(_on_import)


def unregister() -> None:
    _HANDLERS.remove(_on_import)
