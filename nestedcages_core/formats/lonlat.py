"""Longitudes and latitudes: polygons that cross the 180th meridian or run around a pole, distances on the ground."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..errors import invalid_file
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..libraries import load_shapely
from .geometries import Polygon

TURN, HALF_TURN, POLE = 360.0, 180.0, 90.0
"""Degrees."""

LESS_THAN_TURN = float(np.nextafter(TURN, 0.0))

LONGEST_EDGE = 270.0
"""Degrees of longitude above which an edge is assumed to cross the meridian instead."""


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


# Distances on the ground: the ellipsoid WGS84

EQUATOR, FLATTENING = 6_378_137.0, 1.0 / 298.257223563
"""Radius in metres, and flattening."""

ECCENTRICITY = FLATTENING * (2.0 - FLATTENING)
"""Its square."""

BAND = 0.005
"""Relative difference of the lengths of parallels within a band whose edges are grown by one ellipse."""

MAX_EDGES = 1_000_000
"""Maximum number of edges that are grown, after cutting at bands."""

ARC_STEPS = 12
"""Chords of a quarter circle, around which distances are exact or larger."""

FINER = 0.002
"""Part of the distance within which lines are simplified before they are grown by as much more."""


def grown_on_ground(mesh: Mesh, metres: float, *, inside: bool = False) -> tuple[Mesh, Mesh]:
    """A mesh in degrees, with parts across the 180th meridian next to each other, and one whose outline keeps a
    distance from its edges, everywhere and on the ground; around it, or inside it.

    A path of so many metres from latitudes of a band lies in an ellipse with half axes as long as the distance over
    the smallest radii of curvature that it can meet. So each band of edges is grown by its ellipse. The result is
    checked against the edges by the same bound.

    Raises NestedCagesError where degrees are exceeded, or a pole or the other side of the earth is nearer than that.
    """
    shapely = load_shapely("A clearance in metres")
    from .solids import solid

    whole = _side_by_side(shapely, shapely.geometry.shape(mesh))
    rings = [ring[:, :2] for ring in map(shapely.get_coordinates, shapely.get_rings(shapely.get_parts(whole)))]
    bands = _bands(np.concatenate([np.hstack((ring[:-1], ring[1:])) for ring in rings]), metres)
    lines = [
        shapely.line_merge(shapely.multilinestrings(list(edges.reshape(-1, 2, 2) * axes))) for edges, axes in bands
    ]
    wide = metres
    for _ in range(3):
        reach = wide * (FINER + 1.0 / np.cos(np.pi / (4 * ARC_STEPS)))
        grown = [shapely.buffer(shapely.simplify(line, FINER * wide), reach, quad_segs=ARC_STEPS) for line in lines]
        parts = [_scaled(shapely, part, 1.0 / axes) for part, (_, axes) in zip(grown, bands, strict=True)]
        collar = shapely.union_all(parts)
        result = solid([whole - collar if inside else whole | collar], inside=inside)
        rim = shapely.boundary(shapely.geometry.shape(result))
        rims = [_scaled(shapely, rim, axes) for _, axes in bands]
        for each in rims:
            shapely.prepare(each)
        if not any(shapely.dwithin(each, line, metres) for each, line in zip(rims, lines, strict=True)):
            break
        wide *= 1.01
    else:
        raise invalid_file("The outline is too crooked for a clearance in metres; give it in degrees.")
    if np.ptp(result.vertices[:, 0]) >= TURN:
        raise invalid_file("The clearance reaches around the earth; give a smaller one, or cut the polygon.")
    return Mesh.from_geometry(whole), result


def _bands(edges: FloatArray, metres: float) -> list[tuple[FloatArray, FloatArray]]:
    """Edges (n, 4) by bands of latitude, cut there, and for each band the metres that a degree in x and in y is at
    least worth for paths of a length from there."""
    if not (np.abs(edges[:, 1::2]) <= POLE).all() or not (np.abs(edges[:, ::2]) <= 2.0 * TURN).all():
        raise invalid_file("A clearance in metres needs longitudes and latitudes, or a named projection in metres.")
    highest = np.abs(edges[:, 1::2]).max(axis=1)
    room = np.degrees(metres / _meridian_radius(0.0))
    if highest.max() + room >= POLE:
        raise invalid_file("A pole is nearer than the clearance; there, give it in units of a map of the poles.")
    slope = np.radians(np.abs(edges[:, 3] - edges[:, 1])) * np.tan(np.radians(highest)) / BAND
    count = np.ceil(np.maximum(slope, 1.0)).astype(int)
    if count.sum() > MAX_EDGES:
        raise invalid_file(f"The outline has more than {MAX_EDGES:,} edges to grow; simplify it, or give degrees.")
    start = np.repeat(edges[:, :2], count, axis=0)
    way = np.repeat(edges[:, 2:] - edges[:, :2], count, axis=0)
    piece = np.arange(len(start)) - np.repeat(np.cumsum(count) - count, count)
    total = np.repeat(count, count)
    ends = [start + way * (k / total)[:, None] for k in (piece, piece + 1)]
    ends[1] = np.where((piece + 1 == total)[:, None], np.repeat(edges[:, 2:], count, axis=0), ends[1])
    pieces = np.hstack(ends)
    middle = 0.5 * (pieces[:, 1] + pieces[:, 3])
    number = np.floor(np.log(_parallel_radius(middle)) / BAND).astype(int)
    found = []
    for key in np.unique(number):
        members = pieces[number == key]
        latitudes = np.abs(members[:, 1::2])
        crosses = members[:, 1::2].min() <= 0.0 <= members[:, 1::2].max()
        low = 0.0 if crosses else max(latitudes.min() - room, 0.0)
        axes = np.radians([float(_parallel_radius(latitudes.max() + room)), float(_meridian_radius(low))])
        found.append((members, axes))
    return found


def _meridian_radius(latitude: Any) -> Any:
    """Radius of curvature of meridians, in metres; it grows towards the poles."""
    return EQUATOR * (1.0 - ECCENTRICITY) / (1.0 - ECCENTRICITY * np.sin(np.radians(latitude)) ** 2) ** 1.5


def _parallel_radius(latitude: Any) -> Any:
    """Radius of the circle of a latitude, in metres."""
    radians = np.radians(latitude)
    return EQUATOR * np.cos(radians) / np.sqrt(1.0 - ECCENTRICITY * np.sin(radians) ** 2)


def _scaled(shapely: Any, geometry: Any, axes: FloatArray) -> Any:
    return shapely.transform(geometry, lambda points: points * axes)


def _side_by_side(shapely: Any, whole: Any) -> Any:
    """A geometry whose parts leave the widest gap that they can around the earth; the largest one keeps its place."""
    parts = shapely.get_parts(whole)
    west, _, east, _ = shapely.bounds(parts).T
    order = np.argsort(west % TURN)
    start = (west % TURN)[order]
    reached = np.maximum.accumulate(start + (east - west)[order])
    gaps = np.append(start[1:], start[0] + TURN) - reached  # the first of these parts may lie beyond the last gap
    first = start[(int(gaps.argmax()) + 1) % len(parts)]
    moves = np.floor((west - first) / TURN) * -TURN
    moves -= moves[shapely.area(parts).argmax()]
    if not moves.any():
        return whole
    return shapely.union_all(
        [
            shapely.transform(part, lambda points, x=x: points + np.array((x, 0.0)))
            for part, x in zip(parts, moves, strict=True)
        ]
    )
