"""Caps: paint of a part that stays on its parent at their joint, so that nothing opens there when the part turns.

At rest a cap lies under the very paint that it repeats, so that the drawing looks as before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.vectors import norm
from ..libraries import load_shapely
from .draft.draft import PuppetDraft
from .draft.links import Hold, Link
from .part import NEEDED_FOR, PuppetPart

TURNS = -90.0, -45.0, 45.0, 90.0
"""Degrees at which a joint is tried."""

OPENS = 0.015
"""Turns open at most this part of what is painted in the joint's disc; smaller pieces are no caps."""

UNDER = 0.02
"""How far a cap reaches under the parent, in radii of the disc, so that no seam shows."""

CAP_SIMPLIFIED = 1e-3
"""Tolerance of outlines of caps, in the same."""

UNSEEN = 1e-6
"""Pieces of paint smaller than this part of the cap are not drawn."""

INK_SAMPLES = 40
"""Places on a part's outline near a cap where its ink is looked for."""

INK_DEPTHS = np.geomspace(0.01, 0.5, 40)
"""Depths of these looks, in radii of the disc: ink is narrower than the last."""

INKED = 0.6
"""Part of the places that have the same ink, at least, if an outline is inked."""


class Ink(NamedTuple):
    """A line around a part, painted differently from what it encloses, continued along the edge of a cap."""

    paint: int
    """Number of its paint."""
    area: Any
    """What it covers, as an area of shapely."""

    @property
    def rings(self) -> list[FloatArray]:
        """Outlines (k, 2) of its polygons; those with holes are cut in two."""
        shapely = load_shapely(NEEDED_FOR)
        left, low, right, high = self.area.bounds
        middle = 0.5 * (left + right)
        halves = [shapely.box(left, low, middle, high), shapely.box(middle, low, right, high)]
        whole = not any(shapely.get_num_interior_rings(shapely.get_parts(self.area)))
        pieces = shapely.get_parts(self.area if whole else shapely.intersection(self.area, halves))
        return [shapely.get_coordinates(each.exterior)[-2::-1] for each in pieces if each.geom_type == "Polygon"]


@dataclass(frozen=True, eq=False)
class Cap:
    """Paint of a part that stays behind: drawn as the part is, directly beneath it, and moved by another bone."""

    part: int
    """The part whose paint it repeats."""
    bone: int
    """The bone of the part's parent that carries the joint."""
    outline: Mesh
    """One loop at rest: what lies in it is drawn."""
    edge: Any
    """Lines of shapely: where the paint was cut."""
    radius: float
    """That of the joint's disc."""

    @cached_property
    def solid(self) -> Any:
        """The outline as a polygon of shapely."""
        return load_shapely(NEEDED_FOR).geometry.shape(self.outline.__geo_interface__)

    def ink(self, part: PuppetPart, paints: Callable[[FloatArray], IntArray]) -> Ink | None:
        """The ink of the part's outline, continued along the edge of the cap; None if the part has none nearby.

        paints: numbers (n,) of the paints of the part at places (n, 2), negative where there is none.
        """
        shapely = load_shapely(NEEDED_FOR)
        at = part.outline.vertices[part.outline.edges]
        along = at[:, 1] - at[:, 0]
        ends = np.cumsum(norm(along) * shapely.dwithin(self.solid, shapely.points(at.mean(axis=1)), self.radius))
        if ends[-1] == 0.0:
            return None
        passed = ends[-1] * (np.arange(INK_SAMPLES) + 0.5) / INK_SAMPLES
        edges = np.searchsorted(ends, passed)
        direction = along[edges] / norm(along[edges])[:, None]
        start = at[edges, 1] - (ends[edges] - passed)[:, None] * direction
        inward = np.column_stack([-direction[:, 1], direction[:, 0]])
        depths = self.radius * INK_DEPTHS
        found = paints((start + depths[:, None, None] * inward).reshape(-1, 2)).reshape(len(depths), -1)
        first = found[(found >= 0).argmax(axis=0), np.arange(INK_SAMPLES)]
        paint, times = max(zip(*np.unique(first, return_counts=True), strict=True), key=lambda each: each[1])
        ends_at = ((found != paint) & (np.cumsum(found == paint, axis=0) > 0)).argmax(axis=0)[first == paint]
        deep = int(np.median(ends_at))
        if paint < 0 or times < INKED * INK_SAMPLES or deep == 0:
            return None
        band = shapely.intersection(shapely.buffer(self.edge, depths[deep]), self.solid)
        return None if band.area == 0.0 else Ink(int(paint), band)

    def pieces(self, triangles: FloatArray) -> Iterator[tuple[int, FloatArray, FloatArray]]:
        """What of triangles (t, 3, 2) lies in the cap: a triangle's number, a ring (k, 2) in it, and for each of its
        points the shares (k, 3) of the triangle's corners."""
        shapely = load_shapely(NEEDED_FOR)
        solids = shapely.polygons(triangles)
        for number in np.flatnonzero(shapely.intersects(solids, self.solid)).tolist():
            for piece in shapely.get_parts(shapely.intersection(solids[number], self.solid)):
                if piece.area > UNSEEN * self.solid.area:
                    ring = shapely.get_coordinates(shapely.normalize(piece).exterior)[-2::-1]
                    first, *others = triangles[number]
                    far = np.linalg.solve((np.array(others) - first).T, (ring - first).T).T
                    yield number, ring, np.column_stack([1.0 - far.sum(axis=1), far])


