"""Helper objects, which show, fill or move another one; bound objects and the scene's range as they were."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import bpy
import numpy as np
from bpy.types import Mesh, Object, Scene
from mathutils import Matrix

from .cage_set import drop, new_node, node_of, objects_in, refer

# Roles of helpers.
FIELD, LINES, PROXY, FILL, HANDLES = "FIELD", "LINES", "PROXY", "FILL", "HANDLES"


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
