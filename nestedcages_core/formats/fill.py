"""Painted areas as one solid: fill rules, overlaps and self-crossings resolved."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import InvalidMeshError, invalid_file, no_outline
from ..geometry.arrays import BoolArray, FloatArray, IntArray
from ..geometry.loops import enclosing_pairs, extreme_places
from ..geometry.mesh import Mesh
from ..geometry.predicates import ON_BOUNDARY, winding_number
from ..libraries import load_shapely
from .crossings import spend_crossings, spend_nestings, spend_union
from .hairlines import MARGIN, comes_close, has_hairlines, without_hairlines, without_short_edges
from .limits import Quota

GRIDS = (0.0, 2.0**-38, 2.0**-30, 2.0**-24)
"""Spacings, in diagonals rounded up to a power of two, of the grids that a union is rounded to, tried in turn: none,
unless edges or vertices are too close to tell; the coarsest is a ten-thousandth of the default tolerance of curves."""

NECK_PER_SIZE = 1e-6
"""Half the width of the necks between parts that touch in points, over the square root of the area."""

LEAST_NECK = 64.0 * float(np.finfo(float).eps)
"""Lower bound of the same, over the largest coordinate, so that it survives rounding."""

ROUNDING = 2.0**-40
"""Distance, in diagonals, below which parts touch: sums of the decimals in a file differ by the rounding of doubles,
far less than any program draws, and no cage fits between."""


@dataclass(frozen=True, eq=False)
class Painted:
    """Closed loops of points, each (k, 2), in any direction, with one fill rule."""

    loops: Sequence[FloatArray]
    evenodd: bool = False
    """Even-odd fill rule instead of non-zero winding."""

    def cleaned(self) -> Painted:
        """The same without repeated points and loops of zero area."""
        following = [np.concatenate([points[1:], points[:1]]) for points in self.loops]  # faster than np.roll
        different = [p[(p != after).any(axis=1)] for p, after in zip(self.loops, following, strict=True)]
        return Painted([loop for loop in different if len(loop) > 2], self.evenodd)


Area = Painted | Any
"""A painted area, or a geometry of shapely."""


def solid(
    areas: Sequence[Area],
    *,
    seam: float = 0.0,
    spike: float = 0.0,
    quota: Quota | None = None,
    notes: list[str] | None = None,
) -> Mesh:
    """The union of areas as a mesh. Loops keep their coordinates exactly; only crossings add points.

    Where parts are closer than the rounding of their coordinates they touch, and the whole is rounded as finely.
    seam, spike: widths below which gaps are closed and spikes cut off, which `notes` then says with their numbers;
    quota: for crossings, unlimited if None.

    Where the union touches itself in a point it is joined by a thin neck. Raises InvalidMeshError where nothing is
    inside, NestedCagesError where loops cross and shapely is missing, or more often than the quota allows.
    """
    options: dict[str, Any] = {"seam": seam, "spike": spike, "quota": quota, "notes": notes}
    if not all(isinstance(area, Painted) for area in areas):
        shapely = load_shapely("Reading shapes that overlap or touch")
        return united(shapely, regions(shapely, areas, quota), **options)
    cleaned = [area.cleaned() for area in areas]
    loops = [loop for area in cleaned for loop in area.loops]
    if not loops:
        raise no_outline("The shapes have no inside: every loop is shorter than three different points.")
    spend_nestings(loops, quota)
    mesh = None
    with suppress(InvalidMeshError):
        mesh = Mesh.from_loops(loops)
    if mesh is None or comes_close(mesh, ROUNDING * mesh.diagonal) or has_hairlines(mesh, max(seam, spike)):
        shapely = load_shapely("Reading shapes that overlap or touch")
        return united(shapely, regions(shapely, cleaned, quota), **options)
    kept = _on_the_rim(mesh, cleaned)
    if not kept.any():
        raise InvalidMeshError("The shapes have no inside.", code="mesh.empty")
    return mesh if kept.all() else Mesh.from_loops([loops[k] for k in np.flatnonzero(kept)])


def union_of(shapely: Any, areas: Sequence[Area], quota: Quota | None = None) -> Any:
    """The union of areas as a valid geometry. Raises NestedCagesError beyond the quota."""
    parts = regions(shapely, areas, quota)
    spend_union(shapely, parts, quota)
    return shapely.union_all(parts)


def regions(shapely: Any, areas: Sequence[Area], quota: Quota | None = None) -> list[Any]:
    """The inside of each area as a valid geometry. Raises NestedCagesError beyond the quota."""
    cleaned = [area.cleaned() if isinstance(area, Painted) else area for area in areas]
    single = [k for k, area in enumerate(cleaned) if isinstance(area, Painted) and len(area.loops) == 1]
    outlines = shapely.polygons(_linear_rings(shapely, [cleaned[k].loops[0] for k in single]))
    simple = {k: outline for k, outline in zip(single, outlines, strict=True) if shapely.is_valid(outline)}
    return [
        simple[k] if k in simple else _region(shapely, area, quota) if isinstance(area, Painted) else area
        for k, area in enumerate(cleaned)
    ]


def clipped(areas: Sequence[Area], others: Sequence[Area], *, inside: bool) -> list[Painted]:
    """The part of areas inside of others, or outside of them, as one area; none where that is empty.

    Raises NestedCagesError where shapely is missing.
    """
    shapely = load_shapely("shapes that hide others")
    clip = shapely.intersection if inside else shapely.difference
    rings = rings_in(shapely, clip(union_of(shapely, areas), union_of(shapely, others)))
    return [Painted(rings, evenodd=True)] if rings else []


def bounds_of(areas: Sequence[Area]) -> tuple[FloatArray, FloatArray]:
    """Lower left and upper right corner of all areas, (2,), (2,); NaN where they are empty."""
    corners = [np.full((1, 2), np.nan)]
    for area in areas:
        corners += list(area.loops) if isinstance(area, Painted) else [np.reshape(area.bounds, (-1, 2))]
    points = np.concatenate(corners)
    return np.fmin.reduce(points), np.fmax.reduce(points)


def united(
    shapely: Any,
    parts: Sequence[Any],
    *,
    seam: float = 0.0,
    spike: float = 0.0,
    quota: Quota | None = None,
    notes: list[str] | None = None,
) -> Mesh:
    """The union of valid geometries as a mesh; options as of `solid`.

    Raises InvalidMeshError where nothing is inside, NestedCagesError beyond the quota.
    """
    spend_union(shapely, parts, quota)
    bounds = np.zeros(4) if np.all(shapely.is_empty(parts)) else shapely.total_bounds(parts)
    size = float(np.hypot(bounds[2] - bounds[0], bounds[3] - bounds[1]))
    if not size > 0.0:
        raise InvalidMeshError("The shapes have no inside.", code="mesh.empty")
    unit = 2.0 ** np.ceil(np.log2(size))
    clean = without_hairlines(shapely, shapely.union_all(parts), gap=seam, spike=spike)
    note = clean.note(max(seam, spike)) if clean.gaps or clean.spikes else ""
    failed: InvalidMeshError | None = None
    found: Mesh | None = None
    for grid in GRIDS:
        region = shapely.set_precision(clean.region, grid * unit) if grid else clean.region
        try:
            mesh = _region_mesh(shapely, region, max(seam, spike) if note else 0.0)
        except InvalidMeshError as error:
            failed = failed or error
            continue
        apart = not comes_close(mesh, ROUNDING * mesh.diagonal)
        found = mesh if apart or found is None else found
        if apart:
            break
    if found is None:
        assert failed is not None
        raise failed
    if notes is not None and note:
        notes.append(note)
    return found


def _region_mesh(shapely: Any, region: Any, width: float) -> Mesh:
    """The mesh of a valid region, joined by thin necks where it touches itself; width: of hairlines that are gone."""
    rings = rings_in(shapely, region)
    if not rings:
        raise InvalidMeshError("The shapes have no inside.", code="mesh.empty")
    with suppress(InvalidMeshError):
        return _without_remnants(rings, width)
    starts, ends = _edges_of(rings)
    edges = shapely.linestrings(np.stack((starts, ends), axis=1))
    vertex, _ = shapely.STRtree(edges).query(shapely.points(starts), predicate="intersects")
    touching = np.unique(starts[np.bincount(vertex, minlength=len(starts)) > 2], axis=0)
    reach = max(NECK_PER_SIZE * np.sqrt(region.area), LEAST_NECK * np.abs(region.bounds).max())
    necks = shapely.buffer(shapely.points(touching), reach, quad_segs=1)
    rings = rings_in(shapely, shapely.union_all([region, *necks]))
    with suppress(InvalidMeshError):
        return _without_remnants(rings, width)
    return Mesh.from_loops(rings)


def _without_remnants(rings: list[FloatArray], width: float) -> Mesh:
    """The mesh of rings without the short edges, specks and slivers that closed gaps leave. Raises InvalidMeshError."""
    wide = [
        without_short_edges(ring, width)
        for ring in rings
        if np.ptp(ring, axis=0).max() >= width and abs(strip_width([ring])) >= MARGIN * width
    ]
    return Mesh.from_loops(wide or rings)


def rings_in(shapely: Any, geometry: Any) -> list[FloatArray]:
    """The rings (k, 2) of all polygons, not closed, with the inside to their left."""
    polygons = [part for part in shapely.get_parts(geometry) if part.geom_type == "Polygon" and part.area > 0.0]
    rings = shapely.get_rings(shapely.orient_polygons(polygons)) if polygons else []
    return [shapely.get_coordinates(ring)[:-1] for ring in rings]


def _region(shapely: Any, area: Painted, quota: Quota | None) -> Any:
    """The inside of loops that may cross: the faces between them whose winding numbers are inside."""
    if not area.loops:
        return shapely.Polygon()
    starts, ends = _edges_of(area.loops)
    spend_crossings((starts, ends), quota, own=True)
    lines = shapely.union_all(_linear_rings(shapely, area.loops))
    faces = shapely.get_parts(shapely.polygonize([lines]))
    winding = winding_number(shapely.get_coordinates(shapely.point_on_surface(faces)), starts, ends)
    inside = winding % 2 == 1 if area.evenodd else winding != 0
    kept = inside | (winding == ON_BOUNDARY)  # a face without area is a seam
    return shapely.coverage_union_all(faces[kept])


def strip_width(loops: Sequence[FloatArray]) -> float:
    """Thickness of loops (k, 2) as thin strips: twice the signed area over the length, negative if clockwise."""
    area, length = 0.0, 0.0
    for loop in loops:
        step = np.diff(loop, axis=0, append=loop[:1])
        x, y = (loop - loop[0]).T
        area += float(x @ step[:, 1] - y @ step[:, 0]) / 2.0
        length += float(np.hypot(*step.T).sum())
    return 2.0 * area / length if length > 0.0 else 0.0


def _linear_rings(shapely: Any, loops: Sequence[FloatArray]) -> Any:
    """(L,) loops as rings."""
    if not loops:
        return np.zeros(0, dtype=object)
    return shapely.linearrings(np.concatenate(loops), indices=np.repeat(np.arange(len(loops)), [len(p) for p in loops]))


def _edges_of(loops: Sequence[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Ends (E, 2), (E, 2) of all edges of loops."""
    return np.concatenate(loops), np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])


