"""Regions that share borders: a cage around all their land, and borders that are simplified once for both sides."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import NestingError, invalid_file
from ..levels import Level, Progress, Settings, Wanted, nested_cages
from .solids import shapely, solid

FARTHEST = 0.05
"""Maximum tolerance of borders where no width is given, in diagonals."""

STEPS, FINEST, COARSER = 10, 1e-3, 4.0
"""Halvings of the range of tolerances of borders, its least part, and its end over a width that is given."""

COMMON_GRID, TOUCH, BEYOND = 1e-9, 1e-9, 1e-6
"""Spacing, in diagonals, of the numbers that regions are rounded to if their borders do not match; share of a line from
a coast to the cage that may lie on land, by rounding; and by how much it goes on behind the cage."""


@dataclass(frozen=True, eq=False)
class Coverage:
    """Regions that fill a cage around all of them, without gaps or overlaps."""

    regions: tuple[Any, ...]
    """Of shapely, one for each region in the same order. Towards the sea they reach to the cage."""
    coast: Level
    """The certified cage around the land, and its report."""
    width: float
    """Largest distance of a point of a border from the simplified border."""

    @property
    def points(self) -> int:
        """Number of different points of all regions."""
        return _count(self.regions)


def coverage_cages(
    regions: Sequence[Any],
    levels: Wanted | Sequence[Wanted],
    settings: Settings | None = None,
    *,
    width: float | None = None,
    progress: Callable[[Progress], None] | bool | None = None,
) -> list[Coverage]:
    """A cage around all regions for each level, divided among them along simplified borders.

    regions: polygons with `__geo_interface__`, of shapely or meshes, which may share borders, but not overlap. levels,
    settings, progress: those of `nested_cages` for the union of all regions; each level holds the one before. width:
    distance within which borders are simplified; default: they keep the same share of points as the coast.

    No land is cut off; only borders move, for both neighbours alike. Raises NestedCagesError for bad arguments, where
    shapely is missing, and what `nested_cages` raises.
    """
    if width is not None and not 0.0 < width < np.inf:
        raise invalid_file(f"The width of borders must be a positive length, not {width!r}.")
    inner = _on_common_points([shapely.geometry.shape(region) for region in regions])
    found = []
    for level in nested_cages(solid(inner), levels, settings, progress=progress):
        farthest = FARTHEST * level.cage.diagonal if width is None else COARSER * width
        least = len(level.cage.vertices) / len(level.fine.vertices) * _count(inner)
        inner, strayed = _simplified(_cells(inner, shapely.geometry.shape(level.cage)), farthest, least, width)
        if not shapely.coverage_is_valid(inner):
            raise NestingError(
                "The regions are too thin to be divided along simple borders.", code="certificate.failed"
            )
        found.append(Coverage(tuple(inner), level, strayed))
    return found


def _on_common_points(regions: Sequence[Any]) -> list[Any]:
    """Regions whose borders are the same points on both sides; rounded where they are not."""
    if shapely.coverage_is_valid(regions):
        return list(regions)
    bounds = shapely.total_bounds(regions)
    rounded = shapely.set_precision(regions, COMMON_GRID * float(np.hypot(*(bounds[2:] - bounds[:2]))))
    return [before if after.is_empty else after for before, after in zip(regions, rounded, strict=True)]


def _cells(regions: Sequence[Any], cage: Any) -> list[Any]:
    """The cage divided among regions: each has its land, and the sea in front of its coast."""
    lines = [*shapely.boundary(np.array(regions)), shapely.boundary(cage), *_ways_to_sea(regions, cage)]
    faces = shapely.get_parts(shapely.polygonize([shapely.union_all(lines)]))
    faces = faces[shapely.contains_properly(cage, shapely.point_on_surface(faces))]
    owner = np.full(len(faces), -1)
    face, region = shapely.STRtree(regions).query(shapely.point_on_surface(faces), predicate="intersects")
    owner[face[::-1]] = region[::-1]  # the first region, where some overlap
    _give_to_neighbours(faces, owner)
    return [shapely.coverage_union_all(faces[owner == k]) for k in range(len(regions))]


def _ways_to_sea(regions: Sequence[Any], cage: Any) -> Any:
    """Straight lines to the nearest place of the cage, and a little beyond, from where borders meet the coast, as far
    as no land is between. Shortest lines to a curve don't cross each other."""
    land = shapely.union_all(regions)
    own = [np.unique(shapely.get_coordinates(region), axis=0) for region in regions]
    points, count = np.unique(np.concatenate(own), axis=0, return_counts=True)
    coast = np.unique(shapely.get_coordinates(land), axis=0)
    points, count = np.unique(np.concatenate([points[count > 1], coast]), axis=0, return_counts=True)
    shared = points[count > 1]
    ways = shapely.shortest_line(shapely.points(shared), shapely.boundary(cage))
    on_land = shapely.length(shapely.intersection(ways, land))
    ends = shapely.get_coordinates(ways[on_land <= TOUCH * shapely.length(ways)]).reshape(-1, 2, 2)
    ends[:, 1] += BEYOND * (ends[:, 1] - ends[:, 0])
    return shapely.linestrings(ends)


def _give_to_neighbours(faces: Any, owner: Any) -> None:
    """Give each face without an owner to the one that it shares the longest border with."""
    tree, rims = shapely.STRtree(faces), shapely.boundary(faces)
    for _ in range(len(faces)):
        waiting = np.flatnonzero(owner < 0)
        for face in waiting:
            near = np.array([k for k in tree.query(faces[face], predicate="intersects") if owner[k] >= 0], dtype=int)
            shared = shapely.length(shapely.intersection(rims[near], rims[face]))
            if shared.any():
                owner[face] = int(np.bincount(owner[near], shared).argmax())
        if (owner[waiting] < 0).all():
            return


def _simplified(coverage: Sequence[Any], farthest: float, least: float, width: float | None) -> tuple[list[Any], float]:
    """The coverage with the simplest borders, moved at most by a width or of a least count of points, and how far."""
    low, high, best, strayed = FINEST * farthest, farthest, list(coverage), 0.0
    for _ in range(STEPS):
        tolerance = np.sqrt(low * high)
        trial = list(shapely.coverage_simplify(coverage, tolerance, simplify_boundary=False))
        away = _moved_by(coverage, trial)
        if shapely.coverage_is_valid(trial) and (_count(trial) >= least if width is None else away <= width):
            best, strayed, low = trial, away, tolerance
        else:
            high = tolerance
    return best, strayed


def _moved_by(before: Sequence[Any], after: Sequence[Any]) -> float:
    """The largest distance of a point of a region from the outline of the same region afterwards."""
    points = [shapely.points(shapely.get_coordinates(region)) for region in before]
    pairs = zip(points, shapely.boundary(np.array(after, object)), strict=True)
    return max(float(shapely.distance(each, line).max(initial=0.0)) for each, line in pairs)


def _count(regions: Sequence[Any]) -> int:
    """Number of different points."""
    return len(np.unique(shapely.get_coordinates(list(regions)), axis=0))
