"""How two parts meet: what they share, the largest disc in it, and where along each of them it lies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..geometry.arrays import FloatArray
from ..libraries import load_shapely
from .part import AT_END, NEEDED_FOR, STUBBY, PuppetPart, largest_disc

NEAR = 0.2
"""Parts this far apart may still hang together, in radii of the smaller one: drawn apart by a stroke, or cut out."""

NEARLY = 0.9
"""A joint needs at least this much of the largest disc in an overlap around it."""

WIDENED = 0.25
"""Parts that do not overlap are widened by this much of that distance, beyond half the gap between them."""


@dataclass(frozen=True, eq=False)
class Meeting:
    """Two parts that overlap, touch, or nearly do."""

    shared: Any
    """Their overlap; where they only touch or are apart, that of the parts widened until they overlap."""
    area: float
    """Of the overlap as drawn, 0 where they are apart."""
    gap: float
    """Distance between the parts as drawn."""

    @cached_property
    def disc(self) -> tuple[FloatArray, float]:
        """Centre (2,) and radius of the largest disc in what they share."""
        return largest_disc(self.shared)

    def pin(self, part: PuppetPart) -> tuple[FloatArray, float]:
        """Where a part turns (2,), and the radius of the disc there.

        Of all places with nearly the largest disc, the one nearest to the part's end; their middle for a part that has
        no ends or does not hang by one.
        """
        shapely = load_shapely(NEEDED_FOR)
        middle, radius = self.disc
        room = [each for each in shapely.get_parts(self.shared.buffer(-NEARLY * radius)) if each.area > 0.0]
        if not room:
            return middle, radius
        places = max(room, key=lambda each: float(each.area))
        low, high = self.span(part)
        towards = shapely.centroid(places)
        if part.slenderness >= STUBBY and min(low, 1.0 - high) < AT_END <= max(low, 1.0 - high):
            towards = shapely.points(part.ends[0 if low < 1.0 - high else 1])
        pin = shapely.get_coordinates(shapely.shortest_line(places, towards))[0]
        return pin, float(shapely.distance(shapely.boundary(self.shared), shapely.points(pin)))

    @cached_property
    def length(self) -> float:
        """Longer side of the smallest rectangle around what they share."""
        shapely = load_shapely(NEEDED_FOR)
        corners = shapely.get_coordinates(shapely.oriented_envelope(self.shared))
        return float(np.hypot(*np.diff(corners, axis=0).T).max(initial=0.0))

    def span(self, part: PuppetPart, *, across: bool = False) -> tuple[float, float]:
        """From where to where it lies along a part, 0 and 1 at the part's ends, or across it."""
        places = part.along(load_shapely(NEEDED_FOR).get_coordinates(self.shared), across=across)
        return float(places.min()), float(places.max())


class Meetings:
    """The meetings of all pairs of some parts."""

    def __init__(self, parts: Sequence[PuppetPart]) -> None:
        shapely = load_shapely(NEEDED_FOR)
        solids = [part.solid for part in parts]
        radii = np.array([part.disc[1] for part in parts])
        tree = shapely.STRtree(solids)
        self._of: dict[tuple[int, int], Meeting] = {}
        self.near: list[list[int]] = [[] for _ in parts]
        """Numbers of the parts that each one meets."""
        for i, j in tree.query(solids, predicate="dwithin", distance=NEAR * radii).T.tolist():
            if i < j or (i > j and (j, i) not in self._of):
                i, j = min(i, j), max(i, j)
                reach = NEAR * min(radii[i], radii[j])
                gap = float(shapely.distance(solids[i], solids[j]))
                if gap <= reach and (i, j) not in self._of:
                    self._of[i, j] = _meeting_of(solids[i], solids[j], gap, reach)
                    self.near[i].append(j)
                    self.near[j].append(i)

    def __getitem__(self, pair: tuple[int, int]) -> Meeting:
        return self._of[min(pair), max(pair)]

    def get(self, i: int, j: int) -> Meeting | None:
        """The meeting of two parts, None if they are farther apart."""
        return self._of.get((min(i, j), max(i, j)))


def _meeting_of(one: Any, other: Any, gap: float, reach: float) -> Meeting:
    shapely = load_shapely(NEEDED_FOR)
    shared = _areas_of(shapely.intersection(one, other))
    area = float(shared.area)
    if area > 0.0:
        return Meeting(shared, area, 0.0)
    wide = 0.5 * gap + WIDENED * reach
    return Meeting(_areas_of(shapely.intersection(one.buffer(wide), other.buffer(wide))), 0.0, gap)


def _areas_of(shared: Any) -> Any:
    """A geometry without points and lines, in which outlines only touch: these have no radius."""
    if shared.geom_type != "GeometryCollection":
        return shared
    shapely = load_shapely(NEEDED_FOR)
    return shapely.MultiPolygon([part for part in shapely.get_parts(shared) if part.geom_type == "Polygon"])
