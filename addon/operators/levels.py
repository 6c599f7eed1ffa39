"""Buttons next to the list of levels."""

from __future__ import annotations

import bpy

from ..properties import level_list
from ..properties.kinds import whole
from ..properties.settings import settings_of
from .base import Operator


class LevelOperator(Operator):
    """Base of operators on the list of levels; most need a chosen entry."""

    bl_options = {"REGISTER", "UNDO", "INTERNAL"}
    modes = ()
    during_jobs = True

    @classmethod
    def unavailable(cls, context: bpy.types.Context) -> str:
        settings = settings_of(context)
        return "" if settings.level_index < len(settings.level_list) else "Choose a level in the list"


class SCENE_OT_nested_cages_level_add(LevelOperator, bpy.types.Operator):
    """Add a coarser level, and show the levels as a list"""

    bl_label = "Add Level"

    @classmethod
    def unavailable(cls, _context: bpy.types.Context) -> str:
        return ""

    def run(self, context: bpy.types.Context) -> None:
        level_list.add(settings_of(context))


class SCENE_OT_nested_cages_level_remove(LevelOperator, bpy.types.Operator):
    """Remove the chosen level; at least one stays"""

    bl_label = "Remove Level"

    @classmethod
    def unavailable(cls, context: bpy.types.Context) -> str:
        return (
            "At least one level is needed" if len(settings_of(context).level_list) < 2 else super().unavailable(context)
        )

    def run(self, context: bpy.types.Context) -> None:
        level_list.remove(settings_of(context))


class SCENE_OT_nested_cages_level_move(LevelOperator, bpy.types.Operator):
    """Move the chosen level up or down in the list, which goes from the inside out"""

    bl_label = "Move Level"

    step: whole("Step", "Lines to move it down; up if negative", default=1, min=-1, max=1)

    def run(self, context: bpy.types.Context) -> None:
        level_list.move(settings_of(context), self.step)