def _on_the_rim(mesh: Mesh, areas: Sequence[Painted]) -> BoolArray:
    """(L,) whether a loop has painted places on one side only.

    mesh: made of the areas' loops, in their order, which neither cross nor touch.
    """
    order = mesh.loop_order
    own = np.where(mesh.successor[order.begins] == order.begins + 1, mesh.loop_signs, -mesh.loop_signs)
    owner = np.repeat(np.arange(len(areas)), [len(area.loops) for area in areas])
    evenodd = np.array([area.evenodd for area in areas], dtype=bool)

    def any_painted(inner: IntArray, outer: IntArray) -> BoolArray:
        """(L,) whether any area paints the place inside of all loops `outer` that are paired with a loop `inner`."""
        keys, index = np.unique(inner * len(areas) + owner[outer], return_inverse=True)
        winding = np.bincount(index.ravel(), own[outer], len(keys)).astype(np.int64)
        loop, area = np.divmod(keys, len(areas))
        painted = np.zeros(len(own), dtype=bool)
        painted[loop[np.where(evenodd[area], winding % 2 == 1, winding != 0)]] = True
        return painted

    inner, outer = enclosing_pairs(order.vertices[extreme_places(order)], order)
    itself = np.arange(len(own))
    outside = any_painted(inner, outer)
    return np.asarray(outside != any_painted(np.append(inner, itself), np.append(outer, itself)))


def joined(mesh: Mesh, distance: float) -> Mesh:
    """A solid with its gaps narrower than `distance` filled; all other vertices keep their coordinates.

    Gaps are between components or inside one, such as a slit. Without any, the mesh is returned unchanged.
    Raises NestedCagesError for a distance that is not positive.
    """
    if not 0.0 < distance < math.inf:
        raise invalid_file(f"The distance must be a positive length, not {distance!r}.")
    shapely = load_shapely("Reading parts that nearly touch")
    (solid,) = regions(shapely, [Painted([mesh.vertices[loop] for loop in mesh.loops])])
    found = without_hairlines(shapely, solid, gap=distance)
    return united(shapely, [found.region]) if found.gaps else mesh
