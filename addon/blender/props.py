"""Kinds of properties by name and description; further options are those of Blender's own functions. All can be
overridden: an override would point into its library again after its file was loaded.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import bpy
from bpy import props

OVERRIDABLE: Any = {"override": {"LIBRARY_OVERRIDABLE"}}


def flag(name: str, description: str, **options: Any) -> Any:
    """A switch, off unless it has another default."""
    return props.BoolProperty(name=name, description=description, **OVERRIDABLE, **options)


def whole(name: str, description: str, **options: Any) -> Any:
    """A whole number, 0 by default."""
    return props.IntProperty(name=name, description=description, **OVERRIDABLE, **options)


def number(name: str, description: str, **options: Any) -> Any:
    """A number, 0 by default."""
    return props.FloatProperty(name=name, description=description, **OVERRIDABLE, **options)


def length(name: str, description: str, **options: Any) -> Any:
    """A length of the scene, 0 for none."""
    usual = {"min": 0.0, "soft_max": 1.0, "precision": 4, "step": 1, "subtype": "DISTANCE", "unit": "LENGTH"}
    return number(name, description, **(usual | options))


def text(name: str, description: str, **options: Any) -> Any:
    """A text, empty by default."""
    return props.StringProperty(name=name, description=description, **OVERRIDABLE, **options)


def choice(name: str, description: str, items: Sequence[tuple[str, str, str]], **options: Any) -> Any:
    """One of several, the first by default; or with the option ENUM_FLAG several of them."""
    return props.EnumProperty(name=name, description=description, items=items, **OVERRIDABLE, **options)


def row(kind: Any, name: str, description: str, size: int, **options: Any) -> Any:
    """Several values of a kind, one of Blender's functions for vectors."""
    return kind(name=name, description=description, size=size, **OVERRIDABLE, **options)


def pointer(name: str, description: str, kind: type) -> Any:
    """A data-block, none by default, or a group of properties."""
    return props.PointerProperty(name=name, description=description, type=kind, **OVERRIDABLE)


def several(name: str, description: str, kind: type) -> Any:
    """A list of groups of properties, to which an override can add."""
    return props.CollectionProperty(
        name=name, description=description, type=kind, override={"LIBRARY_OVERRIDABLE", "USE_INSERTION"}
    )


def registration(classes: Sequence[type]) -> tuple[Callable[[], None], Callable[[], None]]:
    """Functions that register classes in order, and unregister them in reverse."""
    made: Any = bpy.utils.register_classes_factory  # the stubs return nothing
    register, unregister = made(classes)
    return register, unregister
