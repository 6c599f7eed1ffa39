"""Places of markers: the vertices of a path and the directions there (SVG 1.1, section 11.6)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import FloatArray
from .path_data import Subpath

MARKED = frozenset(("path", "line", "polyline", "polygon"))
"""Elements that have markers."""

PLACES = ("start", "mid", "end")
"""Where a vertex can be on its path."""


@dataclass(frozen=True, eq=False)
class Vertex:
    """A vertex of a path."""

    place: str
    """One of `PLACES`."""
    point: FloatArray
    direction: FloatArray
    """(2,) halfway between the incoming and the outgoing direction."""

    def angle(self, orient: str) -> float:
        """Degrees by which a marker is turned here."""
        back = 180.0 if orient == "auto-start-reverse" and self.place == "start" else 0.0
        return math.degrees(math.atan2(self.direction[1], self.direction[0])) + back


def vertices(subpaths: Sequence[Subpath]) -> list[Vertex]:
    """All vertices of a path in their order."""
    found: list[tuple[FloatArray, FloatArray]] = []
    for path in subpaths:
        curves = path.curves
        ways = [_ways(curve) for curve in curves]
        around = path.closed
        for k, curve in enumerate(curves):
            way_in = ways[k - 1][1] if k or around else np.zeros(2)
            found.append((curve[0], way_in + ways[k][0]))
        way_out = ways[0][0] if around else np.zeros(2)
        found.append((path.points[-1], ways[-1][1] + way_out))
    places = ["start", *["mid"] * (len(found) - 2), "end"]
    return [Vertex(place, point, way) for place, (point, way) in zip(places, found, strict=True)]


def _ways(curve: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Unit directions at the ends of a curve; 0 if it is a point."""
    from_start = next((p - curve[0] for p in curve[1:] if (p != curve[0]).any()), np.zeros(2))
    to_end = next((curve[-1] - p for p in curve[-2::-1] if (p != curve[-1]).any()), np.zeros(2))
    return tuple(way / (np.hypot(*way) or 1.0) for way in (from_start, to_end))  # type: ignore[return-value]
