"""Convex cages: around each part the tightest cage of its convex hull, which is convex since it is the tightest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TypeVar

import numpy as np

from ...decimation import LineCycles, OuterHull
from ...decimation.budget import LEAST_PER_LOOP
from ...energies import Area, CageEnergy
from ...errors import Fault, NestingError, note
from ...geometry.arrays import FloatArray
from ...geometry.convex_hull import convex_hull
from ...geometry.group import Symmetry
from ...geometry.mesh import Mesh
from ...geometry.precision import NEGLIGIBLE
from ...geometry.predicates import BoxTree, crossing_pairs, orientation, winding_number
from ...geometry.vectors import cross, norm
from ...level.plan import Need, Plan
from ...level.settings import LevelSettings
from ...level.symmetrised_start import orbits_of
from ...level.units import SolverUnits

Chosen = TypeVar("Chosen", bound=LevelSettings)


@dataclass(frozen=True)
class Convex(Need):
    """Convex cages, one around each part; holes are filled."""

    def fill(self, plan: Plan) -> Plan:
        """The hulls of the parts, each with the number of vertices asked for, to be enclosed instead of the fine mesh.

        Raises NestingError for cages inside, whose complement is not convex, and where hulls overlap.
        """
        if plan.side < 0:
            raise NestingError(
                "Convex cages lie around a shape, not inside of it; leave out convex, or use nested_cages.",
                code="convex.impossible",
            )
        outline = plan.outline
        parts = [k for k in range(len(outline.loops)) if outline.parent_of_loop[k] < 0]
        hulls = _hulls(outline, parts)
        for one, other in combinations(range(len(parts)), 2):
            if _overlap(hulls[one], hulls[other]):
                names = parts[one], parts[other]
                raise NestingError(
                    "There is no convex cage around this shape: those of loop {} and loop {} would overlap, since one "
                    "reaches into the other; unite them or leave out convex.".format(*names),
                    code="convex.overlapping",
                    loops=names,
                )
        alike = Mesh.from_loops(_hulls(outline, parts, plan.group))
        if outline is not plan.fine:  # accurate to round-off
            loops = [plan.fine.vertices[loop] for loop in plan.fine.loops]
            part = [int(np.argmin([_outside(hull, loop[0]) for hull in hulls])) for loop in loops]
            for k in set(part):  # others are images alone
                points = np.concatenate([loop for loop, of in zip(loops, part, strict=True) if of == k])
                hulls[k] = points[convex_hull(points)]
        return replace(plan, fine=Mesh.from_loops(hulls), outline=alike, inner=plan.fine, per_loop=True)

    def count(self, plan: Plan, count: int) -> tuple[int, tuple[Fault, ...]]:
        """The number of vertices, reduced to that of the outline, a hull; and a note if so."""
        hull = plan.outline
        along = hull.edge_ends - hull.vertices
        before = along[hull.predecessor]
        turn = np.arctan2(cross(before, along), (before * along).sum(axis=1))
        most = max(LEAST_PER_LOOP, int((turn > NEGLIGIBLE).sum()))
        return (count, ()) if count <= most else (most, (note("note.count", on="hull", asked=count, given=most),))

    def energy(
        self, plan: Plan, energy: CageEnergy, coarse: Mesh, units: SolverUnits, clearance: float
    ) -> CageEnergy | None:
        """The weighted area as line cycles weigh it, if there are weights.

        One weight per edge leads away from it: edges from where weights are high to where they are low cost too much.
        """
        weight_at = getattr(energy, "weight_at", None)
        if weight_at is None:
            return None
        from ...energies.corner_area import CornerArea

        return CornerArea.of(coarse, units.from_input(plan.outline), weight_at, energy.after(coarse.vertices))

    def fault(self, plan: Plan, cage: Mesh) -> Fault | None:
        """Whether all loops are convex."""
        return None if is_convex(cage) else Fault("The cage is not convex.", "convex.missed")

    def mended(self, plan: Plan, cage: Mesh) -> tuple[Mesh, Fault] | None:
        """The convex hull of a cage with dents or straight angles; None for one that is inside out or flat."""
        hulls = [] if is_convex(cage) else _hulls(cage, range(len(cage.loops)), plan.group)
        if not hulls or min(map(len, hulls)) < LEAST_PER_LOOP or sum(map(len, hulls)) == len(cage.vertices):
            return None
        hull = Mesh.from_loops(hulls)
        orbits = None if plan.group is None else orbits_of(hull, plan.group)
        hull = hull if orbits is None else hull.moved(orbits.symmetrised(hull.vertices))
        on = "hull" if plan.numbers is None else "grid"
        return hull, note("note.count", asked=len(cage.vertices), given=len(hull.vertices), on=on)


def around_hulls(settings: Chosen) -> Chosen:
    """The settings with methods that make convex cages around hulls: from lines outside, and of least area."""
    decimation = getattr(settings.decimation, "outside", LineCycles(on_curve=False))
    return replace(settings, decimation=decimation, fallback=OuterHull(), energy=Area())


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
