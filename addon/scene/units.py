"""Lengths as people write them in Blender, and the vertex counts of outlines without evaluating them."""

from __future__ import annotations

from functools import lru_cache

import bpy

from .. import keys
from .filling import loop_edges, mesh_of

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


def loop_sizes(obj: bpy.types.Object, resolution: int = 0) -> tuple[int, ...]:
    """Vertices of each loop of an outline before modifiers, for a mesh of all loops together; empty for types whose
    counts are unknown until they are read. resolution: as of `lines_of`.
    """
    if obj.type == "MESH":
        return (len(loop_edges(mesh_of(obj))),)
    if obj.type == "CURVE":
        return tuple(_points(spline, resolution) for spline in obj.data.splines)
    if obj.type == "FONT":
        text = obj.data
        shape = (text.body, text.font.filepath if text.font else "", resolution or text.resolution_u)
        return _text_sizes(obj.session_uid, *shape)
    return ()


def _points(spline: bpy.types.Spline, resolution: int) -> int:
    """Number of points of an evaluated spline."""
    if spline.type == "POLY":
        return len(spline.points)
    fine = resolution or spline.resolution_u
    if spline.type == "BEZIER":
        points = list(spline.bezier_points)
        ahead = [*points[1:], *(points[:1] if spline.use_cyclic_u else [])]
        straight = sum(
            here.handle_right_type == there.handle_left_type == "VECTOR"
            for here, there in zip(points, ahead, strict=False)
        )
        return straight + (len(ahead) - straight) * fine
    return (len(spline.points) - (not spline.use_cyclic_u)) * fine


@lru_cache(maxsize=64)
def _text_sizes(identity: int, _body: str, _font: str, resolution: int) -> tuple[int, ...]:
    """Vertices of the loops of a text, which has no splines of its own; cached until the text changes."""
    obj = keys.found_object(identity)
    if obj is None:
        return ()
    curve = obj.to_curve(bpy.context.evaluated_depsgraph_get())
    try:
        return tuple(_points(spline, resolution) for spline in curve.splines)
    finally:
        obj.to_curve_clear()
