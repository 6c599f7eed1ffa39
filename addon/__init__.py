"""The add-on: the only code that uses Blender."""

from __future__ import annotations

from . import operators, properties, watch
from .ui import menus, online_manual, overlay, panels, preferences

# In the order of registration; each knows only those before it.
_MODULES = (properties, operators, watch, panels, preferences, menus, online_manual, overlay)


def register() -> None:
    for module in _MODULES:
        module.register()


def unregister() -> None:
    for module in reversed(_MODULES):
        module.unregister()
