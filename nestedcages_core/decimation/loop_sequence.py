"""The sequence of outlines: meshes that contain a drawing, from all of its loops to one.

A cage around any of them is a cage around the drawing, so the tightest one that is certified is the answer. Each step
fills the hole, or joins the two parts, that adds the least area for each loop that it saves.
"""

from __future__ import annotations

from functools import cached_property
from heapq import heapify, heappop, heappush
from typing import Any, NamedTuple

import numpy as np

from ..geometry.convex_hull import convex_hull
from ..geometry.mesh import Mesh
from ..geometry.solids import mesh_of
from ..libraries import has_shapely, load_shapely


class Step(NamedTuple):
    """One step of the sequence: a hole is filled, or two parts are joined."""

    saved: int
    """Loops that it saves."""
    hole: int | None
    """The loop of the hole that it fills, with all that lies in it."""
    bridge: tuple[int, int, Any] | None
    """The components that it joins, and the polygon that does."""


class LoopSequence:
    """The outlines around a mesh, finest first: the mesh itself, then one step more each time; last, the convex hull.

    Joins need shapely; without it there are holes to fill alone.
    """

    def __init__(self, fine: Mesh) -> None:
        self.fine = fine
        self._meshes: dict[int, Mesh] = {0: fine}

    def __len__(self) -> int:
        return len(self.loops)

    @cached_property
    def loops(self) -> list[int]:
        """(len,) number of loops of each outline."""
        saved = np.cumsum([0, *(step.saved for step in self.steps)])
        hull = [1] if len(self.fine.loops) > 1 else []
        return [len(self.fine.loops) - int(number) for number in saved] + hull

    def mesh(self, k: int) -> Mesh:
        """The outline after k steps. Raises InvalidMeshError."""
        if k not in self._meshes:
            self._meshes[k] = self._after(self.steps[:k]) if k <= len(self.steps) else self.hull
        return self._meshes[k]

    @cached_property
    def hull(self) -> Mesh:
        """The convex hull."""
        points = self.fine.vertices
        return Mesh.from_loops([points[convex_hull(points)]])

    @cached_property
    def steps(self) -> list[Step]:
        """All steps, the cheapest first."""
        fine = self.fine
        holes = np.flatnonzero(fine.loop_signs < 0).tolist()
        outer = np.flatnonzero(fine.loop_signs > 0).tolist()
        inside = {hole: [k for k in outer if fine.parent_of_loop[k] == hole] for hole in holes}
        empty = {hole: -float(fine.loop_areas[[hole, *inside[hole]]].sum()) for hole in holes}
        component = fine.component_of_loop
        waiting: list[tuple[float, int, Any]] = []
        if len(outer) > 1:
            waiting = [(cost, n, (i, j, patch)) for n, (i, j, patch, cost) in enumerate(self._bridges(outer))]
        waiting += [(empty[hole] / (1 + len(inside[hole])), len(waiting) + n, hole) for n, hole in enumerate(holes)]
        heapify(waiting)
        leader, steps = list(range(len(outer))), list[Step]()

        def group(part: int) -> int:
            while leader[part] != part:
                part = leader[part]
            return part

        while waiting:
            cost, number, what = heappop(waiting)
            if isinstance(what, int):
                own = group(int(component[what]))
                apart = {group(int(component[k])) for k in inside[what]} - {own}
                now = empty[what] / (1 + len(apart))
                if now > cost:  # some of what lies in it was joined
                    heappush(waiting, (now, number, what))
                    continue
                steps.append(Step(1 + len(apart), what, None))
                for each in apart:
                    leader[each] = own
            elif group(what[0]) != group(what[1]):
                leader[group(what[0])] = group(what[1])
                steps.append(Step(1, None, what))
        return steps

    @cached_property
    def _polygons(self) -> list[Any]:
        """A polygon of shapely for each component."""
        shape, fine = load_shapely("Joining parts"), self.fine
        rings: list[list[Any]] = [[] for _ in range(int(fine.component_of_loop.max()) + 1)]
        for k in np.argsort(-fine.loop_signs, kind="stable").tolist():
            rings[int(fine.component_of_loop[k])].append(fine.vertices[fine.loops[k]])
        return [shape.Polygon(first, others) for first, *others in rings]

    def _bridges(self, outer: list[int]) -> list[tuple[int, int, Any, float]]:
        from .bridging import bridges  # with more of scipy

        return list(bridges(load_shapely("Joining parts"), self._polygons)) if has_shapely() else []

    def _after(self, steps: list[Step]) -> Mesh:
        fine = self.fine
        gone = {step.hole for step in steps if step.hole is not None}
        filled = list(gone)
        while filled:  # what lies in a filled hole is gone, and the holes of that
            loop = filled.pop()
            below = fine.parent_of_loop == loop
            if fine.loop_signs[loop] > 0:
                below = (fine.component_of_loop == fine.component_of_loop[loop]) & (fine.loop_signs < 0)
            new = set(np.flatnonzero(below).tolist()) - gone
            gone |= new
            filled += new
        left = [k for k in range(len(fine.loops)) if k not in gone]
        outer = {int(fine.component_of_loop[k]) for k in left if fine.loop_signs[k] > 0}
        joins = [step.bridge[2] for step in steps if step.bridge is not None and outer >= set(step.bridge[:2])]
        mesh = Mesh.from_loops([fine.vertices[fine.loops[k]] for k in left])
        return mesh if not joins else self._joined(mesh, joins)

    def _joined(self, mesh: Mesh, patches: list[Any]) -> Mesh:
        """A mesh with patches, and the gaps that these close filled."""
        shapely = load_shapely("Joining parts")
        solid = shapely.geometry.shape(mesh.__geo_interface__)
        parts = list(getattr(solid, "geoms", [solid]))
        places = []
        for ring in (ring for part in parts for ring in part.interiors):
            places.append(shapely.difference(shapely.Polygon(ring), solid).representative_point())
        holes, solid = shapely.STRtree(places), shapely.union_all([*parts, *patches])
        parts = []
        for part in getattr(solid, "geoms", [solid]):
            rings = [ring for ring in part.interiors if len(holes.query(shapely.Polygon(ring), predicate="contains"))]
            parts.append(shapely.Polygon(part.exterior, rings))
        solid = shapely.union_all(parts)  # parts that lay in gaps are gone
        return mesh_of(solid)
