"""Convex cages: around each part the tightest cage of its convex hull, which is convex since it is the tightest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ..decimation.base import MIN_PER_LOOP, LevelTarget
from ..errors import Fault, NestingError, note
from ..geometry.arrays import FloatArray
from ..geometry.broad_phase import BoxTree
from ..geometry.convex_hull import convex_hull
from ..geometry.group import Symmetry, orbits_of
from ..geometry.mesh import Mesh
from ..geometry.precision import NEGLIGIBLE
from ..geometry.predicates import crossing_pairs, orientation, winding_number
from ..geometry.vectors import cross, dot, norm
from .base import Constraint


@dataclass(frozen=True)
class Convex(Constraint):
    """Convex cages, one around each part; holes are filled."""

    on = "hull"
    is_rule = False
    kept: Symmetry | None = None
    """Symmetry that hulls have, too."""

    def outline(self, outline: LevelTarget, side: int) -> LevelTarget:
        """The hulls of the parts, each with the number of vertices asked for, to be enclosed instead of the fine mesh.

        Raises NestingError for cages inside, whose complement is not convex, and where hulls overlap.
        """
        if side < 0:
            raise NestingError(
                "Convex cages lie around a shape, not inside of it; leave out convex, or use nested_cages.",
                code="convex.impossible",
            )
        mesh, fine = outline.mesh, outline.fine
        parts = [k for k in range(len(mesh.loops)) if mesh.parent_of_loop[k] < 0]
        hulls = _hulls(mesh, parts)
        for one, other in combinations(range(len(parts)), 2):
            if _overlap(hulls[one], hulls[other]):
                names = parts[one], parts[other]
                raise NestingError(
                    "There is no convex cage around this shape: those of loop {} and loop {} would overlap, since one "
                    "reaches into the other; unite them or leave out convex.".format(*names),
                    code="convex.overlapping",
                    loops=names,
                )
        alike = Mesh.from_loops(_hulls(mesh, parts, self.kept))
        if mesh is not fine:  # accurate to round-off
            loops = [fine.vertices[loop] for loop in fine.loops]
            part = [int(np.argmin([_outside(hull, loop[0]) for hull in hulls])) for loop in loops]
            for k in set(part):  # others are images alone
                points = np.concatenate([loop for loop, of in zip(loops, part, strict=True) if of == k])
                hulls[k] = points[convex_hull(points)]
        return LevelTarget(alike, Mesh.from_loops(hulls), fine, True, outline.notes)

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
        hulls = [] if is_convex(cage) else _hulls(cage, range(len(cage.loops)), self.kept)
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


def _hulls(mesh: Mesh, loops: Sequence[int], group: Symmetry | None = None) -> list[FloatArray]:
    """The corners (h, 2) of the hulls of some outer loops; of a symmetric mesh, those whose images are corners too."""
    kept = np.zeros(len(mesh.vertices), bool)
    for loop in mesh.loops:
        kept[loop[convex_hull(mesh.vertices[loop])]] = True
    orbits = None if group is None else orbits_of(mesh, group)
    if orbits is not None:
        kept &= (np.bincount(orbits.orbit, ~kept) == 0)[orbits.orbit]
    return [mesh.vertices[mesh.loops[k]][kept[mesh.loops[k]]] for k in loops]


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
