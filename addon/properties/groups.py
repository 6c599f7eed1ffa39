"""Settings that are shown together, in this order, in the panel and in the operator."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from . import conversion
from .settings import GenerationProperties

WHAT: tuple[str, ...] = ("use_selected_as_levels", "together", "clearance", "decimation", "energy")
FRAMES: tuple[str, ...] = ("start_frame", "fit_length", "length", "frames_per_step")
ANIMATION: tuple[str, ...] = ("show_flow", "ease", "loop_back", "show_result")
LOOKS: tuple[str, ...] = ("thickness",)
READING: tuple[str, ...] = ("resolution", "close_open", "project")
ADVANCED: tuple[str, ...] = (
    *("contact", "repairs", "expansion_energy", "solver", "step_filter", "broad_phase"),
    *("flow", "quadrature", "starts", "tighten", "fall_back"),
)


# Settings that count only if the animation is fitted to a length, or only if it is not.
ALTERNATIVES = {"length": True, "frames_per_step": False}


def draw(layout: bpy.types.UILayout, values: GenerationProperties, names: Iterable[str]) -> None:
    """Draws settings; those that do not apply to the chosen methods are greyed out."""
    chosen = conversion.methods(values)
    for name in names:
        line = layout.column()
        line.active = chosen.has_use_for(name) and ALTERNATIVES.get(name, values.fit_length) == values.fit_length
        line.prop(values, name)
