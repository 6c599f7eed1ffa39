"""The parts of a layered drawing, and what can be measured of one part alone."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..errors import invalid_setting
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..libraries import load_shapely
from .naming import Names

NEEDED_FOR = "A puppet of parts that overlap"

DISC_TOLERANCE = 0.01
"""Of the largest disc in an area, in square roots of that area."""

STUBBY = 1.4
"""Slenderness below which a part has no ends."""

ROUND_HULL = 0.93
"""A part is round if its hull is this much of the circle around it."""

AT_END = 0.12
"""An overlap this near an end of the part, in lengths of the part, is a joint there."""


@dataclass(frozen=True, eq=False)
class PuppetPart:
    """A painted solid of a drawing: what moves as one, or bends as one."""

    name: str
    """Name in the drawing, for bones; `draft_puppet` makes names unique."""
    outline: Mesh
    """All that the part paints, strokes included; y pointing up."""
    groups: tuple[str, ...] = ()
    """Names of the groups or layers around it, the outermost first."""

    @cached_property
    def solid(self) -> Any:
        """The outline as a polygon of shapely."""
        return load_shapely(NEEDED_FOR).geometry.shape(self.outline.__geo_interface__)

    @cached_property
    def filled(self) -> Any:
        """The polygon without its holes."""
        shapely = load_shapely(NEEDED_FOR)
        return shapely.union_all([shapely.Polygon(each.exterior) for each in shapely.get_parts(self.solid)])

    @property
    def is_round(self) -> bool:
        """Whether it is a disc, a ring or a star."""
        circle = float(load_shapely(NEEDED_FOR).minimum_bounding_radius(self.solid))
        return bool(self.solid.convex_hull.area > ROUND_HULL * np.pi * circle**2)

    @cached_property
    def disc(self) -> tuple[FloatArray, float]:
        """Centre (2,) and radius of the largest disc in the part."""
        return largest_disc(self.solid)

    @cached_property
    def box(self) -> FloatArray:
        """(4, 2) corners of the smallest rectangle around the part, the first side not shorter than the second."""
        shapely = load_shapely(NEEDED_FOR)
        corners = shapely.get_coordinates(shapely.oriented_envelope(self.solid))[:4]
        sides = np.hypot(*(corners[1] - corners[0])), np.hypot(*(corners[2] - corners[1]))
        return corners if sides[0] >= sides[1] else np.roll(corners, -1, axis=0)

    @property
    def ends(self) -> FloatArray:
        """(2, 2) middles of the shorter sides of that rectangle."""
        return np.asarray(0.5 * (self.box[:2] + self.box[[3, 2]]))

    @property
    def slenderness(self) -> float:
        """Length over width of that rectangle."""
        return float(np.hypot(*(self.box[1] - self.box[0])) / np.hypot(*(self.box[2] - self.box[1])))

    def distance(self, place: tuple[float, float]) -> float:
        """Distance of a place from the part, 0 on it."""
        return float(self.solid.distance(load_shapely(NEEDED_FOR).Point(place)))

    def along(self, points: FloatArray, *, across: bool = False) -> FloatArray:
        """(P,) places of points (P, 2) along the part's longer direction or across it, 0 and 1 at its ends."""
        axis = self.box[3 if across else 1] - self.box[0]
        return np.asarray((points - self.box[0]) @ axis / (axis @ axis))


def largest_disc(area: Any) -> tuple[FloatArray, float]:
    """Centre (2,) and radius of the largest disc in the largest polygon of an area; radius 0 where it is empty."""
    shapely = load_shapely(NEEDED_FOR)
    polygons = [part for part in shapely.get_parts(area) if part.geom_type == "Polygon" and part.area > 0.0]
    if not polygons:
        return np.asarray(shapely.get_coordinates(shapely.centroid(area)).reshape(-1, 2)).mean(axis=0), 0.0
    biggest = max(polygons, key=lambda part: float(part.area))
    line = shapely.maximum_inscribed_circle(biggest, tolerance=DISC_TOLERANCE * np.sqrt(biggest.area))
    return np.array(line.coords[0]), float(line.length)


def with_unique_names(parts: Iterable[PuppetPart]) -> tuple[PuppetPart, ...]:
    """The parts with a number after names that repeat. Raises NestedCagesError if there are none."""
    names = Names()
    found = tuple(replace(part, name=names.new(part.name or "part")) for part in parts)
    if not found:
        raise invalid_setting("There are no parts; give at least one.")
    return found
