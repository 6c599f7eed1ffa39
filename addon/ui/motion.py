"""The part of the sidebar about drawings that move."""

from __future__ import annotations

from typing import Any

import bpy

from ..properties.settings import copy_values, settings_of


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The button that follows an animation."""
    button: Any = layout.operator("object.nested_cages_follow", icon="ARMATURE_DATA")
    copy_values(settings_of(context), button)
    button.use_selected_as_levels = False
