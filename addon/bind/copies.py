"""Copies of sets: a copy of drawings and cages is a set at once, and follows its own cages. What Blender does not copy,
since it is hidden or was not selected, is shared with the original until something is to be changed.
"""

from __future__ import annotations

from typing import Any

import bpy
from bpy.types import Object

from .. import cage_sets
from ..animation import visibility
from ..blender import display, mesh_data, shape_keys
from ..cage_sets import CageSet, selection
from ..drawing import placement
from . import field


def complete() -> None:
    """Gives copies their own of all that they share with originals, before either is changed."""
    for cage_set in CageSet.everywhere():
        if any(obj.override_library or not obj.is_editable for obj in cage_set.members):
            continue
        noted = cage_set.record
        playing, copied = noted.playing, _own_members(cage_set)
        for obj in cage_set.members:
            _own_data(obj)
        for cage in cage_set.cages if noted.bound else ():
            copied |= _own_field(cage_set, cage)
        drawings = cage_set.drawings()
        left = {obj for obj in cage_sets.objects_in(noted.parts) if obj not in drawings}
        if copied or left:
            cage_sets.drop(noted.parts, list(left))
            _set_apart(cage_set)
            if playing and not noted.bound:
                visibility.enter(cage_set)


def own_copy(obj: Object, beside: Object) -> Object:
    """A copy of an object with a mesh of its own, in the collections of another one."""
    own = obj.copy()
    own.data = mesh_data.mesh_of(obj).copy()
    for home in beside.users_collection:
        home.objects.link(own)
    return own


def _own_members(cage_set: CageSet) -> bool:
    """Copies the fine mesh and coarser cages that belong to the original; returns whether there were any."""
    copied = False
    while shared := [obj for obj, _ in cage_set.shared() if cage_sets.exists(obj)]:
        obj, inner = shared[0], cage_set.cages[-1]
        carrier, there = placement.carrier_of(obj)
        beside, _ = placement.carrier_of(cage_set.finest)
        own = own_copy(obj, cage_set.finest)
        if carrier is not None and beside is not None:  # the copy of the drawing carries the copies that were made
            placement.carry(own, beside, there)
        own.hide_set(obj.hide_get())
        node = cage_sets.new_node(own)
        if node.role == cage_sets.FINE:
            node.outer, cage_sets.new_node(cage_set.finest).inner = cage_set.finest, own
            _follow_again(own, cage_set.finest)
        else:
            node.inner, cage_sets.new_node(inner).outer = inner, own
            _follow_again(inner, own)
        cage_sets.forget_sets()
        copied = True
    return copied


def _follow_again(obj: Object, cage: Object) -> None:
    """Lets an object that follows a cage of the original follow the copy instead."""
    modifier = display.nodes_modifier(field.shown_by(obj), field.FOLLOW)
    if modifier is not None and field.followed(obj) not in (None, cage):
        display.set_input(modifier, "Cage", cage)
        if display.get_input(modifier, "Space") is not None:
            display.set_input(modifier, "Space", placement.carrier_of(cage)[0])
        obj.update_tag()


def _own_data(obj: Object) -> None:
    """Meshes and actions that a copy shares with its original become its own."""
    if obj.data.users > 1:
        obj.data = obj.data.copy()
    mesh = cage_sets.node_of(obj).before.mesh
    if mesh is not None and mesh.users > 1:
        mesh = mesh.copy()
        cage_sets.set_before(obj, cage_sets.before(obj)._replace(mesh=mesh))
    shape_keys.own_actions([obj, *(each.shape_keys for each in (obj.data, mesh) if each is not None)])


def _own_field(cage_set: CageSet, cage: Object) -> bool:
    """Copies a field that belongs to a cage of the original; returns whether it did."""
    shared = field.field_of(cage)
    if shared is None or cage_sets.shown(shared, cage_sets.FIELD) == cage:
        return False
    own = own_copy(shared, cage)
    cage_sets.drop(cage_sets.new_node(cage).helpers, [shared])
    cage_sets.make_helper(own, cage_sets.FIELD, cage)
    for obj in (*cage_set.members, *cage_set.originals):
        modifier = display.nodes_modifier(field.shown_by(obj), field.FOLLOW)
        if modifier is not None and field.followed(obj) == cage:
            display.set_input(modifier, "Field", own)
            space = display.get_input(modifier, "Space") or obj
            if placement.carrier_of(own)[0] != space and space != field.shown_by(obj):
                placement.carry(own, space)
            field.shown_by(obj).update_tag()
    return True


def _set_apart(cage_set: CageSet) -> None:
    """Gives a copy colours, and a collection, that are its own."""
    noted = cage_set.record
    noted.marker = ""
    noted.colours = -1
    noted.colours = selection.colours_of(cage_set)
    noted.title = cage_set.source.name if cage_set.source is not None else noted.title
    for level, obj in enumerate(cage_set.members):
        display.apply_display(obj, level, noted.colours)
    if selection.drawer_of(cage_set) is None:
        home = selection.home_of(selection.scene_of(bpy.context), cage_set.source)
        drawer = bpy.data.collections.new(cage_set.name)
        home.children.link(drawer)
        fields = [cage_sets.helpers_of(cage, cage_sets.FIELD, cage_sets.LINES) for cage in cage_set.cages]
        for obj in (*cage_set.members, *(helper for helpers in fields for helper in helpers)):
            hidden = obj.hide_get()
            drawer.objects.link(obj)
            for other in [each for each in obj.users_collection if each != drawer and selection.is_drawer(each)]:
                other.objects.unlink(obj)
            obj.hide_set(hidden)


@bpy.app.handlers.persistent  # type: ignore[untyped-decorator]
def on_import(context: Any) -> None:
    """Removes the objects that *Append* makes of meshes that bound objects keep for later."""
    came = {item.id for item in context.import_items}
    parked = {mesh for obj in bpy.data.objects if (mesh := cage_sets.before(obj).mesh) in came and mesh is not None}
    for stray in [obj for obj in bpy.data.objects if obj.data in parked and cage_sets.node_of(obj).role == "NONE"]:
        bpy.data.objects.remove(stray)
