"""Presets: a table, and the user's own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel
from bpy.types import Context

from ..errors import UserError
from ..properties import groups
from ..properties.kinds import text
from ..properties.settings import NAMES, settings_of
from .base import Named, Operator

# Folder of the user's own presets.
FOLDER = "nested_cages"
# Name, description, and settings that differ from the defaults.
PRESETS: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "Collision": (
        "One outline of very few vertices around each drawing, without the animation of how it forms",
        {"levels": "12", "decimation": "OUTSIDE", "show_flow": False, "shrink": False},
    ),
    "Outline": (
        "Outlines for smaller and smaller scales; each encloses all land of the one before",
        {"levels": "25%, 8%, 2%", "decimation": "OUTSIDE", "show_flow": False, "shrink": False},
    ),
    "Rig": (
        "One cage of few, evenly spaced vertices at a hundredth of the drawing's size, to be bound and posed",
        {"levels": "16", "clearance_share": 1.0, "decimation": "ARC_LENGTH"},
    ),
    "Tight": (
        "Tight cages, with vertex counts relative to the drawing",
        {"levels": "10%, 3%", "decimation": "OUTSIDE"},
    ),
    "IPC 2022 Repaired": (
        "For comparisons, after Gurditta & Jacobson (2022), with fixes",
        {"levels": "20%", "as_published": True, "fall_back": False},
    ),
}
# What a preset leaves alone: when the animation plays, how cages look, and how drawings are read.
KEPT = {*groups.FRAMES, *groups.LOOKS, *groups.READING, "show_result"}


class NESTEDCAGES_PT_presets(PresetPanel, bpy.types.Panel):
    """Presets of the cages' settings: those of the table, and the user's own as Blender lists them."""

    bl_label = "Nested Cages Presets"
    preset_subdir = FOLDER
    preset_operator = "script.execute_preset"
    preset_add_operator = "scene.nested_cages_preset_add"
    if TYPE_CHECKING:
        layout: Any

    def draw(self, context: Context) -> None:
        column = self.layout.column(align=True)
        column.emboss = "PULLDOWN_MENU"
        for name in PRESETS:
            column.operator("scene.nested_cages_use_preset", text=name).name = name
        if bpy.utils.preset_paths(self.preset_subdir):
            super().draw(context)
            return
        row = self.layout.row()
        row.prop(context.window_manager, "preset_name", text="")
        row.operator(self.preset_add_operator, text="", icon="ADD").name = context.window_manager.preset_name


class SCENE_OT_nested_cages_use_preset(Operator, bpy.types.Operator):
    """Set everything that makes a cage as the preset has it"""

    bl_label = "Use Preset"
    bl_options = {"INTERNAL", "UNDO"}
    modes = ()
    during_jobs = True

    name: text("Name", "Name of the preset", options={"SKIP_SAVE"})

    @classmethod
    def description(cls, _context: Context, properties: Any) -> str:
        return PRESETS[properties.name][0] if properties.name in PRESETS else cls.bl_description

    def run(self, context: Context) -> None:
        settings = settings_of(context)
        if self.name not in PRESETS:
            raise UserError(f"There is no preset '{self.name}': choose one of {', '.join(PRESETS)}")
        for name in NAMES:
            if name not in KEPT:
                settings.property_unset(name)
        for name, value in PRESETS[self.name][1].items():
            setattr(settings, name, value)


class SCENE_OT_nested_cages_preset_add(Named, AddPresetBase, bpy.types.Operator):  # type: ignore[misc]
    """Store the settings under a name, or remove a stored preset"""

    bl_label = "Add Nested Cages Preset"
    preset_menu = "NESTEDCAGES_PT_presets"
    preset_subdir = FOLDER
    preset_defines = ("settings = bpy.context.scene.nested_cages",)
    preset_values = tuple(f"settings.{name}" for name in NAMES)
