"""What helper objects of a set show, and bound objects and the scene's range as they were."""

from __future__ import annotations

from collections import namedtuple
from typing import Any, NamedTuple

import numpy as np
from bpy.types import Mesh, Object, Scene
from mathutils import Matrix

FINE, CAGE = "FINE", "CAGE"
HOLDS, FAULT = "HOLDS", "FAULT"
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


# What is read of a collection and of an object without a set.
NO_RECORD = _unset(sources=(), levels=(), markers=(), bound="", inside=False, playing=False, colours=-1)
NO_NODE = _unset(
    role="NONE", level=-1, inside=False, of=None, home=None, shows=None, thickness=0.0, parts=(), link="",
    link_error=0.0, before=_unset(mesh=None), kept=NO_RECORD, stamp="", notes=(), check="NONE",
)  # fmt: skip


def make_helper(obj: Object, role: str, shows: Object, thickness: float = 0.0) -> None:
    """Notes what an object shows, fills or moves."""
    node = new_node(obj)
    node.role, node.shows, node.thickness = role, shows, thickness


def shown(obj: Object, *roles: str) -> Object | None:
    """What a helper of some roles shows, fills or moves; None if it is none, or if that is gone."""
    node = node_of(obj)
    return node.shows if node.role in roles else None


def is_helper(obj: Object, *roles: str) -> bool:
    """Whether an object has one of some roles, whatever became of what it shows."""
    return node_of(obj).role in roles


def lines_of(helper: Object) -> tuple[Object | None, float]:
    """The object whose lines a helper shows, and their thickness."""
    return shown(helper, LINES), float(node_of(helper).thickness)


def shown_in(silhouette: Object) -> list[Object]:
    """The objects that a silhouette shows."""
    return [part.object for part in node_of(silhouette).parts if part.object is not None]


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


def link(obj: Object) -> tuple[str, float]:
    """The method that an object follows its cage by, empty if it does not, and its error at rest."""
    node = node_of(obj)
    return node.link, node.link_error


def set_link(obj: Object, method: str, error: float) -> None:
    """Notes the method that an object follows its cage by; empty: none."""
    node = new_node(obj)
    node.link, node.link_error = method, error
