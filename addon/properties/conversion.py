"""From settings to the parameters of other modules."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, TypeVar

import bpy

from ..animation.timeline import Timing
from ..generation.generate import Options
from ..generation.levels import parse_levels
from ..generation.methods import Methods
from ..generation.rules import Rules
from ..scene import units
from ..scene.convert import ReadingOptions
from .settings import NAMES, GenerationProperties

Filled = TypeVar("Filled", ReadingOptions, Timing, Methods, Rules)


def options(values: GenerationProperties, scene: bpy.types.Scene) -> Options:
    """Levels and clearance, in units of the scene, and methods. Raises: UserError if the levels cannot be read."""
    levels = () if values.use_selected_as_levels else parse_levels(values.levels, units.lengths(scene))
    return Options(
        levels=levels,
        clearance=values.clearance,
        clearance_share=0.01 * values.clearance_share,
        inside=values.inside,
        shrink=values.shrink,
        rules=filled(Rules, values),
        methods=filled(Methods, values),
    )


def used(values: GenerationProperties) -> dict[str, Any]:
    """All settings, by name."""
    return {name: getattr(values, name) for name in NAMES}


def filled(kind: type[Filled], values: GenerationProperties) -> Filled:
    """How to read objects, when to play steps, the methods, or what cages must be: the fields are named as settings."""
    found: dict[str, Any] = {field.name: getattr(values, field.name) for field in fields(kind)}
    found |= {name: frozenset(value) for name, value in found.items() if isinstance(value, set)}
    return kind(**found)
