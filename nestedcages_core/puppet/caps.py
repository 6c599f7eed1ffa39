"""Caps: paint of a part that stays on its parent at their joint, so that nothing opens there when the part turns.

At rest a cap lies under the very paint that it repeats, so that the drawing looks as before.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.vectors import norm
from ..libraries import load_shapely
from .draft import PuppetDraft
from .links import Hold, Link
from .parts import NEEDED_FOR, PuppetPart

TURNS = -90.0, -45.0, 45.0, 90.0
"""Degrees at which a joint is tried."""

OPENS = 0.002
"""A cap is made where a turn opens more than this part of the joint's disc."""

UNDER = 0.02
"""How far a cap reaches under the parent, in radii of the disc, so that no seam shows."""

CAP_SIMPLIFIED = 1e-3
"""Tolerance of outlines of caps, in the same."""

UNSEEN = 1e-6
"""Pieces of paint smaller than this part of the cap are not drawn."""


@dataclass(frozen=True, eq=False)
class Cap:
    """Paint of a part that stays behind: drawn as the part is, directly beneath it, and moved by another bone."""

    part: int
    """The part whose paint it repeats."""
    bone: int
    """The bone of the part's parent that carries the joint."""
    outline: Mesh
    """One loop at rest: what lies in it is drawn."""

    def pieces(self, triangles: FloatArray) -> Iterator[tuple[int, FloatArray, FloatArray]]:
        """What of triangles (t, 3, 2) lies in the cap: a triangle's number, a ring (k, 2) in it, and for each of its
        points the shares (k, 3) of the triangle's corners."""
        shapely = load_shapely(NEEDED_FOR)
        area = shapely.geometry.shape(self.outline.__geo_interface__)
        solids = shapely.polygons(triangles)
        for number in np.flatnonzero(shapely.intersects(solids, area)).tolist():
            for piece in shapely.get_parts(shapely.intersection(solids[number], area)):
                if piece.area > UNSEEN * area.area:
                    ring = shapely.get_coordinates(shapely.normalize(piece).exterior)[-2::-1]
                    first, *others = triangles[number]
                    far = np.linalg.solve((np.array(others) - first).T, (ring - first).T).T
                    yield number, ring, np.column_stack([1.0 - far.sum(axis=1), far])


def caps_of(draft: PuppetDraft) -> tuple[Cap, ...]:
    """The caps of all joints that need them, by part. Raises NestedCagesError where shapely is missing."""
    found = []
    for number, (part, link) in enumerate(zip(draft.parts, draft.links, strict=True)):
        bone = draft.bones[draft.bone_of[number]].parent
        if link.hold is Hold.JOINT and link.parent is not None and bone is not None:
            rings = _rings(part, draft.parts[link.parent], link)
            found += [Cap(number, bone, Mesh.from_loops([ring])) for ring in rings]
    return tuple(found)


def joint_radius(part: PuppetPart, on: PuppetPart, link: Link) -> float:
    """Radius of a joint's disc: to the farthest place where the outlines cross, at most as wide as the thinner part."""
    shapely = load_shapely(NEEDED_FOR)
    crossings = shapely.get_coordinates(shapely.intersection(shapely.boundary(part.solid), shapely.boundary(on.solid)))
    thinner = max(link.radius, min(part.disc[1], on.disc[1]))
    return min(thinner, float(norm(crossings - link.joint).max())) if len(crossings) else thinner


def _rings(part: PuppetPart, on: PuppetPart, link: Link) -> list[FloatArray]:
    """Outlines (k, 2) of a part's paint in the joint's disc outside the parent; none if turns keep it painted."""
    shapely = load_shapely(NEEDED_FOR)
    radius, joint = joint_radius(part, on, link), np.array(link.joint)
    disc = shapely.Point(joint).buffer(radius)
    beside = shapely.difference(shapely.intersection(disc, part.solid), on.solid)
    opened = [shapely.difference(beside, _turned(part.solid, joint, angle)).area for angle in TURNS]
    if max(opened) <= OPENS * disc.area:
        return []
    grown = shapely.intersection(shapely.intersection(beside.buffer(UNDER * radius), disc), part.solid)
    pieces = [each for each in shapely.get_parts(grown) if each.geom_type == "Polygon"]
    kept = [shapely.simplify(each, CAP_SIMPLIFIED * radius) for each in pieces if each.area > OPENS * disc.area]
    return [shapely.get_coordinates(each.exterior)[:-1] for each in kept]


def _turned(solid: Any, joint: FloatArray, degrees: float) -> Any:
    """A solid turned around a joint."""
    turn = np.exp(1j * np.deg2rad(degrees))
    matrix = np.array([[turn.real, turn.imag], [-turn.imag, turn.real]])
    return load_shapely(NEEDED_FOR).transform(solid, lambda points: (points - joint) @ matrix + joint)
