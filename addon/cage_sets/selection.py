"""The selection: the sets of cages that it is about, what of them may be changed, and where new objects go."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import bpy
from bpy.types import Collection, Context, Object, Scene

from ..errors import UserError
from . import MOVERS, CageSet, has_node, level_of


def depth_of(obj: Object) -> int:
    """The place of an object in its nest, from the inside out: inner cages below 0, 0 for the drawing, cages above."""
    level, cage_set = level_of(obj) or 0, CageSet.of(obj) if level_of(obj) else None
    return -level if cage_set is not None and cage_set.inside else level


def with_parts(drawings: Iterable[Object], *, inside: bool = False) -> list[list[Object]]:
    """Each drawing, or in its place all drawings of the set that it shares with others: what acts on one of them acts
    on all.
    """
    groups: dict[Object, list[Object]] = {}
    for obj in drawings:
        cage_set = CageSet.beside(obj, inside=inside) if level_of(obj) is None else None
        shared = cage_set.parts if cage_set is not None else []
        if not any(obj in group for group in groups.values()):
            groups[obj] = shared if obj in shared and len(shared) > 1 else [obj]
    return list(groups.values())


def colours_of(cage_set: CageSet | None) -> int:
    """The number of the colours of a set; of none, one that no set has."""
    if cage_set is not None and cage_set.record.colours >= 0:
        return int(cage_set.record.colours)
    used = {each.record.colours for each in CageSet.everywhere()}
    return next(number for number in range(len(used) + 1) if number not in used)


def drawer_of(cage_set: CageSet) -> Collection | None:
    """The collection that the cages of a set lie in, if nothing else of others does."""
    own = {*cage_set.members, *(each for obj in cage_set.members for each in obj.children)}
    homes = cage_set.finest.users_collection
    return next((home for home in homes if own.issuperset(home.objects) and not len(home.children)), None)


def home_of(scene: Scene, source: Object | None) -> Collection:
    """The collection for the cages of an object: its own one in the scene, or the scene's."""
    own = source.users_collection if source is not None else ()
    there = set(scene.collection.children_recursive)
    return next((c for c in own if c in there and c.is_editable and not is_drawer(c)), scene.collection)


def is_drawer(collection: Collection) -> bool:
    """Whether a collection was made for cages."""
    return any(level_of(obj) == 0 for obj in collection.objects)


def scene_of(context: Context) -> Scene:
    """The scene of a context; operators and panels always have one."""
    assert context.scene is not None
    return context.scene


def scene_again(name: str) -> Scene:
    """The scene of that name after a job. Raises: UserError if it is gone."""
    scene = bpy.data.scenes.get(name)
    if scene is None:
        raise UserError("The scene of the drawing is gone, so its cages were discarded")
    return scene


def check_free(objects: Iterable[Object]) -> None:
    """Raises: UserError if an output object is being edited, or cannot be changed. Overrides lose additions."""
    for obj in objects:
        if obj.mode != "OBJECT":
            raise UserError(f"'{obj.name}' is being edited: go back to Object Mode first")
        check_local(obj)


def check_local(obj: Object) -> None:
    """Raises: UserError if an object belongs to another file. Overrides lose additions."""
    if obj.override_library is not None:
        raise UserError(
            f"'{obj.name}' is an override of another file: it can be posed and keyed here, but for this open that "
            "file, or make it local first (Object > Relations > Make Local)"
        )
    if not obj.is_editable or not obj.data.is_editable:
        raise UserError(f"'{obj.name}' is linked from another file: open that file, or make it local first")


def set_of_active(context: Context) -> CageSet | None:
    """The set that the active object belongs to, is a drawing of or moves: the one around the drawing first."""
    active = context.view_layer.objects.active
    return CageSet.of(active) if active is not None else None


def chosen(context: Context) -> list[Object]:
    """The active object and all selected ones. An original that its animation hides is active, but not selected."""
    active = context.view_layer.objects.active
    return list(dict.fromkeys((*((active,) if active is not None else ()), *context.selected_objects)))


def sets_of_chosen(context: Context, *, both: bool = True) -> list[CageSet]:
    """The sets of all these; of a drawing with cages around it and inside `both`, or the former."""
    return list(each_of_chosen(context, both=both))


def each_of_chosen(context: Context, *, both: bool = True) -> Iterator[CageSet]:
    """The same, one by one."""
    seen = set()
    for obj in chosen(context):
        if not (has_node(obj) or obj.type in MOVERS or obj.library is not None):
            continue
        for each in CageSet.all_of(obj)[: None if both or obj.type in MOVERS else 1]:
            if each not in seen:
                seen.add(each)
                yield each


def select(context: Context, *objects: Object) -> None:
    """Makes the objects the only selected ones, and the last of them the active one."""
    for other in context.selected_objects:
        other.select_set(False)
    for obj in objects:
        obj.select_set(True)
    context.view_layer.objects.active = objects[-1]
