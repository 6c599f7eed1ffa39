"""The add-on: the only code that uses Blender."""

from __future__ import annotations

from . import operators
from .binding import adoption, sweep
from .following import claims
from .properties import schema
from .ui import doors, menus, online_manual, overlay, panels, preferences

# In the order of registration; each knows only those before it.
_ROOMS = (schema, operators, adoption, sweep, claims, doors, panels, preferences, menus, online_manual, overlay)


def register() -> None:
    for room in _ROOMS:
        room.register()


def unregister() -> None:
    for room in reversed(_ROOMS):
        room.unregister()
