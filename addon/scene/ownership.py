"""Which objects belong to which drawing: a set of cages refers to its objects, whatever their names, collections and
scenes; the active object's output, and selection of results.
"""

from __future__ import annotations

from collections.abc import Iterable

import bpy
from bpy.types import Collection, Context, Object, Scene

from .. import record
from ..errors import UserError


def depth_of(obj: Object) -> int:
    """The place of an object in its nest, from the inside out: inner cages below 0, 0 for the drawing, cages above."""
    level = level_of(obj) or 0
    return -level if record.node_of(obj).inside else level


def level_of(obj: Object) -> int | None:
    """The level of an output object, 0 for the fine mesh; None for other objects, and for a copy of one alone."""
    if obj.type != "MESH":
        return None
    node = record.node_of(obj)
    if node.role == "NONE":
        return None
    # Without a set, a cage was copied with its drawing, or has lost its collection.
    went_along = node.of is not None and (node.home is None or node.of != source_of(node.home))
    return int(node.level) if home_of_member(obj) is not None or went_along else None


def home_of_member(obj: Object) -> Collection | None:
    """The collection of the set that an output object belongs to; None for a copy that has no set yet."""
    home: Collection | None = record.node_of(obj).home
    return home if home is not None and any(part.object == obj for part in record.of(home).levels) else None


def helpers(collection: Collection) -> list[Object]:
    """The hidden helper objects of an output, also those of a cage that is gone."""
    own, roles = set(members(collection)), (record.FIELD, record.LINES)
    shown = {obj: record.shown(obj, *roles) for obj in bpy.data.objects if record.is_helper(obj, *roles)}
    return [obj for obj, of in shown.items() if of in own or (of is None and collection in obj.users_collection)]


def is_output(collection: Collection) -> bool:
    """Whether a collection holds the output of a drawing."""
    return len(record.of(collection).levels) > 0


def is_bound(collection: Collection) -> bool:
    """Whether the cages of an output collection are bound."""
    return bool(record.of(collection).bound)


def is_inside(collection: Collection) -> bool:
    """Whether an output lies inside the drawing."""
    return bool(record.of(collection).inside)


def exists(obj: Object | None) -> bool:
    """Whether an object is in a scene: deleted ones may still be referred to."""
    if obj is None:
        return False
    # Blender knows at once whether it shows an object, but goes through all of a scene to find one by name.
    if obj.visible_get():
        return True
    return any(scene.objects.get(obj.name) == obj for scene in bpy.data.scenes) or bool(obj.users_scene)


def outputs_of(scene: Scene, *drawings: Object) -> list[Collection]:
    """The collections that hold the output of objects: of the cages around them, and then of those inside."""
    outputs, wanted = [], set(filter(_may_have_any, drawings))
    for collection in bpy.data.collections if wanted else ():
        if is_output(collection):
            sources = record.of(collection).sources
            if len(sources) and sources[0].object in wanted and members(collection):
                outputs.append(collection)
    if len(outputs) > 1:
        here = set(scene.collection.children_recursive)
        outputs.sort(key=lambda each: (is_inside(each), each not in here))
    return outputs


def _may_have_any(obj: Object) -> bool:
    """Whether an object may be a drawing in cages: told at once of most others. Linked ones cannot be marked."""
    return record.has_node(obj) or obj.library is not None


def collection_of(scene: Scene, source: Object, *, inside: bool = False) -> Collection | None:
    """The collection of the cages around an object, or of those inside, if there is one."""
    return next((c for c in outputs_of(scene, source) if is_inside(c) == inside), None)


def by_drawing(scene: Scene) -> dict[tuple[Object, bool], Collection]:
    """The output around each drawing, and the one inside: of several, one that is named after it, in the scene."""
    here, ours = set(scene.collection.children_recursive), [c for c in bpy.data.collections if is_output(c)]
    ours = sorted((c for c in ours if members(c)), key=lambda each: each not in here)
    places = [(k > 0, part.object, c) for c in ours for k, part in enumerate(record.of(c).sources)]
    outputs: dict[tuple[Object, bool], Collection] = {}
    for _, drawing, collection in sorted(places, key=lambda place: place[0]):
        outputs.setdefault((drawing, is_inside(collection)), collection)
    return outputs


def with_parts(scene: Scene, drawings: Iterable[Object], *, inside: bool = False) -> list[list[Object]]:
    """Each drawing, or in its place all drawings of the output that it shares with others: what acts on one of them
    acts on all.
    """
    known = by_drawing(scene)
    groups: dict[Object, list[Object]] = {}
    for obj in drawings:
        output = known.get((obj, inside))
        shared = [part.object for part in record.of(output).sources if exists(part.object)] if output else []
        if not any(obj in group for group in groups.values()):
            groups[obj] = shared if len(shared) > 1 else [obj]
    return list(groups.values())


