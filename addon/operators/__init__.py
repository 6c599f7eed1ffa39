"""The operators, thin wrappers of the public functions of other rooms."""

from __future__ import annotations

import bpy

from ..generation.job import end_all
from ..properties.kinds import registration
from . import animation, bind, cutout, files, generate, objects, puppet, verify

_ROOMS = (generate, verify, bind, puppet, animation, files, objects, cutout)
CLASSES = [
    found
    for room in _ROOMS
    for found in vars(room).values()
    if isinstance(found, type) and issubclass(found, (bpy.types.Operator, bpy.types.FileHandler, bpy.types.Panel))
    if found.__module__ == room.__name__
]

register, _unregister = registration(CLASSES)


def unregister() -> None:
    end_all(bpy.context)  # Blender drops a running operator whose class is unregistered, without calling cancel
    _unregister()
