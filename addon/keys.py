"""Names of the attributes that the add-on stores in files; files contain them, so they never change."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.types import Object

# All of them begin with this.
PREFIX = "nested_cages_"


def _names(words: str) -> list[str]:
    """Names from what follows their prefix."""
    return [PREFIX + word for word in words.split()]


# Attributes of meshes. A bound vertex: its position when bound. A vertex of a field: its weights, one attribute per
# vertex of the cage. A vertex of a bound cage that is evaluated: where it is in the space of the drawing. A layer of
# bound Grease Pencil: the matrix to the space of its object.
REST, WEIGHT, POSE, SPACE = _names("rest weight_ pose space")

# Of bones of puppets, and of the hidden meshes that these bend: the name of the part. Of the bones: the angles within
# which nothing folds, of which limb they are, and how long they were made; of bones to move them by: what they are for.
# Of the armature: which way it looks; of a hidden mesh: weights as they were solved, one attribute per bone of the
# part; of a drawing: the part that it belongs to.
# Of what keeps joints painted: that it is a cap.
PART, PROVED, LIMB, LENGTH, CONTROL, AHEAD, SOLVED, DRAWN, CAP = _names(
    "part proved limb length control ahead solved_ drawn cap"
)
# Of an armature of a painting: width and height of the canvas in pixels, and metres per pixel, and its puppet as it was
# made; of its meshes: their names in it, path and id of the layer, and how it blends.
CANVAS, MADE, LAYER, BLEND = _names("canvas made layer blend")

# Of an image: that it is the gradient of a shape.
(GRADIENT,) = _names("gradient")

# Property of GeoJSON features with y pointing down.
(Y_DOWN,) = _names("y_down")


def store(owner: bpy.types.ID, properties: dict[str, Any]) -> None:
    """Sets custom properties."""
    for key, value in properties.items():
        owner[key] = value


def found_object(identity: int | None, name: str = "") -> Object | None:
    """The object with a session ID, even after renaming, undo and redo; with its former name it is found at once."""
    likely = bpy.data.objects.get(name)
    if likely is not None and likely.session_uid == identity:
        return likely
    return next((obj for obj in bpy.data.objects if obj.session_uid == identity), None)
