"""Settings that are shown together, in this order, in the panel and in the operator."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import bpy

from .options import ROTATION
from .settings import GenerationProperties

SPACE: tuple[str, ...] = ("clearance", "inside")
WHICH: tuple[str, ...] = ("together", "use_selected_as_levels")
RULES: tuple[str, ...] = ("convex", "grid", "loops", "symmetry", "symmetry_order", "directions")
PLACES: tuple[str, ...] = ("weight_group", "pin_group", "joint_armature", "min_edge", "min_angle")
# Names of vertex groups.
GROUPS = ("weight_group", "pin_group")
# Settings that cages which follow a motion do not have.
NOT_MOVING: tuple[str, ...] = ("use_selected_as_levels", "inside", *RULES, *PLACES)
SHAPE: tuple[str, ...] = ("decimation", "energy", "as_published")
FRAMES: tuple[str, ...] = ("start_frame", "length", "frames_per_step")
ANIMATION: tuple[str, ...] = ("show_flow",)
LOOKS: tuple[str, ...] = ("thickness",)
READING: tuple[str, ...] = ("close_open", "project")

# Settings that only apply if another one has a value.
ALTERNATIVES: dict[str, tuple[str, object]] = {
    "clearance_share": ("clearance", 0.0),
    "frames_per_step": ("length", 0),
    "symmetry_order": ("symmetry", ROTATION),
}


def draw(layout: bpy.types.UILayout, values: GenerationProperties, names: Iterable[str]) -> None:
    """Draws settings; those that do not apply are greyed out."""
    for name in names:
        line = layout.column()
        other, wanted = ALTERNATIVES.get(name, (name, getattr(values, name)))
        line.active = getattr(values, other) == wanted
        active = bpy.context.object
        if name in GROUPS and active is not None and active.type == "MESH":
            line.prop_search(values, name, active, "vertex_groups")
        elif name == "joint_armature":
            line.prop_search(values, name, bpy.data, "objects", icon="ARMATURE_DATA")
        else:
            line.prop(values, name)


# The extension's package, whatever name Blender gave it.
PACKAGE = __package__.removesuffix(".addon.generate")


def preferences() -> Any:
    """The add-on's preferences; None while it is not enabled."""
    addon = bpy.context.preferences.addons.get(PACKAGE)
    return addon.preferences if addon is not None else None


# The title of what cages must be, apart from tight.
CONSTRAINTS = "Constraints"
# The settings in each part of the panels.
SECTIONS = {
    CONSTRAINTS: (*RULES, *PLACES),
    "Animation": (*FRAMES, *ANIMATION),
    "Advanced": (*READING, "clearance_share", *SHAPE, *LOOKS),
}
