"""The add-on: the only code that uses Blender."""

from __future__ import annotations

from . import operators, watch
from .properties import schema
from .ui import menus, online_manual, overlay, panels, preferences

# In the order of registration; each knows only those before it.
_ROOMS = (schema, operators, watch, panels, preferences, menus, online_manual, overlay)


def register() -> None:
    for room in _ROOMS:
        room.register()


def unregister() -> None:
    for room in reversed(_ROOMS):
        room.unregister()
