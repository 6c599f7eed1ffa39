"""Before a file is saved, what was deleted is let go: pointers to it would keep it in the file for ever."""

from __future__ import annotations

import bpy
from bpy.types import Collection, Object

from .. import cage_sets
from ..animation import visibility
from ..blender import display, shape_keys
from ..cage_sets import CageSet
from ..drawing import placement
from .copies import complete


def sweep() -> None:
    """Removes deleted drawings, cages and helpers, and what is left of sets without any, unless something uses it.

    The fine mesh stays as long as its set, and so do all cages of a bound one: what is in them still follows them.
    """
    if not _deleted():
        return
    complete()  # what is shared with copies may go
    gone, drawers, left = _deleted(), set[Collection](), set[Object]()
    for cage_set in _sets():
        if gone.issuperset({*cage_set.chain(), *cage_set.drawings()}):
            left |= _left_of(cage_set, drawers)
    gone = _deleted() | left
    for cage_set in _sets():
        if not gone.issuperset(cage_set.chain()):
            gone -= {cage_sets.node_of(cage_set.finest).inner}
            if cage_set.bound:
                gone.difference_update(cage_set.chain())
        if cage_set.finest in gone:
            _hand_over(cage_set, gone)
    for obj in gone:
        _bridge(obj)
        for modifier in list(obj.modifiers):
            display.remove_modifier(obj, modifier)
        cage_sets.remove(obj)
    for obj in [obj for obj in bpy.data.objects if cage_sets.has_node(obj) and obj not in gone]:
        node = cage_sets.new_node(obj)
        for items in (node.sets, node.parts, node.helpers, node.record.parts):
            if not gone.isdisjoint(cage_sets.objects_in(items)):
                cage_sets.drop(items, list(gone))
        if placement.carrier_of(obj)[0] in gone and obj.is_editable:
            place = obj.matrix_world.copy()
            placement.carry(obj, None)
            obj.matrix_world = place
    users = bpy.data.user_map(subset=gone)
    unused = [obj for obj in gone if users[obj] <= gone | drawers | set(bpy.data.scenes)]
    shape_keys.discard(unused, [obj.data for obj in unused if isinstance(obj.data, bpy.types.Mesh)], [])
    for home in [home for home in drawers if not len(home.all_objects)]:
        bpy.data.collections.remove(home)
    cage_sets.forget_sets()


def _deleted() -> set[Object]:
    """Objects that are or were in a set, and are in no collection any more."""
    homes = (*bpy.data.collections, *(scene.collection for scene in bpy.data.scenes))
    there = {obj for home in homes for obj in home.objects}  # instances show collections that are in no scene
    ours = [obj for obj in bpy.data.objects if cage_sets.has_node(obj) and obj not in there]
    return {obj for obj in ours if not obj.use_fake_user and obj.library is None}


def _sets() -> list[CageSet]:
    """All chains, also of deleted cages."""
    return [CageSet(obj) for obj in bpy.data.objects if cage_sets.is_finest(obj)]


def _left_of(cage_set: CageSet, drawers: set[Collection]) -> set[Object]:
    """The hidden objects of a set of which all that is seen was deleted, without their animation."""
    fine = cage_sets.node_of(cage_set.finest).inner
    if fine is None or cage_sets.node_of(fine).outer != cage_set.finest:
        return set()
    visibility.leave(cage_set)
    dropped = visibility.stop_playing(cage_set)
    for scene in bpy.data.scenes:
        visibility.settle(scene, [dropped])
    drawers.update(fine.users_collection)
    roles, owners = (cage_sets.FIELD, cage_sets.LINES, cage_sets.PROXY), (fine, *cage_set.chain(), *cage_set.drawings())
    helpers = [each for obj in owners for each in cage_sets.helpers_of(obj, *roles)]
    return {fine, *helpers}


def _hand_over(cage_set: CageSet, gone: set[Object]) -> None:
    """Moves the record of a set whose finest cage was deleted to the next one."""
    heir = next((cage for cage in cage_set.chain() if cage not in gone), None)
    if heir is not None:
        drawings = cage_set.drawings()
        cage_sets.assign(cage_sets.new_node(heir).record, cage_sets.values(cage_set.record))
        for obj in drawings:
            if obj.library is None:
                cage_sets.refer(cage_sets.new_node(obj).sets, [heir])


def _bridge(obj: Object) -> None:
    """Takes a deleted cage out of its chain."""
    node = cage_sets.node_of(obj)
    inner, outer = node.inner, node.outer
    if inner is not None and cage_sets.node_of(inner).outer == obj:
        cage_sets.new_node(inner).outer = outer
    if outer is not None and cage_sets.node_of(outer).inner == obj:
        cage_sets.new_node(outer).inner = inner
