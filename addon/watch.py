"""The one watcher: what the add-on does when something was updated, a file is loaded or saved, or objects are appended.

An update costs little: only updated objects that are in a set are looked at, and nothing is computed of their cages.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any, NamedTuple

import bpy
from bpy.types import Context, Depsgraph, Object, Scene
from mathutils import Matrix, Vector

from . import cage_sets
from .bind import copies, field, sweep
from .blender import mesh_data
from .cage_sets import CageSet, changes
from .drawing import placement
from .errors import last_fault
from .motion import live
from .puppets import duplicates

# Points of a drawing that tell whether its transform was applied, and their largest relative error then.
MAX_CORNERS, UNMOVED = 8, 1e-5


class Place(NamedTuple):
    """A drawing at its last update: where it stood, and some of its points."""

    matrix: Matrix
    corners: list[Vector]


# By session ID of drawings.
_stood: dict[int, Place] = {}
# The number of updates, and whether the drawings of the file were not looked at yet.
_updates, _new_file = [0], [True]


def moment(context: Context) -> tuple[int, int, float]:
    """What differs whenever something in the scene may have changed."""
    scene: Any = context.scene
    return _updates[0], scene.session_uid, scene.frame_current_final


@bpy.app.handlers.persistent  # type: ignore[untyped-decorator]
def _on_update(_scene: Scene, depsgraph: Depsgraph) -> None:
    _updates[0] += 1
    cage_sets.forget_collections()
    live.look_at(depsgraph)
    if not depsgraph.id_type_updated("OBJECT"):
        return
    drawings, cages = dict[Object, bool](), dict[Object, bool]()
    if _new_file[0]:
        _new_file[0] = False
        drawings = {obj: False for each in CageSet.everywhere() for obj in each.originals}
    for update in depsgraph.updates:
        obj: Any = update.id.original
        if not isinstance(obj, Object):
            continue
        role = cage_sets.node_of(obj).role if cage_sets.has_node(obj) else ""
        if role == cage_sets.CAGE:
            cages[obj] = update.is_updated_geometry or cages.get(obj, False)
        elif role == "NONE" or obj.library is not None:
            drawings[obj] = update.is_updated_geometry or drawings.get(obj, False)
        if obj.type == "ARMATURE":
            duplicates.look_at(obj)
    cage_sets.recheck_sets(cages)
    for obj, reshaped in drawings.items():
        _look_at(obj, cages, reshaped=reshaped)


def _look_at(obj: Object, touched: Mapping[Object, bool], *, reshaped: bool) -> None:
    """Notes the place of a drawing; cages stay where they are, however it carries them. touched: which cages have
    another shape.
    """
    before = _stood.get(obj.session_uid)
    if before is not None and not reshaped:
        _stood[obj.session_uid] = before._replace(matrix=obj.matrix_world.copy())
        return
    changes.forget(obj)
    now = _stood[obj.session_uid] = Place(obj.matrix_world.copy(), _corners(obj))
    for cage_set in CageSet.all_of(obj) if reshaped else ():
        if before is not None:
            _stay(cage_set, obj, before, now)
        if not any(map(touched.get, cage_set.cages)):  # else a pose moves both
            for each in _carried(cage_set):
                placement.keep_carried(each, obj)


def _carried(cage_set: CageSet) -> list[Object]:
    """All objects that a drawing carries."""
    helpers = (cage_sets.helpers_of(cage, cage_sets.FIELD, cage_sets.LINES) for cage in cage_set.members)
    return [*cage_set.members, *itertools.chain(*helpers)]


def _stay(cage_set: CageSet, source: Object, before: Place, now: Place) -> None:
    """Leaves cages in place when a transform of their drawing was applied, or its origin set: its points stay too."""
    if before.matrix == now.matrix or before.corners == now.corners or len(before.corners) != len(now.corners):
        return
    there, here = ([each.matrix @ point for point in each.corners] for each in (before, now))
    size = max(point.length for point in there)
    if any((one - other).length > UNMOVED * size for one, other in zip(there, here, strict=True)):
        return
    back = now.matrix.inverted_safe() @ before.matrix
    for obj in _carried(cage_set):
        if cage_sets.is_helper(obj, cage_sets.FIELD) and placement.carrier_of(obj)[0] == source:
            mesh_data.mesh_of(obj).transform(back)  # it is in the drawing's own space
            placement.carry(obj, source)
        else:
            placement.rebase(obj, source, back)
    if source == cage_set.source:
        for cage in cage_set.cages:
            field.move_offset(cage, back)


def _corners(obj: Object) -> list[Vector]:
    """The first points of a curve or mesh, in its own space."""
    if obj.type == "MESH":
        return [vertex.co.copy() for vertex in obj.data.vertices[:MAX_CORNERS]]
    splines = obj.data.splines[:MAX_CORNERS] if obj.type == "CURVE" else ()
    points = [point for spline in splines for point in (spline.bezier_points or spline.points)[:MAX_CORNERS]]
    return [point.co.to_3d() for point in points]


@bpy.app.handlers.persistent  # type: ignore[untyped-decorator]
def _on_load(*_: object) -> None:
    """Another file was opened."""
    live.stop()
    cage_sets.forget_sets()
    changes.forget()
    last_fault.clear()
    _stood.clear()
    _updates[0] += 1
    _new_file[0] = True


@bpy.app.handlers.persistent  # type: ignore[untyped-decorator]
def _on_save(*_: object) -> None:
    sweep.sweep()
    duplicates.complete_puppets()


def _handlers() -> tuple[tuple[Any, Any], ...]:
    app = bpy.app.handlers
    imported = [(app.blend_import_post, copies.on_import)] if hasattr(app, "blend_import_post") else []  # 4.3 and later
    return (
        (app.depsgraph_update_post, _on_update),
        (app.load_post, _on_load),
        (app.save_pre, _on_save),
        *imported,
    )


def register() -> None:
    for handlers, function in _handlers():
        handlers.append(function)


def unregister() -> None:
    for handlers, function in _handlers():
        handlers.remove(function)
    duplicates.stop()
    _on_load()