def caps_of(draft: PuppetDraft) -> tuple[Cap, ...]:
    """The caps of all joints that need them, by part. Raises NestedCagesError where shapely is missing."""
    found = list[Cap]()
    for number, (part, link) in enumerate(zip(draft.parts, draft.links, strict=True)):
        bone = draft.bones[draft.bone_of[number]].parent
        if link.hold is Hold.JOINT and link.parent is not None and bone is not None:
            found += list(_caps_at(number, part, draft.parts[link.parent], link, bone))
    return tuple(found)


def joint_radius(part: PuppetPart, on: PuppetPart, link: Link) -> float:
    """Radius of a joint's disc: to the farthest place where the outlines cross, at most as wide as the thinner part."""
    shapely = load_shapely(NEEDED_FOR)
    crossings = shapely.get_coordinates(shapely.intersection(shapely.boundary(part.solid), shapely.boundary(on.solid)))
    thinner = max(link.radius, min(part.disc[1], on.disc[1]))
    return min(thinner, float(norm(crossings - link.joint).max())) if len(crossings) else thinner


def _caps_at(number: int, part: PuppetPart, on: PuppetPart, link: Link, bone: int) -> Iterator[Cap]:
    """The part's paint in the joint's disc outside the parent, as far as turns open it."""
    shapely = load_shapely(NEEDED_FOR)
    radius, joint = joint_radius(part, on, link), np.array(link.joint)
    disc = shapely.Point(joint).buffer(radius)
    beside = shapely.difference(shapely.intersection(disc, part.solid), on.solid)
    turned = [_turned(part.solid, joint, angle) for angle in TURNS]
    grown = shapely.intersection(shapely.intersection(beside.buffer(UNDER * radius), disc), part.solid)
    pieces = [each for each in shapely.get_parts(grown) if each.geom_type == "Polygon"]
    opened = [shapely.area(shapely.difference(shapely.intersection(beside, each), turned)).max() for each in pieces]
    left = OPENS * shapely.intersection(disc, shapely.union(part.solid, on.solid)).area
    for area, piece in sorted(zip(opened, pieces, strict=True), key=lambda each: each[0]):
        left -= area
        if left < 0.0:
            ring = shapely.get_coordinates(shapely.simplify(piece, CAP_SIMPLIFIED * radius).exterior)[:-1]
            edge = shapely.intersection(shapely.boundary(disc), piece.buffer(UNDER * radius))
            yield Cap(number, bone, Mesh.from_loops([ring]), edge, radius)


def _turned(solid: Any, joint: FloatArray, degrees: float) -> Any:
    """A solid turned around a joint."""
    turn = np.exp(1j * np.deg2rad(degrees))
    matrix = np.array([[turn.real, turn.imag], [-turn.imag, turn.real]])
    return load_shapely(NEEDED_FOR).transform(solid, lambda points: (points - joint) @ matrix + joint)
