"""The sequence of outlines: meshes that contain a drawing, from the drawing itself to its hull.

A cage around any of them is a cage around the drawing, so the tightest one that is certified is the answer. At each
step the two closest parts are joined. Each outline may have holes less, too.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import Any

import numpy as np

from ..geometry.convex_hull import convex_hull
from ..geometry.mesh import Mesh
from ..libraries import has_shapely, load_shapely

MAX_PARTS = 1000
"""Parts up to which some are joined; more have their convex hull, since joins would take minutes."""


class LoopSequence:
    """The outlines around a mesh, by the number of joins; last, the convex hull.

    Joins need shapely; without it, or for very many parts, there are the mesh and its hull.
    """

    def __init__(self, fine: Mesh) -> None:
        self.fine = fine
        self._meshes: dict[int, Mesh] = {0: fine}

    def __len__(self) -> int:
        return 1 + len(self.joins) + (len(self.fine.loops) > 1)

    def parts(self, k: int) -> int:
        """The number of parts of an outline."""
        return int((self.fine.loop_signs > 0).sum()) - k if k <= len(self.joins) else 1

    def mesh(self, k: int) -> Mesh:
        """The outline after k joins. Raises InvalidMeshError."""
        if k not in self._meshes:
            self._meshes[k] = self._joined(self.joins[:k]) if k <= len(self.joins) else self.hull
        return self._meshes[k]

    def without_holes(self, k: int) -> Mesh:
        """An outline with all its holes filled."""
        mesh = self.mesh(k)
        outer = np.flatnonzero((mesh.loop_signs > 0) & (mesh.parent_of_loop < 0)).tolist()
        return Mesh.from_loops([mesh.vertices[mesh.loops[k]] for k in outer])

    @cached_property
    def hull(self) -> Mesh:
        """The convex hull."""
        points = self.fine.vertices
        return Mesh.from_loops([points[convex_hull(points)]])

    @cached_property
    def joins(self) -> list[Any]:
        """The polygon of each join, the shortest first."""
        if not 1 < (self.fine.loop_signs > 0).sum() <= MAX_PARTS or not has_shapely():
            return []
        from .bridging import bridges  # with more of scipy

        return bridges(load_shapely("Joining parts"), self.fine)

    def _joined(self, patches: list[Any]) -> Mesh:
        """The mesh with patches, and the gaps that these close filled."""
        from ..geometry.solids import mesh_of

        shapely = load_shapely("Joining parts")
        parts = shapely.geometry.shape(self.fine.__geo_interface__).geoms
        holes = shapely.STRtree([shapely.Polygon(ring) for part in parts for ring in part.interiors])
        solid = shapely.union_all([*parts, *patches])
        rings = [ring for part in getattr(solid, "geoms", [solid]) for ring in part.interiors]
        gaps = [gap for ring in rings for gap in shapely.get_parts(shapely.difference(shapely.Polygon(ring), solid))]
        closed = [gap for gap in gaps if len(holes.query(gap.representative_point(), predicate="within")) == 0]
        return mesh_of(shapely.union_all([solid, *closed]))


def empty_holes(mesh: Mesh) -> list[int]:
    """The holes with nothing in them."""
    return [k for k in np.flatnonzero(mesh.loop_signs < 0).tolist() if k not in mesh.parent_of_loop]


def filled(mesh: Mesh, holes: Iterable[int]) -> Mesh:
    """A mesh without some holes with nothing in them."""
    left = np.setdiff1d(np.arange(len(mesh.loops)), list(holes)).tolist()
    return mesh if len(left) == len(mesh.loops) else Mesh.from_loops([mesh.vertices[mesh.loops[k]] for k in left])
