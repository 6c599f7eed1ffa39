"""Regions that share borders: a cage around all their land, and borders that are simplified once for both sides."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import NestingError, invalid_file
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..levels import Level, Progress, Settings, Wanted, nested_cages
from ..libraries import load_shapely
from ..verification import verify
from .solids import solid

NEEDED_FOR = "Simplifying regions that share borders"

GAPS = 4.0
"""Default width of borders, in mean gaps between a coast and its cage: borders then keep about the same share of their
points as the coast (maps with 3 to 12 % of their vertices)."""

SEARCH_STEPS = 8
"""Halvings of the range of tolerances that the simplification of borders is sought in."""

FINER, COARSER = 1 / 8, 4.0
"""The range of tolerances, in widths: how far a line strays at a tolerance depends on its bends."""

COMMON_GRID = 1e-9
"""Spacing, in diagonals of the land, of the numbers that regions are rounded to if their borders do not match."""

TOUCH = 1e-9
"""Share of a line from a coast to the cage that may lie on land, by rounding."""


@dataclass(frozen=True, eq=False)
class Coverage:
    """Regions that fill a cage around all of them, without gaps or overlaps."""

    regions: tuple[Mesh, ...]
    """One for each region, in the same order. Towards the sea they reach to the cage."""
    coast: Level
    """The certified cage around the land, and its report."""
    width: float
    """Largest distance of a point of a border from the simplified border."""

    @property
    def points(self) -> int:
        """Number of different points of all regions."""
        return len(np.unique(np.concatenate([region.vertices for region in self.regions]), axis=0))


def coverage_cages(
    regions: Sequence[Mesh],
    levels: Wanted | Sequence[Wanted],
    settings: Settings | None = None,
    *,
    width: float | None = None,
    progress: Callable[[Progress], None] | bool | None = None,
) -> list[Coverage]:
    """A cage around all regions for each level, divided among them along simplified borders.

    regions: may share borders, not overlap. levels, settings, progress: those of `nested_cages` for the land, the
    union of all regions; each level holds the one before. width: distance within which borders are simplified;
    default: four times the mean distance between coast and cage.

    No land is cut off; only borders move, for both neighbours alike. Raises NestedCagesError for bad arguments, where
    shapely is missing, and what `nested_cages` raises.
    """
    if width is not None and not 0.0 < width < np.inf:
        raise invalid_file(f"The width of borders must be a positive length, not {width!r}.")
    shapely = load_shapely(NEEDED_FOR)
    inner = _on_common_points(shapely, [shapely.geometry.shape(region) for region in regions])
    land = solid(inner)
    found = []
    for level in nested_cages(land, levels, settings, progress=progress):
        divided = _cells(shapely, inner, shapely.geometry.shape(level.cage))
        gap = (level.cage.area - land.area) / level.cage.edge_lengths.sum()
        simple, strayed = _simplified(shapely, divided, GAPS * gap if width is None else width)
        whole = solid(simple)
        certificate = verify(whole, land, same_loops=False)
        if not certificate:
            raise NestingError(
                f"The regions together do not hold the land: {certificate.problems[0]}.", code="certificate.failed"
            )
        found.append(Coverage(tuple(solid([region]) for region in simple), level, strayed))
        inner, land = simple, whole
    return found


def _on_common_points(shapely: Any, regions: Sequence[Any]) -> list[Any]:
    """Regions whose borders are the same points on both sides; rounded, far below any clearance, where they are not."""
    if shapely.coverage_is_valid(regions):
        return list(regions)
    low_x, low_y, high_x, high_y = shapely.total_bounds(regions)
    rounded = shapely.set_precision(regions, COMMON_GRID * np.hypot(high_x - low_x, high_y - low_y))
    return [before if after.is_empty else after for before, after in zip(regions, rounded, strict=True)]


def _cells(shapely: Any, regions: Sequence[Any], cage: Any) -> list[Any]:
    """The cage divided among regions: each has its land, and the sea in front of its coast."""
    land = shapely.union_all(regions)
    ways = _ways_to_sea(shapely, regions, land, cage)
    rim = _with_vertices(shapely, cage, shapely.get_coordinates(shapely.get_point(ways, 1)))
    lines = [*shapely.boundary(np.array(regions)), shapely.boundary(rim), *ways]
    faces = shapely.get_parts(shapely.polygonize([shapely.union_all(lines)]))
    places = shapely.point_on_surface(faces)
    faces = faces[shapely.contains_properly(rim, places)]
    owner = np.full(len(faces), -1)
    face, region = shapely.STRtree(regions).query(shapely.point_on_surface(faces), predicate="intersects")
    owner[face[::-1]] = region[::-1]  # the first region, where some overlap
    _give_to_neighbours(shapely, faces, owner)
    return [shapely.coverage_union_all(faces[owner == k]) for k in range(len(regions))]


def _ways_to_sea(shapely: Any, regions: Sequence[Any], land: Any, cage: Any) -> Any:
    """Straight lines to the nearest place of the cage from where borders meet the coast, as far as no land is between.

    Shortest lines to a curve don't cross each other.
    """
    own = [np.unique(shapely.get_coordinates(region), axis=0) for region in regions]
    points, count = np.unique(np.concatenate(own), axis=0, return_counts=True)
    coast = {tuple(point) for point in shapely.get_coordinates(land).tolist()}
    shared = [point for point in points[count > 1].tolist() if tuple(point) in coast]
    if not shared:
        return np.zeros(0, dtype=object)
    ways = shapely.shortest_line(shapely.points(shared), shapely.boundary(cage))
    on_land = shapely.length(shapely.intersection(ways, land))
    return ways[on_land <= TOUCH * shapely.length(ways)]


def _with_vertices(shapely: Any, cage: Any, points: FloatArray) -> Any:
    """A cage with further vertices (k, 2) on its edges."""
    rings = [shapely.get_coordinates(ring) for ring in shapely.get_rings(shapely.get_parts(cage))]
    starts, ends = (np.concatenate([ring[part] for ring in rings]) for part in (slice(-1), slice(1, None)))
    edge = np.zeros(0, dtype=int)
    if len(points):
        edges = shapely.linestrings(np.stack((starts, ends), axis=1))
        edge = shapely.STRtree(edges).nearest(shapely.points(points))
    along = np.hypot(*(points - starts[edge]).T)
    number = np.concatenate((np.arange(len(starts)), edge))
    order = np.lexsort((np.concatenate((np.full(len(starts), -1.0), along)), number))
    everything = np.concatenate((starts, points))[order]
    bounds = np.searchsorted(number[order], np.cumsum([len(ring) - 1 for ring in rings])[:-1])
    loops = [loop[(loop != np.roll(loop, 1, axis=0)).any(axis=1)] for loop in np.split(everything, bounds)]
    return shapely.geometry.shape(Mesh.from_loops(loops))


def _give_to_neighbours(shapely: Any, faces: Any, owner: Any) -> None:
    """Give each face without an owner to the one that it shares the longest border with."""
    tree = shapely.STRtree(faces)
    waiting = list(np.flatnonzero(owner < 0))
    while waiting:
        left = []
        for face in waiting:
            near = np.array([k for k in tree.query(faces[face], predicate="intersects") if owner[k] >= 0], dtype=int)
            shared = shapely.length(shapely.intersection(shapely.boundary(faces[near]), shapely.boundary(faces[face])))
            lengths = np.bincount(owner[near], shared)
            if lengths.any():
                owner[face] = int(lengths.argmax())
            else:
                left.append(face)
        if len(left) == len(waiting):
            return
        waiting = left


def _simplified(shapely: Any, coverage: Sequence[Any], width: float) -> tuple[list[Any], float]:
    """The coverage with the fewest points found for borders within a width, and how far they moved."""
    low, high = FINER * width, COARSER * width
    best, strayed = list(coverage), 0.0
    for _ in range(SEARCH_STEPS):
        tolerance = np.sqrt(low * high)
        trial = list(shapely.coverage_simplify(coverage, tolerance, simplify_boundary=False))
        away = _moved_by(shapely, coverage, trial)
        if away <= width:
            best, strayed, low = trial, away, tolerance
        else:
            high = tolerance
    return best, strayed


def _moved_by(shapely: Any, before: Sequence[Any], after: Sequence[Any]) -> float:
    """The largest distance of a point of a region from the outline of the same region afterwards."""
    largest = 0.0
    for region, simple in zip(before, after, strict=True):
        rings = [shapely.get_coordinates(ring) for ring in shapely.get_rings(shapely.get_parts(simple))]
        edges = shapely.linestrings(np.concatenate([np.stack((ring[:-1], ring[1:]), axis=1) for ring in rings]))
        points = shapely.points(shapely.get_coordinates(region))
        _, distance = shapely.STRtree(edges).query_nearest(points, return_distance=True, all_matches=False)
        largest = max(largest, float(distance.max(initial=0.0)))
    return largest
