"""The operators, thin wrappers of the public functions of other packages."""

from __future__ import annotations

import bpy

from ..blender.jobs import end_all
from ..blender.props import registration
from . import animation, bind, cutout, files, generate, puppet, verify

_MODULES = (generate, verify, bind, puppet, animation, files, cutout)
CLASSES = [
    found
    for module in _MODULES
    for found in vars(module).values()
    if isinstance(found, type) and issubclass(found, (bpy.types.Operator, bpy.types.FileHandler, bpy.types.Panel))
    if found.__module__ == module.__name__
]

register, _unregister = registration(CLASSES)


def unregister() -> None:
    end_all(bpy.context)  # Blender drops a running operator whose class is unregistered, without calling cancel
    _unregister()
