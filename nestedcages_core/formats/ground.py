"""Distances on the ground, on the ellipsoid WGS84: outlines in degrees grown or shrunk by metres."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from ..errors import invalid_file
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from .lonlat import POLE, TURN
from .solids import shapely, solid

EQUATOR, FLATTENING = 6_378_137.0, 1.0 / 298.257223563
"""Radius in metres, and flattening."""

ECCENTRICITY = FLATTENING * (2.0 - FLATTENING)
"""Its square."""

BAND = 0.005
"""Relative difference of the lengths of parallels within a band whose edges are grown by one ellipse."""

MAX_WORK = 20_000_000
"""Maximum number of bands times points."""

ARC_STEPS = 12
"""Chords of a quarter circle, around which distances are exact or larger."""

FINER = 0.002
"""Part of the distance within which lines are simplified before they are grown by as much more."""

TRIES = 3
"""Times that the distance is tried, each larger than the one before."""


def grown_on_ground(mesh: Mesh, metres: float, *, inside: bool = False) -> tuple[Mesh, Mesh]:
    """A mesh in degrees, with parts across the 180th meridian next to each other, and one whose outline keeps a
    distance from its edges, everywhere and on the ground; around it, or inside it.

    A path of so many metres from latitudes of a band lies in an ellipse with half axes as long as the distance over
    the smallest radii of curvature that it can meet. So each band of edges is grown by its ellipse. The result is
    checked against the edges by the same bound.

    Raises NestedCagesError where degrees are exceeded, or a pole or the other side of the earth is nearer than that.
    """
    whole = _side_by_side(shapely.geometry.shape(mesh))
    bands = [(_scaled(lines, axes), axes) for lines, axes in _bands(shapely.boundary(whole), metres)]
    for wide in metres * 1.01 ** np.arange(TRIES):
        reach = wide * (FINER + 1.0 / np.cos(np.pi / (4 * ARC_STEPS)))
        grown = (shapely.buffer(shapely.simplify(line, FINER * wide), reach, quad_segs=ARC_STEPS) for line, _ in bands)
        collar = shapely.union_all([_scaled(part, 1.0 / axes) for part, (_, axes) in zip(grown, bands, strict=True)])
        result = solid([whole - collar if inside else whole | collar], inside=inside)
        rim = shapely.boundary(shapely.geometry.shape(result))
        if not any(shapely.dwithin(_scaled(rim, axes), line, metres) for line, axes in bands):
            break
    else:
        raise invalid_file("The outline is too crooked for a clearance in metres; give it in degrees.")
    if np.ptp(result.vertices[:, 0]) >= TURN:
        raise invalid_file("The clearance reaches around the earth; give a smaller one, or cut the polygon.")
    return Mesh.from_geometry(whole), result


def _bands(lines: Any, metres: float) -> Iterator[tuple[Any, FloatArray]]:
    """Lines by bands of latitude, cut there, and for each band the metres that a degree in x and in y is at least worth
    for paths of a length from there."""
    west, south, east, north = shapely.bounds(lines)
    if not (-POLE <= south <= north <= POLE and -2.0 * TURN <= west <= east <= 2.0 * TURN):
        raise invalid_file("A clearance in metres needs longitudes and latitudes, or a named projection in metres.")
    room = np.degrees(metres / _meridian_radius(0.0))
    if max(-south, north) + room >= POLE:
        raise invalid_file("A pole is nearer than the clearance; there, give it in units of a map of the poles.")
    # parallels of a sphere whose lengths differ by as much as those of a band may
    count = int(-np.log(np.cos(np.radians(max(-south, north)))) / BAND) + 2
    parallels = np.degrees(np.arccos(np.exp(-BAND * np.arange(1, count))))
    borders = np.concatenate((-parallels[::-1], parallels))
    borders = np.concatenate(([south], borders[(borders > south) & (borders < north)], [north]))
    if len(borders) * shapely.get_num_coordinates(lines) > MAX_WORK:
        raise invalid_file("The outline has too many edges for a clearance in metres; simplify it, or give degrees.")
    for low, high in pairwise(borders):
        part = shapely.intersection(lines, shapely.box(west - 1.0, low, east + 1.0, high))
        farthest, nearest = max(-low, high), max(low, -high, 0.0)
        radii = _parallel_radius(farthest + room), _meridian_radius(max(nearest - room, 0.0))
        yield part, np.radians(radii)


def _meridian_radius(latitude: float) -> float:
    """Radius of curvature of meridians, in metres; it grows towards the poles."""
    return float(EQUATOR * (1.0 - ECCENTRICITY) / (1.0 - ECCENTRICITY * np.sin(np.radians(latitude)) ** 2) ** 1.5)


def _parallel_radius(latitude: float) -> float:
    """Radius of the circle of a latitude, in metres."""
    radians = np.radians(latitude)
    return float(EQUATOR * np.cos(radians) / np.sqrt(1.0 - ECCENTRICITY * np.sin(radians) ** 2))


def _scaled(geometry: Any, axes: FloatArray) -> Any:
    return shapely.transform(geometry, lambda points: points * axes)


def _side_by_side(whole: Any) -> Any:
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
    return shapely.union_all([_moved(part, x) for part, x in zip(parts, moves, strict=True)])


def _moved(geometry: Any, x: float) -> Any:
    return shapely.transform(geometry, lambda points: points + np.array((x, 0.0)))
