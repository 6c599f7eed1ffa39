"""Settings that are shown together, in this order, in the panel and in the operator."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import bpy

from . import conversion
from .settings import GenerationProperties

SPACE: tuple[str, ...] = ("clearance", "inside")
WHICH: tuple[str, ...] = ("together", "use_selected_as_levels")
SHAPE: tuple[str, ...] = ("decimation", "energy")
FRAMES: tuple[str, ...] = ("start_frame", "fit_length", "length", "frames_per_step")
ANIMATION: tuple[str, ...] = ("show_flow", "ease", "loop_back", "show_result")
LOOKS: tuple[str, ...] = ("thickness",)
READING: tuple[str, ...] = ("resolution", "close_open", "project")
ADVANCED: tuple[str, ...] = (
    *("contact", "repairs", "expansion_energy", "solver", "step_filter", "broad_phase"),
    *("flow", "quadrature", "starts", "tighten", "fall_back"),
)


# Settings that only apply if the animation is fitted to a length (True), or only if it is not (False).
ALTERNATIVES = {"length": True, "frames_per_step": False}


def draw(layout: bpy.types.UILayout, values: GenerationProperties, names: Iterable[str]) -> None:
    """Draws settings; those that do not apply to the chosen methods are greyed out."""
    chosen = conversion.methods(values)
    for name in names:
        line = layout.column()
        line.active = chosen.has_use_for(name) and ALTERNATIVES.get(name, values.fit_length) == values.fit_length
        line.prop(values, name)


# The extension's package, whatever name Blender gave it.
PACKAGE = __package__.removesuffix(".addon.properties")


def preferences() -> Any:
    """The add-on's preferences; None while it is not enabled."""
    addon = bpy.context.preferences.addons.get(PACKAGE)
    return addon.preferences if addon is not None else None


def shows_research() -> bool:
    """Whether the panels show settings for comparing methods."""
    found = preferences()
    return found is not None and found.research


def parts() -> list[tuple[str, tuple[str, ...]]]:
    """The parts of the operator's panel, by title."""
    found = [("Animation", (*FRAMES, *ANIMATION)), ("Drawing and Cages", (*WHICH, *READING, *SHAPE, *LOOKS))]
    return [*found, ("Advanced", ADVANCED)] if shows_research() else found
