"""Joining: outlines around two parts and the gap between them, and holes around what is joined to them.

Needs shapely.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...geometry.arrays import FloatArray
from ...geometry.precision import INPUT_ROUND_OFF, NEGLIGIBLE
from ...libraries import load_shapely
from ..merging import ARC
from .parts import Hole, Kind, OpenRegion, Part

NECK = 0.05
"""Half the width of the bridge between two parts, in its lengths."""

CLOSING = 0.75
"""Half the width of the gap that is closed next to the bridge, in its lengths."""

BESIDE = 6.0
"""Distance from the bridge within which the gap is closed, in its lengths."""

WORK = 8_000_000
"""Vertices of outlines that are joined for a drawing, each time that a join is tried: at most a minute."""


class WorkLeft:
    """What may still be spent on the joins of a drawing."""

    def __init__(self) -> None:
        self.left = WORK

    def spend(self, *outlines: FloatArray) -> bool:
        """Count a join of outlines (k, 2); returns whether there was work left for it."""
        self.left -= sum(map(len, outlines))
        return self.left >= 0


class Joins:
    """The joins in a region of each part with the nearest one, or with the outline of the hole."""

    def __init__(self, region: OpenRegion, work: WorkLeft) -> None:
        """Raises NestedCagesError without shapely."""
        self.work = work
        self.shapely = load_shapely("Joining parts")
        self.parts, self.hole, self.siblings = region
        self.solids = {id(part): self.shapely.Polygon(part.ring) for part in self.parts}
        self.open: Any = None if self.hole is None else self.shapely.Polygon(self.hole.ring)
        self.known: dict[tuple[int, int], Kind | None] = {}
        """What is made of two, by their identities; None if nothing is."""
        self.new: list[Any] = []
        """Solids of the parts that were made since that was found."""
        self.tree: Any = None
        """Of the solids of all parts."""

    def candidates(self) -> list[Kind]:
        """What a join would make."""
        solids = np.array([self.solids[id(part)] for part in self.parts])
        pairs: set[tuple[int, int]] = set()
        self.tree = self.shapely.STRtree(solids)
        self._forget_what_changed()
        if len(solids) > 1:
            own, other = self.tree.query_nearest(solids, exclusive=True, all_matches=False)
            pairs = {(min(pair), max(pair)) for pair in zip(own.tolist(), other.tolist(), strict=True)}
        made = [self._known(self.parts[i], self.parts[j]) for i, j in sorted(pairs)]
        if self.hole is not None and len(solids):
            nearest = int(self.shapely.distance(solids, self.open.exterior).argmin())
            made.append(self._known(self.parts[nearest], self.hole))
        return [each for each in made if each is not None]

    def apply(self, made: Kind) -> None:
        """Put what a join makes in the place of what it joins."""
        holes = [hole for part in made.joined for hole in part.holes]  # some may be filled since
        if isinstance(made, Hole):
            assert self.hole is not None
            made.inner[:] = [*self.hole.inner, *holes]
            self.siblings[next(k for k, hole in enumerate(self.siblings) if hole is self.hole)] = made
            return
        made.holes[:] = holes
        for part in made.joined:
            self.parts.remove(part)
        self.parts.append(made)
        self.new.append(self.solids[id(made)])

    def _forget_what_changed(self) -> None:
        """Forget what is made next to parts that are new."""
        if not self.new:
            return
        kept = {key: made for key, made in self.known.items() if isinstance(made, Part)}
        near, _ = self.shapely.STRtree(self.new).query([self.solids[id(made)] for made in kept.values()], "intersects")
        keys, changed = list(kept), set(near.tolist())
        self.known = {key: kept[key] for k, key in enumerate(keys) if k not in changed}
        self.new = []

    def _known(self, part: Part, other: Kind) -> Kind | None:
        key = id(part), id(other)
        if key not in self.known:
            if not self.work.spend(part.ring, other.ring):
                return None
            try:
                with np.errstate(all="ignore"):  # what shapely divides by nothing is no polygon then
                    made = self._joined(part, other) if isinstance(other, Part) else self._opened(part, other)
            except self.shapely.errors.GEOSException:  # coordinates next to the limits
                made = None
            self.known[key] = made
        return self.known[key]

    def _met(self, solid: Any) -> list[Part]:
        """The parts that a polygon meets."""
        return [self.parts[k] for k in np.sort(self.tree.query(solid, predicate="intersects"))]

    def _joined(self, one: Part, other: Part) -> Part | None:
        """Two parts and all that the outline around them meets, as one; None where there is no such outline."""
        shapely, joined = self.shapely, [one, other]
        solid = _with_bridge(shapely, *(self.solids[id(part)] for part in joined))
        while solid.geom_type == "Polygon":
            solid = shapely.Polygon(solid.exterior)
            met = self._met(solid)
            if len(met) == len(joined):
                break
            joined = met
            solid = shapely.union_all([solid, *(self.solids[id(part)] for part in met)])
        if solid.geom_type != "Polygon" or (self.open is not None and not self.open.contains_properly(solid)):
            return None
        part = Part(_outline_of(shapely, solid, 1), [hole for each in joined for hole in each.holes], tuple(joined))
        self.solids[id(part)] = solid
        return part

    def _opened(self, part: Part, hole: Hole) -> Hole | None:
        """A hole with a part joined to its outline, and all that no longer lies in it; None where nothing is left."""
        shapely = self.shapely
        wall = self.open.buffer(self.open.length).difference(self.open)
        left, joined = self.open.difference(_with_bridge(shapely, self.solids[id(part)], wall)), list[Part]()
        while not left.is_empty:
            left = max(getattr(left, "geoms", [left]), key=lambda each: each.area)
            gone = [each for each in self.parts if not left.contains_properly(self.solids[id(each)])]
            if len(gone) == len(joined) or left.geom_type != "Polygon":
                break
            joined = gone
            left = left.difference(shapely.union_all([self.solids[id(each)] for each in gone]))
        if left.geom_type != "Polygon" or left.is_empty or len(left.interiors):
            return None
        kept = [each for each in self.parts if each not in joined]
        inner = [*hole.inner, *(each for some in joined for each in some.holes)]
        return Hole(_outline_of(shapely, left, -1), kept, hole, tuple(joined), inner)


def _outline_of(shapely: Any, solid: Any, sense: int) -> FloatArray:
    """The outline of a polygon (k, 2)."""
    ring: FloatArray = np.array(shapely.geometry.polygon.orient(solid, sense).exterior.coords)[:-1]
    return np.asarray(ring[(ring != np.roll(ring, 1, axis=0)).any(axis=1)])


def _with_bridge(shapely: Any, one: Any, other: Any) -> Any:
    """Two solids with a bridge between their nearest points, and the gap next to it closed."""
    bridge = shapely.shortest_line(one, other)
    left, low, right, high = shapely.total_bounds([one, other])
    diagonal = float(np.hypot(right - left, high - low))
    gap = max(bridge.length, INPUT_ROUND_OFF * diagonal)
    reach = CLOSING * gap
    window = bridge.buffer(BESIDE * gap + 2.0 * reach)
    near = shapely.union_all([shapely.intersection(one, window), shapely.intersection(other, window)])
    closed = near.buffer(reach, quad_segs=ARC).buffer(-reach, quad_segs=ARC)
    filling = closed.difference(near).intersection(bridge.buffer(BESIDE * gap))
    whole = shapely.union_all([one, other, bridge.buffer(NECK * gap), filling])
    # grown, so that outlines that only touch overlap
    grown: Any = whole.buffer(min(NEGLIGIBLE * diagonal, NECK * gap), join_style="mitre")
    return grown.union(whole)
