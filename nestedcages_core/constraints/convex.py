"""Convex cages: around each part the tightest cage of its convex hull, which is convex since it is the tightest.

Parts whose hulls leave no room for two cages get one, around their common hull.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..decimation.base import MIN_PER_LOOP, LevelTarget
from ..errors import Fault, NestingError, note
from ..geometry.arrays import FloatArray
from ..geometry.broad_phase import BoxTree
from ..geometry.convex_hull import convex_hull
from ..geometry.distance import point_edge
from ..geometry.group import Symmetry, orbits_of
from ..geometry.mesh import Mesh
from ..geometry.precision import NEGLIGIBLE
from ..geometry.predicates import crossing_pairs, orientation, winding_number
from ..geometry.vectors import cross, dot, norm
from .base import Constraint


@dataclass(frozen=True)
class Convex(Constraint):
    """Convex cages, one around each part, or around parts next to each other; holes are filled."""

    on = "hull"
    is_rule = False
    kept: Symmetry | None = None
    """Symmetry that hulls have, too."""
    room: float = 0.0
    """Distance between hulls that leaves room for two cages."""
    joins: bool = True
    """Whether parts without that room are joined."""

    def outline(self, outline: LevelTarget, side: int) -> LevelTarget:
        """The hulls of the parts, each with the number of vertices asked for, to be enclosed instead of the fine mesh.

        Raises NestingError for cages inside, whose complement is not convex, and where parts must not be joined.
        """
        if side < 0:
            raise NestingError(
                "Convex cages lie around a shape, not inside of it; leave out convex, or use nested_cages.",
                code="convex.impossible",
            )
        mesh, fine = outline.mesh, outline.fine
        parts = [[k] for k in range(len(mesh.loops)) if mesh.parent_of_loop[k] < 0]
        waiting, groups, hulls = (
            list(zip(parts, _hulls(mesh, parts), strict=True)),
            list[list[int]](),
            list[FloatArray](),
        )
        while waiting:
            group, hull = waiting.pop()
            met = next((k for k, other in enumerate(hulls) if self._meet(hull, other)), None)
            if met is None:
                groups.append(group)
                hulls.append(hull)
                continue
            close, _ = groups.pop(met), hulls.pop(met)
            if not self.joins:
                raise NestingError(
                    f"There are no convex cages around each part: those of loop {group[0]} and loop {close[0]} would "
                    "overlap; unite these parts, allow fewer loops, or leave out convex.",
                    code="convex.overlapping",
                    loops=(group[0], close[0]),
                )
            joined = close + group
            waiting.append((joined, _hulls(mesh, [joined])[0]))
        alike = Mesh.from_loops(_hulls(mesh, groups, self.kept))
        if mesh is not fine:  # accurate to round-off
            loops = [fine.vertices[loop] for loop in fine.loops]
            part = [int(np.argmin([_outside(hull, loop[0]) for hull in hulls])) for loop in loops]
            for k in set(part):  # others are images alone
                points = np.concatenate([loop for loop, of in zip(loops, part, strict=True) if of == k])
                hulls[k] = points[convex_hull(points)]
        return LevelTarget(alike, Mesh.from_loops(hulls), fine, True, outline.notes)

    def _meet(self, one: FloatArray, other: FloatArray) -> bool:
        """Whether two hulls leave no room for two cages."""
        gaps = one.min(axis=0) - other.max(axis=0), other.min(axis=0) - one.max(axis=0)
        if max(gap.max() for gap in gaps) > 2.0 * self.room:
            return False  # as their boxes show
        near = min(_distances(one, other).min(), _distances(other, one).min())
        return bool(near < self.room) or _overlap(one, other)

    def count(self, outline: Mesh, count: int) -> int:
        """At most the number of corners of a hull."""
        along = outline.edge_ends - outline.vertices
        before = along[outline.predecessor]
        corners = int((np.arctan2(cross(before, along), dot(before, along)) > NEGLIGIBLE).sum())
        return min(count, max(MIN_PER_LOOP, corners))

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        """Whether all loops are convex."""
        return None if is_convex(cage) else Fault("The cage is not convex.", "convex.missed")

    def mended(self, cage: Mesh) -> tuple[Mesh, Fault] | None:
        """The convex hull of a cage with dents or straight angles; None for one that is inside out or flat."""
        hulls = [] if is_convex(cage) else _hulls(cage, [[k] for k in range(len(cage.loops))], self.kept)
        if not hulls or min(map(len, hulls)) < MIN_PER_LOOP or sum(map(len, hulls)) == len(cage.vertices):
            return None
        hull = Mesh.from_loops(hulls)
        orbits = None if self.kept is None else orbits_of(hull, self.kept)
        hull = hull if orbits is None else hull.moved(orbits.symmetrised(hull.vertices))
        return hull, note("note.count", asked=len(cage.vertices), given=len(hull.vertices), on=self.on)


def is_convex(mesh: Mesh) -> bool:
    """Whether all loops are convex polygons without straight angles, by exact predicates."""
    before, after = mesh.vertices[mesh.predecessor], mesh.edge_ends
    return bool((mesh.loop_signs > 0).all() and (orientation(before, mesh.vertices, after) > 0).all())


def _hulls(mesh: Mesh, groups: Sequence[Sequence[int]], group: Symmetry | None = None) -> list[FloatArray]:
    """The corners (h, 2) of the hulls of groups of loops; of a symmetric mesh, those whose images are corners too."""
    every = [np.concatenate([mesh.loops[k] for k in loops]) for loops in groups]
    corners = [vertices[convex_hull(mesh.vertices[vertices])] for vertices in every]
    orbits = None if group is None else orbits_of(mesh, group)
    if orbits is not None:
        missed = np.ones(len(mesh.vertices), bool)
        missed[np.concatenate(corners)] = False
        alike = (np.bincount(orbits.orbit, missed) == 0)[orbits.orbit]
        corners = [vertices[alike[vertices]] for vertices in corners]
    return [mesh.vertices[vertices] for vertices in corners]


def _distances(points: FloatArray, ring: FloatArray) -> FloatArray:
    """(K, h) distances of points (K, 2) from the edges of a ring (h, 2)."""
    return point_edge(points[:, None], ring, np.roll(ring, -1, axis=0)).distance


def _overlap(one: FloatArray, other: FloatArray) -> bool:
    """Whether two convex polygons (h, 2) have a point in common."""
    here, there = (BoxTree(ring, np.roll(ring, -1, axis=0)) for ring in (one, other))
    return bool(
        len(crossing_pairs(here, there)[0])
        or winding_number(one[:1], other, np.roll(other, -1, axis=0))[0]
        or winding_number(other[:1], one, np.roll(one, -1, axis=0))[0]
    )


def _outside(hull: FloatArray, point: FloatArray) -> float:
    """How far a point (2,) is from a convex polygon (h, 2), along the normal of an edge; negative inside."""
    along = np.roll(hull, -1, axis=0) - hull
    return float((cross(point - hull, along) / norm(along)).max())
