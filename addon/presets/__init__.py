"""Presets in the header of the panel: those of the add-on and those that the user stores."""

from __future__ import annotations

from pathlib import Path

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

from ..properties.settings import NAMES

SUBDIRECTORY = "nested_cages"
# Blender looks for presets/<subdirectory> below this folder.
FOLDER = str(Path(__file__).resolve().parents[1])


class NESTEDCAGES_PT_presets(PresetPanel, bpy.types.Panel):
    """Presets of the cages' settings."""

    bl_label = "Nested Cages Presets"
    preset_subdir = SUBDIRECTORY
    preset_operator = "script.execute_preset"
    preset_add_operator = "scene.nested_cages_preset_add"


class NESTEDCAGES_PT_method_presets(PresetPanel, bpy.types.Panel):
    """Published methods, for comparisons."""

    bl_label = "Published Methods"
    preset_subdir = f"{SUBDIRECTORY}_methods"
    preset_operator = "script.execute_preset"
    preset_add_operator = "scene.nested_cages_method_preset_add"


class SCENE_OT_nested_cages_preset_add(AddPresetBase, bpy.types.Operator):  # type: ignore[misc]
    """Adds or removes a preset."""

    bl_idname = "scene.nested_cages_preset_add"
    bl_label = "Add Nested Cages Preset"
    bl_description = "Store the settings under a name, or remove a stored preset"
    preset_menu = "NESTEDCAGES_PT_presets"
    preset_subdir = SUBDIRECTORY
    preset_defines = ("settings = bpy.context.scene.nested_cages",)
    preset_values = tuple(f"settings.{name}" for name in NAMES)


class SCENE_OT_nested_cages_method_preset_add(AddPresetBase, bpy.types.Operator):  # type: ignore[misc]
    """Adds or removes a preset of a method."""

    bl_idname = "scene.nested_cages_method_preset_add"
    bl_label = "Add Method Preset"
    bl_description = "Store the settings as a method under a name, or remove a stored one"
    preset_menu = "NESTEDCAGES_PT_method_presets"
    preset_subdir = NESTEDCAGES_PT_method_presets.preset_subdir
    preset_defines = SCENE_OT_nested_cages_preset_add.preset_defines
    preset_values = SCENE_OT_nested_cages_preset_add.preset_values


CLASSES = (
    NESTEDCAGES_PT_presets,
    NESTEDCAGES_PT_method_presets,
    SCENE_OT_nested_cages_preset_add,
    SCENE_OT_nested_cages_method_preset_add,
)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.utils.register_preset_path(FOLDER)


def unregister() -> None:
    bpy.utils.unregister_preset_path(FOLDER)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
