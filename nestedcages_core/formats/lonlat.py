"""Longitudes and latitudes: polygons that cross the 180th meridian or run around a pole."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import FloatArray
from .geometries import Polygon

TURN, HALF_TURN, POLE = 360.0, 180.0, 90.0
"""Degrees."""

LESS_THAN_TURN = float(np.nextafter(TURN, 0.0))

LONGEST_EDGE = 270.0
"""Degrees of longitude above which an edge is assumed to cross the meridian instead."""


def across(polygons: list[Polygon]) -> tuple[list[Polygon], list[str]]:
    """Polygons in degrees, with those that cross the meridian repaired, and a sentence for each of these.

    A ring that closes beyond the meridian is shifted there, so its longitudes go on past 180. One that runs once around
    a pole is cut along the meridian and closed along the pole. Other coordinates than degrees are left unchanged.
    """
    if not polygons or not all(_degrees(ring) for polygon in polygons for ring in polygon):
        return polygons, []
    mended, notes = [], []
    for polygon in polygons:
        jumps = _jumps(polygon[0])
        if not jumps.any():
            mended.append(polygon)
            continue
        x, y = polygon[0][int(np.flatnonzero(jumps)[0])]
        along = _jumps(polygon[0], TURN)
        if along.sum() == 0 or jumps.sum() == 0:
            mended.append(_shifted(polygon, TURN if along.sum() == 0 else LESS_THAN_TURN))
            notes.append(f"a polygon crosses the 180th meridian at ({x:.6g}, {y:.6g}); shifted beyond it")
        elif np.abs(along).sum() == 1:
            mended.append([_around_pole(polygon[0], jumps), *polygon[1:]])
            notes.append(f"a polygon runs around a pole past ({x:.6g}, {y:.6g}); cut along the 180th meridian")
        else:
            mended.append(polygon)
    return mended, notes


def _degrees(ring: FloatArray) -> bool:
    return len(ring) > 0 and bool((np.abs(ring) <= (HALF_TURN, POLE)).all())


def _jumps(ring: FloatArray, longest: float = LESS_THAN_TURN) -> FloatArray:
    """(k,) 1 where the edge from a point crosses the meridian eastwards, -1 westwards, else 0.

    longest: longest such edge; one of 360 degrees, from 180 to -180, has no length or follows the frame of the map.
    """
    east = np.roll(ring[:, 0], -1) - ring[:, 0]
    return np.where((np.abs(east) > LONGEST_EDGE) & (np.abs(east) <= longest), -np.sign(east), 0.0)


def _shifted(polygon: Polygon, longest: float) -> Polygon:
    """The rings with longitudes that go on past the meridian, on the side where most points are."""
    outer = _unwrapped(polygon[0], longest)
    outer = _moved(outer, TURN * np.round(np.median(polygon[0][:, 0] - outer[:, 0]) / TURN))
    middle = 0.5 * (outer[:, 0].min() + outer[:, 0].max())
    rings = [outer]
    for ring in polygon[1:]:
        hole = _unwrapped(ring, longest)
        rings.append(_moved(hole, TURN * np.round((middle - 0.5 * (hole[:, 0].min() + hole[:, 0].max())) / TURN)))
    return rings


def _moved(ring: FloatArray, east: float) -> FloatArray:
    """The ring shifted by degrees of longitude; unchanged by a shift of 0, -0.0 included."""
    return ring + np.array((east, 0.0)) if east else ring


def _unwrapped(ring: FloatArray, longest: float) -> FloatArray:
    turns = np.concatenate(([0.0], np.cumsum(_jumps(ring, longest))[:-1]))
    return np.stack((ring[:, 0] + TURN * turns, ring[:, 1]), axis=1)


def _around_pole(ring: FloatArray, jumps: FloatArray) -> FloatArray:
    """The ring with its single jump replaced by a path along the meridian to the nearer pole and back."""
    k = int(np.flatnonzero(jumps)[0])
    start, end = ring[k], ring[(k + 1) % len(ring)]
    side = HALF_TURN * np.sign(start[0])
    reach = TURN - abs(end[0] - start[0])
    share = abs(side - start[0]) / reach
    at = start[1] + share * (end[1] - start[1])
    pole = POLE if ring[:, 1].mean() > 0.0 else -POLE
    corners = np.array([(side, at), (side, pole), (-side, pole), (-side, at)])
    return np.concatenate((ring[: k + 1], corners, ring[k + 1 :]))
