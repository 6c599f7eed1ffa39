"""A region as a mesh that holds rings exactly: gaps are closed, parts that touch joined, corners moved outwards."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from ..errors import InvalidMeshError
from ..geometry.arrays import FloatArray
from ..geometry.broad_phase import BoxTree, near_pairs
from ..geometry.mesh import Mesh
from ..geometry.mesh.closeness import TOUCHING, close_vertices, has_gaps
from ..geometry.mesh.covering import uncovered_edges
from ..geometry.predicates import orientation
from ..geometry.vectors import format_point
from ..libraries import needed
from .limits import Quota

with needed("shapely", "Reading shapes"):
    import shapely as shapely

NECK = 1e-6
"""Half the width of strips, and of necks in the first attempt, over the diagonal; 1.5e-5 in all attempts together."""

ATTEMPTS, NECK_ATTEMPTS = 10, 2
"""Attempts to join parts that touch and to cover lines, and the last of these by necks; then all grows."""

PUSH, PUSHES = 4.0 * float(np.finfo(float).eps), 6
"""First distance by which corners are moved outwards, over the largest coordinate; each further one is 16 times it."""

MITRE, NOTCH = 1.8, 50.0
"""Maximum mitre length of offsets outwards, and of offsets back: notches above 2.3 degrees stay."""

CLOSED_PER_SECOND = 50_000
"""Points of outlines whose gaps are closed in a second (measured)."""


def closed_mesh(
    whole: Any, rings: Sequence[FloatArray], size: float, width: float, said: list[str], quota: Quota | None
) -> Mesh:
    """A region as a mesh that holds all rings, its gaps closed. Raises InvalidMeshError."""
    failed = InvalidMeshError("The shapes are too close together to be told apart.", code="mesh.crossing")
    width, closed = max(width, TOUCHING * size), False
    for attempt in range(ATTEMPTS):
        reach, outlines, mesh = NECK * size * (attempt + 1), rings_in(whole), None
        try:
            mesh = Mesh.from_loops(outlines)
        except InvalidMeshError as error:
            failed = error
        touching = _touching(outlines) if mesh is None else np.zeros((0, 2))
        if not closed and not len(touching) and (mesh is None or has_gaps(mesh, width)):
            if quota is not None:
                quota.spend("seconds", sum(map(len, outlines)) / CLOSED_PER_SECOND)
            whole, closed = _without_gaps(whole, width, said), True
            continue
        if closed and mesh is not None:
            touching = mesh.vertices[close_vertices(mesh, TOUCHING * size)]
        if attempt <= NECK_ATTEMPTS and len(touching):
            where = f"{counted(len(touching), 'point')}, the first {format_point(touching[0])}"
            said.append(f"parts touch in {where}: joined")
            whole = shapely.union_all([whole, *shapely.buffer(shapely.points(touching), reach, quad_segs=1)])
        elif mesh is None:
            whole = shapely.buffer(whole, NECK * size, join_style="mitre", mitre_limit=MITRE)
        else:
            mesh, starts, ends = _pushed(mesh, rings, size)
            if not len(starts):
                return mesh
            edges = shapely.linestrings(np.stack((starts, ends), axis=1))
            said.append(f"{counted(len(edges), 'line')}, the first at {place_of(edges[0])}: covered by thin strips")
            strips = shapely.buffer(edges, NECK * size, cap_style="square", join_style="mitre")
            whole = shapely.union_all([shapely.geometry.shape(mesh), *strips])
    raise failed


def _touching(rings: Sequence[FloatArray]) -> FloatArray:
    """The points (k, 2) that rings have in common, or else those of one on an edge of another or of itself."""
    vertices, ends = edges_of(rings)
    places, number = np.unique(vertices, axis=0, return_counts=True)
    if (number > 1).any():
        return np.asarray(places[number > 1])
    on_edge = [np.zeros((0, 2))]
    for k, edge in BoxTree(vertices, vertices).blocks(BoxTree(vertices, ends)):
        point, start, end = vertices[k], vertices[edge], ends[edge]
        between = (point != start).any(axis=1) & (point != end).any(axis=1)
        between &= ((np.minimum(start, end) <= point) & (point <= np.maximum(start, end))).all(axis=1)
        on_edge.append(point[between][orientation(start[between], end[between], point[between]) == 0])
    return np.unique(np.concatenate(on_edge), axis=0)


def _pushed(mesh: Mesh, rings: Sequence[FloatArray], size: float) -> tuple[Mesh, FloatArray, FloatArray]:
    """A mesh with corners moved outwards by about the rounding, to hold rings, and ends of the edges left outside."""
    given, number, push = mesh, 0, PUSH * float(np.abs(mesh.vertices).max())
    starts, ends = first = uncovered_edges(mesh, rings)
    for attempt in range(PUSHES):
        if not len(starts) or (attempt >= PUSHES // 2 and len(starts) == number):
            break
        number = len(starts)
        vertex = np.unique(near_pairs(mesh.vertices, starts, ends, TOUCHING * size)[0])
        here, before, after = (mesh.vertices[k] for k in (vertex, mesh.predecessor[vertex], mesh.successor[vertex]))
        back, on = (step / np.hypot(*step.T)[:, None] for step in (before - here, after - here))
        outwards = np.stack((on[:, 1] - back[:, 1], back[:, 0] - on[:, 0]), axis=1)  # the normals of both edges
        outwards += np.where((outwards * (back + on)).sum(axis=1)[:, None] < 0.0, -1.0, 1.0) * (back + on)
        moved = mesh.vertices.copy()
        moved[vertex] += push * outwards / np.hypot(*outwards.T)[:, None]
        mesh = mesh.moved(moved)
        starts, ends = uncovered_edges(mesh, list(np.stack((starts, ends), axis=1)))
        starts, ends = (starts, ends) if len(starts) else uncovered_edges(mesh, rings)
        push *= 16.0
    try:
        return mesh.validated(), starts, ends
    except InvalidMeshError:
        return given, *first


def _without_gaps(whole: Any, width: float, said: list[str]) -> Any:
    """A region with gaps and holes narrower than a width closed."""
    parts, gaps = [], []
    for part in shapely.get_parts(whole):
        lakes = np.array([shapely.Polygon(ring) for ring in part.interiors], object)
        narrow = 2.0 * shapely.area(lakes) < width * shapely.length(lakes)
        gaps += list(lakes[narrow])
        parts.append(
            shapely.Polygon(part.exterior, shapely.get_exterior_ring(lakes[~narrow])) if narrow.any() else part
        )
    whole = shapely.multipolygons(parts)
    gaps += narrow_gaps(whole, width)
    if not gaps:
        return whole
    said.append(f"{counted(len(gaps), 'gap')} narrower than {width:.3g}, the first at {place_of(gaps[0])}: closed")
    return shapely.union_all([whole, *gaps])


def narrow_gaps(region: Any, width: float) -> list[Any]:
    """What closing adds to a region so that no gap in it is narrower than a width, beyond rounding."""
    reach, margin = 0.5 * width, 1e-3 * width
    with suppress(shapely.errors.GEOSException):
        wider = shapely.buffer(region, reach, join_style="mitre", mitre_limit=MITRE)
        deep, back = (
            shapely.difference(shapely.buffer(wider, by, join_style="mitre", mitre_limit=NOTCH), region)
            for by in (-reach - margin, -reach)
        )
        gaps = shapely.get_parts(back)
        gaps = gaps[shapely.area(gaps) > 0.0]
        _, found = shapely.STRtree(gaps).query(shapely.get_parts(deep), predicate="intersects")
        return list(gaps[np.unique(found)])
    return []


def rings_in(geometry: Any) -> list[FloatArray]:
    """The rings (k, 2) of all polygons, not closed, with the inside to their left."""
    polygons = [part for part in shapely.get_parts(geometry) if part.geom_type == "Polygon" and part.area > 0.0]
    return all_rings(shapely.orient_polygons(polygons)) if polygons else []


def all_rings(geometries: Sequence[Any], *, lines: bool = False) -> list[FloatArray]:
    """The rings (k, 2) of polygons, not closed; lines: those of lines too, which are closed then."""
    parts = shapely.get_parts(shapely.get_parts(np.array(geometries, object)))
    rings = shapely.get_rings(parts)
    if lines:
        rings = np.concatenate([rings, parts[shapely.get_dimensions(parts) == 1]])
    points, ring = shapely.get_coordinates(rings, return_index=True)
    begins = np.searchsorted(ring, np.arange(1, len(rings)))
    return [each[:-1] if (each[0] == each[-1]).all() else each for each in np.split(points, begins) if len(each)]


def edges_of(loops: Sequence[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Ends (E, 2), (E, 2) of all edges of loops."""
    none = np.zeros((0, 2))
    return np.concatenate([none, *loops]), np.concatenate([none, *(np.roll(loop, -1, axis=0) for loop in loops)])


def place_of(shape: Any) -> str:
    return format_point(shapely.get_coordinates(shape)[0])


def counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
