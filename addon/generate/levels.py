"""Levels as the user gives them: vertex counts, percentages, distances, excesses and own drawings, clamped to what a
drawing allows; and lengths as people write them in Blender.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import TypeAlias

import bpy
from bpy.types import Object, Scene

from .. import keys
from ..blender.mesh_data import loop_edges, mesh_of
from ..core import core
from ..errors import UserError

# Suffixes of lengths, with metres per unit; and the suffix of scene units.
METRIC = {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0}
IMPERIAL = {"ft": 0.3048, "in": 0.0254, "yd": 0.9144}
OWN_UNIT = "u"


def lengths(scene: Scene) -> dict[str, float]:
    """Suffixes of lengths with their lengths in scene units, starting with the unit that the scene shows."""
    shown = scene.unit_settings
    metre = 1.0 if shown.system == "NONE" else 1.0 / shown.scale_length
    known = {name: metre * length for name, length in (METRIC | IMPERIAL).items()} | {OWN_UNIT: 1.0}
    first = {"METRIC": "m", "IMPERIAL": "ft"}.get(shown.system, OWN_UNIT)
    return {first: known[first], **known}


def loop_sizes(obj: Object) -> tuple[int, ...]:
    """Vertices of each loop of an outline before modifiers, for a mesh of all loops together; empty for types whose
    counts are unknown until they are read.
    """
    if obj.type == "MESH":
        return (len(loop_edges(mesh_of(obj))),)
    if obj.type == "CURVE":
        return tuple(_points(spline) for spline in obj.data.splines)
    if obj.type == "FONT":
        text = obj.data
        shape = (text.body, text.font.filepath if text.font else "", text.resolution_u)
        return _text_sizes(obj.session_uid, *shape)
    return ()


def _points(spline: bpy.types.Spline) -> int:
    """Number of points of an evaluated spline."""
    if spline.type == "POLY":
        return len(spline.points)
    fine = spline.resolution_u
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
        return tuple(_points(spline) for spline in curve.splines)
    finally:
        obj.to_curve_clear()


# Stands for an own coarse drawing in a list of levels.
OWN = "*"
# A vertex count, a percentage, a distance (in units of the scene) or an excess, or `OWN`.
Level: TypeAlias = "int | core.levels.Share | core.Within | str"
# The same as the core takes it.
Wanted: TypeAlias = "core.levels.Rising | core.Within | core.Mesh"


def parse_levels(text: str, units: Mapping[str, float]) -> tuple[Level, ...]:
    """The levels of a text such as "64, 24", "10% 3%", "2mm +25%" or "64, *". Raises: UserError.

    units: what may mark a distance, and its length in units of the scene.
    """
    reader = core.levels
    words = reader.level_words(text, units) or [text]
    try:
        levels = [OWN if word == OWN else reader.parse_level(word, units) for word in words]
        return tuple(reader.in_order(levels))
    except core.NestedCagesError as error:
        raise UserError(str(error)) from error


def wanted_levels(
    levels: Sequence[Level],
    fine: core.Mesh,
    own: Sequence[core.Mesh],
    name: str,
    scale: float = 1.0,
    *,
    convex: bool = False,
    keeps: bool = True,
) -> list[Wanted]:
    """What is to be made for each level of a drawing, in its units; counts that are too small rise to the least that it
    can have. Raises: UserError.

    scale: the scene's length of its unit. convex: shares are of the vertices around each part. keeps: whether each loop
    needs vertices of its own.
    """
    if not levels:
        return list(own)
    if levels.count(OWN) != len(own):
        raise UserError(
            f"'{name}': {levels.count(OWN)} of the levels should be an object of your own (*), and {len(own)} "
            f"{'is' if len(own) == 1 else 'are'} named: select your objects and then the drawing, and tick 'Selected "
            "as Cages'"
        )
    sizes = [len(loop) for loop in fine.loops]
    if convex:
        sizes = [sum(sizes) // int((fine.parent_of_loop < 0).sum())]
    meshes, wanted, rising = iter(own), list[Wanted](), core.levels.Rising
    for level in levels:
        if isinstance(level, str):
            wanted.append(next(meshes))
        elif isinstance(level, int):
            wanted.append(level if isinstance(level, rising) else rising(level))
        elif isinstance(level, core.Within):
            distance = None if level.distance is None else level.distance / scale
            wanted.append(replace(level, distance=distance))
        else:
            wanted.append(rising(level.of(sizes, keeps=keeps), round(level.fraction * sum(sizes))))
    return wanted


def are_counts(levels: Sequence[Level]) -> bool:
    """Whether no level is a distance or an excess."""
    return not any(isinstance(level, core.Within) for level in levels)


def meanings(levels: Sequence[Level], sizes: Sequence[int], size: float, *, keeps: bool = True) -> str:
    """What levels come to for a drawing: "20 % = 93, 8 % = 37 vertices"; its vertices where all levels are counts.

    sizes: vertices of its loops. size: its diagonal in units of the scene. keeps: whether each loop needs vertices of
    its own.
    """
    said: list[str] = []
    shares = [level for level in levels if isinstance(level, core.levels.Share)]
    for level in levels:
        if isinstance(level, core.levels.Share):
            count = level.of(sizes, keeps=keeps)
            said.append(f"{100.0 * level.fraction:.4g} % = {count}{' vertices' if level is shares[-1] else ''}")
        elif isinstance(level, core.Within) and level.excess is not None:
            said.append(f"{1.0 + level.excess:.4g} times the area")
        elif isinstance(level, core.Within) and size > 0.0:
            said.append(f"{100.0 * level.limit / size:.3g} % of the size")
    return ", ".join(said) or f"of {sum(sizes)} vertices"
