"""Longitudes and latitudes: polygons that cross the 180th meridian or run around a pole."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..geometry.arrays import FloatArray
from .geometries import Polygon

TURN, HALF_TURN, POLE = 360.0, 180.0, 90.0
"""Degrees."""

LESS_THAN_TURN = float(np.nextafter(TURN, 0.0))

LONGEST_EDGE = 270.0
"""Degrees of longitude above which an edge is assumed to cross the meridian instead."""

NO_COAST = 86.0
"""Latitude above which the edge of a ring that is nearest to the pole runs along it: as of a cage inside Antarctica."""

GEOGRAPHIC = ("CRS84", "4326", "4269", "4258")
"""Substrings of the names of common coordinate reference systems in degrees."""


def system_name(crs: Any) -> str | None:
    """The name in a `crs` member of GeoJSON, empty if it has none; None without a member, which means WGS84."""
    properties = crs.get("properties") if isinstance(crs, Mapping) else None
    name = properties.get("name") if isinstance(properties, Mapping) else crs
    return None if crs is None else name if isinstance(name, str) else ""


def may_be_degrees(crs: Any) -> bool:
    """Whether coordinates can be longitudes and latitudes: no `crs` says otherwise."""
    name = system_name(crs)
    return name is None or any(known in name for known in GEOGRAPHIC)


def across(polygons: list[Polygon]) -> tuple[list[Polygon], list[str]]:
    """Polygons in degrees, with those that cross the meridian repaired, and a sentence for each of these.

    A ring that closes beyond the meridian is shifted there, so its longitudes go on past 180. One that runs once around
    a pole is cut along the meridian and closed along the pole. Other coordinates than degrees are left unchanged.
    """
    rings = [ring for polygon in polygons for ring in polygon]
    if not all(len(ring) and (np.abs(ring) <= (HALF_TURN, POLE)).all() for ring in rings):
        return polygons, []
    mended, notes = [], []
    for polygon in polygons:
        jumps = _jumps(polygon[0])
        if not jumps.any():
            mended.append(polygon)
            continue
        first = int(np.flatnonzero(jumps)[0])
        x, y = polygon[0][first]
        along = _jumps(polygon[0], TURN)
        if along.sum() == 0 or jumps.sum() == 0:
            mended.append(_shifted(polygon, TURN if along.sum() == 0 else LESS_THAN_TURN))
            notes.append(f"a polygon crosses the 180th meridian at ({x:.6g}, {y:.6g}); shifted beyond it")
        elif np.abs(along).sum() == 1 and not _is_along_pole(polygon[0], first):
            mended.append([_around_pole(polygon[0], first), *polygon[1:]])
            notes.append(f"a polygon runs around a pole past ({x:.6g}, {y:.6g}); cut along the 180th meridian")
        else:
            mended.append(polygon)
    return mended, notes


def _jumps(ring: FloatArray, longest: float = LESS_THAN_TURN) -> FloatArray:
    """(k,) 1 where the edge from a point crosses the meridian eastwards, -1 westwards, else 0.

    longest: longest such edge; one of 360 degrees, from 180 to -180, has no length or follows the frame of the map.
    """
    east = np.roll(ring[:, 0], -1) - ring[:, 0]
    return np.where((np.abs(east) > LONGEST_EDGE) & (np.abs(east) <= longest), -np.sign(east), 0.0)


def _shifted(polygon: Polygon, longest: float) -> Polygon:
    """The rings with longitudes that go on past the meridian, on the side where most points are, holes with them."""
    rings, middle = list[FloatArray](), 0.0
    for ring in polygon:
        turns = np.concatenate(([0.0], np.cumsum(_jumps(ring, longest))[:-1]))
        beyond = ring[:, 0] + TURN * turns
        centre = 0.5 * (beyond.min() + beyond.max())
        east = np.round((middle - centre) / TURN if rings else -np.median(turns))
        middle = middle if rings else centre + TURN * east
        turns += east
        rings.append(np.stack((np.where(turns, ring[:, 0] + TURN * turns, ring[:, 0]), ring[:, 1]), axis=1))
    return rings


def _is_along_pole(ring: FloatArray, k: int) -> bool:
    """Whether the edge from a vertex runs from one side of the map to the other, nearer to the pole than all others."""
    north = ring[:, 1] * np.sign(ring[k, 1])
    least = min(north[k], north[(k + 1) % len(ring)])
    return bool(least > NO_COAST and len(np.unique(ring[north >= least], axis=0)) == 2)


def _around_pole(ring: FloatArray, k: int) -> FloatArray:
    """The ring with its single jump, from a vertex, replaced by a path along the meridian to the nearer pole."""
    start, end = ring[k], ring[(k + 1) % len(ring)]
    side = HALF_TURN * np.sign(start[0])
    share = abs(side - start[0]) / (TURN - abs(end[0] - start[0]))
    at, pole = start[1] + share * (end[1] - start[1]), POLE if ring[:, 1].mean() > 0.0 else -POLE
    corners = np.array([(side, at), (side, pole), (-side, pole), (-side, at)])
    return np.concatenate((ring[: k + 1], corners, ring[k + 1 :]))