def outputs_about(scene: Scene, obj: Object) -> list[Collection]:
    """The output that an object belongs to, those that it is a source of, or those whose cages it moves."""
    if level_of(obj) is not None:
        home = home_of_member(obj)
        return [home] if home is not None else []
    own = outputs_of(scene, obj)
    if own or not (_may_have_any(obj) or obj.type in {"ARMATURE", "EMPTY"}):
        return own
    sets = [c for c in bpy.data.collections if is_output(c) and members(c)]
    shared = [c for c in sets if obj in originals(c)]
    if shared or (obj.type not in {"ARMATURE", "EMPTY"} and not record.is_helper(obj, record.HANDLES)):
        return shared
    return [c for c in sets if any(getattr(m, "object", None) == obj for m in members(c)[-1].modifiers)]


def collection_about(scene: Scene, obj: Object) -> Collection | None:
    """The same; of the cages around an object and those inside, the former."""
    return next(iter(outputs_about(scene, obj)), None)


def source_of(collection: Collection) -> Object | None:
    """The source object of an output; None if it was deleted, even if the collection still refers to it."""
    sources = record.of(collection).sources
    source: Object | None = sources[0].object if len(sources) else None
    return source if exists(source) else None


def hand_over(collection: Collection, drawing: Object) -> None:
    """Names an output after another one of its drawings; deleted ones leave it."""
    others = [obj for obj in originals(collection) if obj != drawing]
    record.refer(record.of(collection).sources, [drawing, *others])
    for obj in members(collection):
        record.node_of(obj).of = drawing
    record.keep(collection)


def originals(collection: Collection) -> list[Object]:
    """The source objects of an output, and what a silhouette among them shows; without deleted ones."""
    drawings = [part.object for part in record.of(collection).sources if exists(part.object)]
    drawings += [obj for obj in (record.shown_in(drawings[0]) if drawings else ()) if exists(obj)]
    return list(dict.fromkeys(drawings))


def colours_of(collection: Collection) -> int:
    """The number of the colours of an output, one that no other output has."""
    own = int(record.of(collection).colours)
    if own >= 0:
        return own
    used = {record.of(other).colours for other in bpy.data.collections if is_output(other)}
    return next(number for number in range(len(used) + 1) if number not in used)


def member(collection: Collection, level: int) -> Object | None:
    """The object of a level of an output; level 0 is the fine mesh."""
    return next((obj for obj in members(collection) if record.node_of(obj).level == level), None)


def members(collection: Collection) -> list[Object]:
    """All output objects of a set, the fine mesh first, wherever they are; without deleted ones and copies."""
    return [part.object for part in record.of(collection).levels if exists(part.object)]


def home_of(scene: Scene, source: Object | None) -> Collection:
    """The collection for the output of an object: its own one in the scene, or the scene's."""
    own = source.users_collection if source is not None else ()
    there = set(scene.collection.children_recursive)
    return next((c for c in own if c in there and c.is_editable and not is_output(c)), scene.collection)


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
        if obj.override_library is not None:
            raise UserError(
                f"'{obj.name}' is an override of another file: it can be posed and keyed here, but for this open that "
                "file, or make it local first (Object > Relations > Make Local)"
            )
        if not obj.is_editable or not obj.data.is_editable:
            raise UserError(f"'{obj.name}' is linked from another file: open that file, or make it local first")


def collection_of_active(context: Context) -> Collection | None:
    """The output that the active object belongs to or is the source of."""
    return next(iter(outputs_of_active(context)), None)


def outputs_of_active(context: Context) -> list[Collection]:
    """The same, and of a drawing with cages around it and inside both."""
    active = context.view_layer.objects.active
    return outputs_about(scene_of(context), active) if active is not None else []


def chosen(context: Context) -> list[Object]:
    """The active object and all selected ones. An original that its animation hides is active, but not selected."""
    active = context.view_layer.objects.active
    return list(dict.fromkeys((*((active,) if active is not None else ()), *context.selected_objects)))


def outputs_of_chosen(context: Context, *, both: bool = True) -> list[Collection]:
    """The outputs of all these; of a drawing with cages around it and inside `both`, or the former."""
    per_object = [outputs_about(scene_of(context), obj) for obj in chosen(context)]
    moved = [obj.type in {"ARMATURE", "EMPTY"} for obj in chosen(context)]
    few = [outputs if both or many else outputs[:1] for outputs, many in zip(per_object, moved, strict=True)]
    return list(dict.fromkeys(output for outputs in few for output in outputs))


def select(context: Context, *objects: Object) -> None:
    """Makes the objects the only selected ones, and the last of them the active one."""
    for other in context.selected_objects:
        other.select_set(False)
    for obj in objects:
        obj.select_set(True)
    context.view_layer.objects.active = objects[-1]
