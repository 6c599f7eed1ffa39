"""Clearances in metres: shapes of maps in degrees are grown by them, those of other maps have metres as units."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..errors import NestedCagesError, invalid_file
from ..formats.lonlat import POLE, TURN, grown_on_ground, may_be_degrees, system_name
from ..geometry.mesh import Mesh
from ..levels import Level, Share
from .sources import NamedShape, Source


def on_ground(source: Source, metres: float, *, inside: bool) -> Source:
    """A map whose shapes, if in degrees, hold all that is closer to the given ones than a clearance, or lie as far
    inside of them. Raises NestedCagesError for files other than maps.
    """
    if source.kind != "map":
        raise invalid_file("A clearance in m, km or mi is for a map; give it in units of the file.")
    if not may_be_degrees(source.crs):
        name = system_name(source.crs) or ""
        if re.search(r"\bft|foot|feet|degree", name, re.IGNORECASE):
            raise invalid_file(f"The map's system, {name:.60}, is not in metres; give the clearance in its units.")
        note = f"The clearance is taken in units of the map's system, {name:.60}, as metres."
        return replace(source, notes=[*source.notes, note])
    shapes, failures = [], list(source.failures)
    for shape in source.shapes:
        if not isinstance(shape.content, Mesh):
            continue
        try:
            drawn, content = grown_on_ground(shape.content, metres, inside=inside)
            shapes.append(replace(shape, content=content, drawn=drawn, metres=metres))
        except NestedCagesError as error:
            failures.append(f"{shape.name}: {error}" if len(source.shapes) > 1 else str(error))
    return replace(source, shapes=shapes, failures=failures)


def counts(shape: NamedShape, levels: Sequence[Any], *, keeps: bool) -> list[Any]:
    """Levels of a shape, with shares of the vertices of what is drawn as numbers."""
    if shape.drawn is None:
        return list(levels)
    sizes = [len(loop) for loop in shape.drawn.loops]
    return [level.of(sizes, keeps=keeps) if isinstance(level, Share) else level for level in levels]


def measured(shape: NamedShape, levels: Sequence[Level]) -> Sequence[Level]:
    """Levels with the excess over what is drawn, and the clearance in metres where that was asked for on the ground.

    Raises NestedCagesError for cages that go over a pole, or around the earth and into the clearance.
    """
    if shape.drawn is None or shape.metres is None or not isinstance(shape.content, Mesh):
        return levels
    found = []
    (west, _, east, _) = shape.content.bounds
    for level in levels:
        x, y = level.vertices.T
        if np.abs(y).max() > POLE or x.max() - TURN > west or x.min() + TURN < east:
            raise invalid_file("A cage with so few vertices goes over a pole or around the earth; give it more.")
        excess = level.cage.area / shape.drawn.area - 1.0
        report = replace(level.report, clearance=shape.metres, wanted_clearance=shape.metres, excess=excess)
        found.append(replace(level, report=report))
    return found
