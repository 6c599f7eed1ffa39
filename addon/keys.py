"""Names of the custom properties and attributes that the add-on stores in files; files contain them, so they never
change.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import bpy
from bpy.types import Object

# All custom properties begin with this.
PREFIX = "nested_cages_"


def _names(words: str) -> list[str]:
    """Names of custom properties from what follows their prefix."""
    return [PREFIX + word for word in words.split()]


# Of an output collection: its source object, and the method that it is bound by.
SOURCE, BOUND = _names("source bound")

# Of the objects of an output: the level, 0 for the fine mesh, and the number of vertices. Of cages: the report, and
# whether they lie inside the drawing, which a collection has too.
LEVEL, VERTICES, INSIDE, CLEARANCE, EXCESS = _names("level vertices inside clearance excess")
BEGINS_FROM, SECONDS, NOTES, NEED, CERTIFICATE = _names("begins_from seconds notes need certificate")
# The result of Verify Cages: in a few words, and as a sentence.
CHECK, FINDING = _names("check finding")
# When a cage plays its phases, in frames, the last one also of a collection.
FLOW_START, REINFLATION_START, TIGHTENING_START, END = _names("flow_start reinflation_start tightening_start end")

# Attributes of meshes. A bound vertex: its position when bound. A vertex of a field: its weights, one attribute per
# vertex of the cage, and how far they move it.
REST, WEIGHT, MOTION = _names("rest weight_ motion")

# Property of GeoJSON features with y pointing down.
(Y_DOWN,) = _names("y_down")


def store(owner: bpy.types.ID, properties: dict[str, Any]) -> None:
    """Sets custom properties."""
    for key, value in properties.items():
        owner[key] = value


def remove(owner: bpy.types.ID, names: Iterable[str]) -> None:
    """Removes custom properties, those that are there."""
    for key in names:
        if key in owner.keys():  # noqa: SIM118 - an ID is no mapping
            del owner[key]


def ours(owner: bpy.types.ID) -> list[str]:
    """Names of the add-on's custom properties of a data-block."""
    return [key for key in owner.keys() if key.startswith(PREFIX)]  # noqa: SIM118 - an ID is no mapping


def found_object(identity: int | None, name: str = "") -> Object | None:
    """The object with a session ID, even after renaming, undo and redo; with its former name it is found at once."""
    likely = bpy.data.objects.get(name)
    if likely is not None and likely.session_uid == identity:
        return likely
    return next((obj for obj in bpy.data.objects if obj.session_uid == identity), None)
