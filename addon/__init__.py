"""The add-on: the only code that uses Blender."""

from __future__ import annotations

from . import operators
from .binding import copies, sweep
from .following import claims
from .properties import schema
from .puppets import duplicates
from .record import cage_set
from .ui import doors, menus, online_manual, overlay, panels, preferences

# In the order of registration; each knows only those before it.
_ROOMS = (
    *(schema, cage_set, operators, copies, sweep, claims, duplicates),
    *(doors, panels, preferences, menus, online_manual, overlay),
)


def register() -> None:
    for room in _ROOMS:
        room.register()


def unregister() -> None:
    for room in reversed(_ROOMS):
        room.unregister()
