"""Painted areas and polygons as one solid, which only grows: everything that is given lies in it, by exact predicates.

Valid outlines that are apart from each other keep their coordinates. All others are united by GEOS: gaps and holes
without room for a cage are closed, parts that touch are joined by thin necks, lines without an inside become thin
strips, and corners that rounding has put too far inside are moved outwards until the result holds every ring. A solid
for a cage inside only shrinks in the same way: it is what such a solid of its surroundings leaves free.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import InvalidMeshError, invalid_file
from ..geometry.arrays import FloatArray
from ..geometry.broad_phase import BoxTree
from ..geometry.mesh import Mesh
from ..geometry.mesh.closeness import TOUCHING, has_gaps
from ..geometry.mesh.covering import edge_keys
from ..geometry.predicates import ON_BOUNDARY, segments_intersect, winding_number
from .closing import all_rings, closed_mesh, counted, edges_of, narrow_gaps, place_of
from .closing import rings_in as rings_in
from .closing import shapely as shapely
from .geometries import without_repeated_points
from .limits import Quota

ROOM = 2e-5
"""Width over the diagonal of gaps that have no room for a cage at the default clearance."""

PAIRS_PER_SECOND, CROSSINGS_PER_SECOND, OWN_CROSSINGS_PER_SECOND = 1_000_000, 30_000, 2_000
"""Pairs of edges whose boxes meet, crossings of different outlines and of one with itself united in a second."""

TOUCHING_PER_SECOND, CHAIN_PAIRS_PER_SECOND = 8_000, 500_000
"""Points where parts touch, and pairs of monotone chains whose boxes meet, that are united in a second with all
that follows (measured)."""

SAMPLE, BLOCK = 256, 1_000_000
"""Number of chains whose boxes are held against those of all others, to tell how many pairs meet, and pairs that are
compared at once."""

FEW, SHORT = 500, 0.1
"""Number of edges, and seconds that they take at most, that are united without counting their crossings first."""

Area = Any
"""A painted area, or a geometry of shapely."""


@dataclass(frozen=True, eq=False)
class Painted:
    """Closed loops of points, each (k, 2), in any direction, with one fill rule."""

    loops: Sequence[FloatArray]
    evenodd: bool = False
    """Even-odd fill rule instead of non-zero winding."""
    region: Any = None
    """Its inside as a valid geometry, if it is known."""


def solid(
    areas: Sequence[Area],
    *,
    width: float = 0.0,
    specks: float = 0.0,
    inside: bool = False,
    lines: Sequence[FloatArray] = (),
    quota: Quota | None = None,
    notes: list[str] | None = None,
) -> Mesh:
    """The union of areas as a mesh that holds all of them; at most 3e-5 of the diagonal is added, or the width.

    Parameters
    ----------
    areas : sequence of Painted or shapely.Geometry
        Geometries must be valid.
    width : float, optional
        Gaps and holes narrower than this are closed.
    specks : float, optional
        Parts and spikes narrower than this are left out, holes and gaps as narrow closed. Default: none.
    inside : bool, optional
        For cages inside: the mesh lies in the union, and parts narrower than the width are left out of it.
    lines : sequence of (k, 2) array, optional
        Rings that have to be covered too, even where they enclose nothing.
    quota : Quota, optional
        Limits the time for uniting. Default: no limit.
    notes : list of str, optional
        Gets a sentence on each kind of change, with a place.

    Raises
    ------
    InvalidMeshError
        If nothing is inside, or parts are too close together to be told apart.
    NestedCagesError
        Beyond the quota.
    """
    said = notes if notes is not None else []
    mesh = _plain(areas[0]) if len(areas) == 1 and isinstance(areas[0], Painted) and not specks else None
    if mesh is not None and not has_gaps(mesh, max(width, TOUCHING * mesh.diagonal)):
        return mesh
    parts = [part for part in regions(areas, quota) if part.area > 0.0]
    if not parts:
        raise InvalidMeshError("The shapes have no inside.", code="mesh.empty")
    spend(parts, quota)
    whole = parts[0] if len(parts) == 1 else shapely.union_all(parts)
    rings = [*_given_rings(areas), *lines]
    size = float(np.hypot(*np.ptp(np.concatenate(rings), axis=0))) if rings else 0.0
    if not 0.0 < size < math.inf:
        raise InvalidMeshError("The shapes have no inside, or lie too far apart.", code="mesh.empty")
    if specks > 0.0 and not inside:
        whole = _without_specks(whole, specks, said)
        rings = all_rings([whole])
    if not inside:
        return closed_mesh(whole, rings, size, max(width, specks), said, quota)
    if not np.isin(edge_keys(*edges_of(all_rings([whole]))), edge_keys(*edges_of(rings))).all():
        whole = shapely.buffer(whole, -TOUCHING * size, join_style="mitre")
    frame = shapely.box(*(whole.bounds + size * np.array((-1.0, -1.0, 1.0, 1.0))))
    around = closed_mesh(frame - whole, all_rings([whole]), size, max(width, specks), said, quota)
    low = around.vertices[:, 0].min()
    found = [ring[::-1] for ring in around.rings if ring[:, 0].min() > low]
    if not found:
        raise InvalidMeshError("The shapes have no inside.", code="mesh.empty")
    return Mesh.from_loops(found)


def union_of(areas: Sequence[Area], quota: Quota | None = None) -> Any:
    """The union of areas as a valid geometry. Raises NestedCagesError beyond the quota."""
    parts = regions(areas, quota)
    if len(parts) == 1:
        return parts[0]
    spend(parts, quota)
    return shapely.union_all(parts)


def regions(areas: Sequence[Area], quota: Quota | None = None) -> list[Any]:
    """The inside of each area as a valid geometry: the faces between its loops whose winding numbers are inside."""
    found = []
    for area in areas:
        region = area.region if isinstance(area, Painted) else area
        if region is not None:
            found.append(region)
            continue
        loops = [loop for loop in map(without_repeated_points, area.loops) if len(loop) > 2]
        if len(loops) == 1 and (simple := shapely.Polygon(loops[0])).is_valid:
            found.append(simple)
            continue
        lines = [shapely.LinearRing(loop) for loop in loops]
        spend(lines, quota, own=True)
        faces = shapely.get_parts(shapely.polygonize([shapely.union_all(lines)])) if lines else np.zeros(0, object)
        winding = winding_number(shapely.get_coordinates(shapely.point_on_surface(faces)), *edges_of(loops))
        inside = (winding % 2 == 1 if area.evenodd else winding != 0) | (winding == ON_BOUNDARY)
        found.append(shapely.coverage_union_all(faces[inside]) if inside.any() else shapely.Polygon())
    return found


def _given_rings(areas: Sequence[Area]) -> list[FloatArray]:
    """The outlines of areas as they were given, in any direction, without loops that enclose nothing."""
    loops = [without_repeated_points(loop) for area in areas if isinstance(area, Painted) for loop in area.loops]
    enclosing = [loop for loop in loops if abs(strip_width([loop])) > TOUCHING * np.ptp(loop, axis=0).max()]
    return [*enclosing, *all_rings([area for area in areas if not isinstance(area, Painted)])]


def clipped(areas: Sequence[Area], others: Sequence[Area], *, inside: bool) -> list[Painted]:
    """The part of areas inside of others, or outside of them, as one area; none where that is empty."""
    clip = shapely.intersection if inside else shapely.difference
    rings = rings_in(clip(union_of(areas), union_of(others)))
    return [Painted(rings, evenodd=True)] if rings else []


def joined(mesh: Mesh, distance: float) -> Mesh:
    """A solid with its gaps narrower than a distance closed; without any, unchanged.

    Raises NestedCagesError for a distance that is not positive.
    """
    if not 0.0 < distance < math.inf:
        raise invalid_file(f"The distance must be a positive length, not {distance!r}.")
    notes: list[str] = []
    found = solid([shapely.geometry.shape(mesh.__geo_interface__)], width=distance, notes=notes)
    return found if notes else mesh


def bounds_of(areas: Sequence[Area]) -> tuple[FloatArray, FloatArray]:
    """Lower left and upper right corner of all areas, (2,), (2,); NaN where they are empty."""
    loops = [loop for area in areas if isinstance(area, Painted) for loop in area.loops]
    others = np.array([area for area in areas if not isinstance(area, Painted)], object)
    points = np.concatenate([np.full((1, 2), np.nan), *loops, shapely.bounds(others).reshape(-1, 2)])
    return np.fmin.reduce(points), np.fmax.reduce(points)


def strip_width(loops: Sequence[FloatArray]) -> float:
    """Thickness of loops (k, 2) as thin strips: twice the signed area over the length, negative if clockwise."""
    area, length = 0.0, 0.0
    for loop in loops:
        step = np.diff(loop, axis=0, append=loop[:1])
        x, y = (loop - loop[0]).T
        area += float(x @ step[:, 1] - y @ step[:, 0]) / 2.0
        length += float(np.hypot(*step.T).sum())
    return 2.0 * area / length if length > 0.0 else 0.0


def spend(geometries: Sequence[Any], quota: Quota | None, *, own: bool = False) -> None:
    """Count the time that uniting geometries takes, by the edges that cross or whose boxes meet.

    own: whether they are one outline, which may cross itself. Raises NestedCagesError beyond the quota.
    """
    if quota is None or shapely.get_num_coordinates(geometries).sum() < FEW:
        return
    starts, ends = edges_of(all_rings(geometries, lines=True))
    rate = OWN_CROSSINGS_PER_SECOND if own else CROSSINGS_PER_SECOND
    pairs, chains = _meeting_chains(starts, ends)
    quota.spend("seconds", pairs / CHAIN_PAIRS_PER_SECOND)
    longest = max(pairs - chains, 0.0) * 2.0 * len(starts) / chains / rate  # if all but neighbours cross all along
    if longest < SHORT:
        quota.spend("seconds", longest)
        return
    _, first, copies = np.unique(edge_keys(starts, ends), return_index=True, return_counts=True)
    starts, ends = starts[first], ends[first]
    _, number = np.unique(starts[copies == 1].view(np.complex128), return_counts=True)
    quota.spend("seconds", np.count_nonzero(number > 1) / TOUCHING_PER_SECOND)
    for i, j in BoxTree(starts, ends).blocks():
        quota.spend("seconds", len(i) / PAIRS_PER_SECOND)
        apart = (starts[i] != ends[j]).any(axis=1) & (starts[j] != ends[i]).any(axis=1)
        apart &= (starts[i] != starts[j]).any(axis=1) & (ends[i] != ends[j]).any(axis=1)
        i, j = i[apart], j[apart]
        crossing = segments_intersect(starts[i], ends[i], starts[j], ends[j])
        quota.spend("seconds", float(copies[i[crossing]] @ copies[j[crossing]]) / rate)


def _meeting_chains(starts: FloatArray, ends: FloatArray) -> tuple[float, int]:
    """About how many pairs of chains have boxes that meet, and the number of chains.

    GEOS compares monotone chains of edges (E, 2) -> (E, 2).
    """
    turns = ((ends[1:] >= starts[1:]) != (ends[:-1] >= starts[:-1])).any(axis=1)
    turns |= (ends[:-1] != starts[1:]).any(axis=1)
    first, last = np.flatnonzero(np.append(True, turns)), np.flatnonzero(np.append(turns, True))
    low, high = np.minimum(starts[first], ends[last]).T.copy(), np.maximum(starts[first], ends[last]).T.copy()
    chosen = np.linspace(0, len(first) - 1, min(SAMPLE, len(first))).astype(np.int64)[:, None]
    blocks = np.array_split(chosen, math.ceil(len(chosen) * len(first) / BLOCK))
    found = sum(
        np.count_nonzero(
            (low[0] <= high[0, k]) & (high[0] >= low[0, k]) & (low[1] <= high[1, k]) & (high[1] >= low[1, k])
        )
        for k in blocks
    )
    return 0.5 * len(first) * (found / len(chosen) - 1.0), len(first)


def _plain(area: Painted) -> Mesh | None:
    """An area of loops that neither meet nor lie in each other in the same direction; None for others."""
    loops = [loop for loop in map(without_repeated_points, area.loops) if len(loop) > 2]
    with suppress(InvalidMeshError):
        mesh = Mesh.from_loops(loops)
        first = mesh.loop_order.begins
        turns = np.where(mesh.successor[first] == first + 1, mesh.loop_signs, -mesh.loop_signs)
        if area.evenodd or abs((turns * mesh.loop_signs).sum()) == len(loops):
            return mesh
    return None


def _without_specks(whole: Any, width: float, said: list[str]) -> Any:
    """A region without parts and spikes narrower than a width; what joins others stays."""
    frame = shapely.box(*(whole.bounds + width * np.array((-9.0, -9.0, 9.0, 9.0))))
    narrow = np.array(narrow_gaps(frame - whole, width), object)
    body = shapely.difference(whole, shapely.union_all(narrow))
    contacts = shapely.line_merge(shapely.intersection(shapely.boundary(narrow), body))
    loose = narrow[shapely.get_num_geometries(contacts) < 2]
    if not len(loose) or body.is_empty:
        return whole
    longest = loose[int(np.argmax(shapely.length(loose)))]
    said.append(
        f"{counted(len(loose), 'part')} narrower than {width:.3g}, the longest at {place_of(longest)} with a length of "
        f"{0.5 * longest.length:.3g}: left out"
    )
    return shapely.difference(whole, shapely.union_all(loose))
