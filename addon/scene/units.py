"""Lengths as people write them in Blender, in units of a scene."""

from __future__ import annotations

import bpy

# Suffixes of lengths, with metres per unit; and the suffix of scene units.
METRIC = {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0}
IMPERIAL = {"ft": 0.3048, "in": 0.0254, "yd": 0.9144}
OWN_UNIT = "u"


def lengths(scene: bpy.types.Scene) -> dict[str, float]:
    """Suffixes of lengths with their lengths in scene units, starting with the unit that the scene shows."""
    shown = scene.unit_settings
    metre = 1.0 if shown.system == "NONE" else 1.0 / shown.scale_length
    known = {name: metre * length for name, length in (METRIC | IMPERIAL).items()} | {OWN_UNIT: 1.0}
    first = {"METRIC": "m", "IMPERIAL": "ft"}.get(shown.system, OWN_UNIT)
    return {first: known[first], **known}


def written(length: float, scene: bpy.types.Scene) -> str:
    """A length in scene units as text with the unit that the scene shows, such as 0.05m."""
    unit, factor = next(iter(lengths(scene).items()))
    return f"{length / factor:.6g}{unit}"
