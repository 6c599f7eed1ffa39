"""What an object is in a set, what helper objects show, and bound objects and the scene's range as they were."""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import bpy
import numpy as np
from bpy.types import Mesh, Object, Scene
from mathutils import Matrix

FINE, CAGE = "FINE", "CAGE"
HOLDS, FAULT, UNJUDGED = "HOLDS", "FAULT", "UNJUDGED"
# Code of notes on a distance or an excess, and the beginning of findings' codes.
TOLERANCE, CHECK = "note.tolerance", "check."
# Roles of helpers.
FIELD, LINES, PROXY, FILL, HANDLES = "FIELD", "LINES", "PROXY", "FILL", "HANDLES"


def node_of(obj: Object) -> Any:
    """What an object is in its set. To read a group of properties of Blender's writes one, so others get no own."""
    return new_node(obj) if has_node(obj) else NO_NODE


def has_node(obj: Object) -> bool:
    """Whether an object is or was in a set, as a member, helper or drawing; buttons look no further if it was not."""
    return bool(obj.is_property_set("nested_cages_member"))


def new_node(obj: Object) -> Any:
    """The same as `node_of`, to take an object into a set."""
    return obj.nested_cages_member  # type: ignore[attr-defined]


def _unset(**values: Any) -> Any:
    """A group of properties that cannot be changed."""
    return namedtuple("Unset", values)(**values)


# What is read of an object without a set.
NO_RECORD = _unset(
    parts=(), markers=(), title="", bound="", kinds="", inside=False, playing=False, known=False, moving=False,
    animated=False, frames=(0, 0, 0), colours=-1, settings=None, drawn="",
)  # fmt: skip
NO_NODE = _unset(
    role="NONE", inner=None, outer=None, sets=(), record=NO_RECORD, helpers=(), shows=None, thickness=0.0, parts=(),
    before=_unset(mesh=None), stamp="", notes=(), check="NONE",
)  # fmt: skip


def objects_in(items: Any) -> list[Object]:
    """The objects of a list of references."""
    return [item.object for item in items if item.object is not None]


def refer(items: Any, objects: Iterable[Object]) -> None:
    """Adds objects to a list of references that are not in it."""
    known = objects_in(items)
    for obj in objects:
        if obj not in known:
            items.add().object = obj


def drop(items: Any, gone: Sequence[Object]) -> None:
    """Removes objects from a list of references, and what no longer refers to one."""
    for number in reversed([k for k, item in enumerate(items) if item.object is None or item.object in gone]):
        items.remove(number)


def exists(obj: Object | None) -> bool:
    """Whether an object is in a collection or a view: deleted ones may still be referred to."""
    if obj is None or obj.visible_get() or obj.hide_get():
        return obj is not None
    # Blender knows at once whether a view shows an object, but goes through all of a collection to find one.
    if obj.session_uid not in _in_collections:
        _in_collections[obj.session_uid] = bool(obj.users_collection)
    return _in_collections[obj.session_uid]


# Whether objects that no view shows are in a collection, by session ID, until something changes.
_in_collections: dict[int, bool] = {}


def forget_collections() -> None:
    """Objects may be in other collections."""
    _in_collections.clear()


def make_helper(obj: Object, role: str, shows: Object, thickness: float = 0.0) -> None:
    """Notes what an object shows, fills or moves, which knows of it."""
    node, items = new_node(obj), new_node(shows).helpers
    node.role, node.shows, node.thickness = role, shows, thickness
    drop(items, ())
    refer(items, [obj])


def helpers_of(obj: Object, *roles: str) -> list[Object]:
    """The helpers of some roles that an object has; a copy has none until it gets its own."""
    return [each for each in objects_in(node_of(obj).helpers) if shown(each, *roles) == obj]


def shown(obj: Object, *roles: str) -> Object | None:
    """What a helper of some roles shows, fills or moves; None if it is none, or if that is gone."""
    node = node_of(obj)
    return node.shows if node.role in roles else None


def is_helper(obj: Object, *roles: str) -> bool:
    """Whether an object has one of some roles, whatever became of what it shows."""
    return node_of(obj).role in roles


def shown_in(silhouette: Object) -> list[Object]:
    """The objects that a silhouette shows."""
    return objects_in(node_of(silhouette).parts)


def show_in(silhouette: Object, parts: Sequence[Object]) -> None:
    """Notes what a silhouette shows; its parts know of it."""
    refer(new_node(silhouette).parts, parts)
    for part in parts:
        if part.library is None:
            refer(new_node(part).sets, [silhouette])


def range_of(scene: Scene) -> tuple[int, int, int, int] | None:
    """First and last frame of a scene before the animation, and as it set them; None if it did not."""
    playing: Any = scene.nested_cages_playing  # type: ignore[attr-defined]
    return (*playing.before, *playing.ours) if playing.known else None


def set_range(scene: Scene, given: tuple[int, int, int, int] | None) -> None:
    """Notes the frames of a scene before the animation and as it set them; None: it does not any more."""
    playing: Any = scene.nested_cages_playing  # type: ignore[attr-defined]
    playing.known = given is not None
    if given is not None:
        playing.before, playing.ours = given[:2], given[2:]


class Before(NamedTuple):
    """A bound object as it was: mesh, own transform, and whether it was hidden."""

    mesh: Mesh | None = None
    matrix: Matrix | None = None
    hidden: tuple[bool, ...] = ()


def before(obj: Object) -> Before:
    """The object before it was bound; nothing if it is not."""
    stored = node_of(obj).before
    if stored.mesh is None:
        return Before()
    return Before(stored.mesh, Matrix(np.reshape(stored.matrix[:], (4, 4)).tolist()), tuple(stored.hidden))


def set_before(obj: Object, given: Before) -> None:
    """Notes how an object is before it is bound; without a mesh it is not bound any more."""
    stored, matrix = new_node(obj).before, given.matrix if given.matrix is not None else Matrix()
    stored.mesh, stored.matrix = given.mesh, np.ravel(np.array(matrix)).tolist()
    stored.hidden = (*given.hidden, False, False, False)[:3]


def values(group: Any) -> dict[str, Any]:
    """The properties of a group as plain values; those of an unset pointer to a group are there too."""
    plain: dict[str, Any] = {}
    for prop in group.bl_rna.properties:
        name, value = prop.identifier, getattr(group, prop.identifier)
        if name == "rna_type":
            continue
        if prop.type == "COLLECTION":
            plain[name] = [values(item) for item in value]
        elif prop.type == "POINTER" and isinstance(value, bpy.types.PropertyGroup):
            plain[name] = values(value)
        elif getattr(prop, "is_array", False):
            plain[name] = tuple(value)
        else:
            plain[name] = set(value) if isinstance(value, set) else value
    return plain


def assign(group: Any, given: dict[str, Any]) -> None:
    """Sets the properties of a group to `values` of one."""
    for name, value in given.items():
        if isinstance(value, list):
            items = getattr(group, name)
            items.clear()
            for item in value:
                assign(items.add(), item)
        elif isinstance(value, dict):
            assign(getattr(group, name), value)
        else:
            setattr(group, name, value)
