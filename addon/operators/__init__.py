"""The operators, thin wrappers of the public functions of other rooms."""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from ..generation.job import end_all
from ..properties.kinds import registration
from . import animation, bind, cutout, files, generate, objects, puppet, verify
from .base import last_fault

_ROOMS = (generate, verify, bind, puppet, animation, files, objects, cutout)
CLASSES = [
    found
    for room in _ROOMS
    for found in vars(room).values()
    if isinstance(found, type) and issubclass(found, (bpy.types.Operator, bpy.types.FileHandler, bpy.types.Panel))
    if found.__module__ == room.__name__
]

_register, _unregister = registration(CLASSES)


@persistent  # type: ignore[untyped-decorator]
def _forget_fault(*_: object) -> None:
    """The fault is one of the file before."""
    last_fault.clear()


def register() -> None:
    _register()
    bpy.app.handlers.load_post.append(_forget_fault)


def unregister() -> None:
    bpy.app.handlers.load_post.remove(_forget_fault)
    end_all(bpy.context)  # Blender drops a running operator whose class is unregistered, without calling cancel
    _unregister()
