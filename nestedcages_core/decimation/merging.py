"""Merging: starts around a shape whose close parts are joined and whose small holes are filled. Needs shapely."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isfinite
from typing import Any

import numpy as np

from ..errors import InvalidMeshError, NestedCagesError, NestingError
from ..geometry.mesh import Mesh
from ..geometry.precision import NEGLIGIBLE
from ..geometry.solids import mesh_of
from ..libraries import load_shapely
from ..parameters import check_limit, check_part
from ..tasks import Stage, drain
from .base import Count, Decimation, Start
from .budget import LEAST_PER_LOOP
from .line_cycles import LineCycles

PARTS = (0.0, 0.5, 1.0)
"""Parts of the distance that gaps are closed over, where bridges alone do not suffice: none is best for all shapes."""

BRIDGE = 0.01
"""Half the width of a bridge between two parts, in its lengths."""

ARC = 4
"""Vertices of a quarter of the circles that close gaps."""


@dataclass(frozen=True)
class Merging:
    """Starts around the shape with its parts merged, for the distance up to the given one that adds the least area."""

    distance: float
    """In the input's units: gaps narrower than this are closed, holes of less than its square are filled. Infinite: one
    loop around all."""
    decimation: Decimation = field(default_factory=lambda: LineCycles(on_curve=False))
    """Makes the mesh around the merged shape."""

    def __post_init__(self) -> None:
        check_limit(self, "distance")
        check_part(self, "decimation", "decimate", "LineCycles()")

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """The mesh of least area; see `starts`."""
        return drain(self.starts(fine, count, clearance=clearance))[0].coarse

    def starts(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Stage[float, list[Start]]:
        """One mesh that encloses the shape, with fewer loops where parts are merged. Raises NestingError."""
        total = int(np.sum(count))
        best: Mesh | None = None
        failure: NestedCagesError | None = None
        needed: list[int] = []
        bridged = Bridged.of(fine, self.distance)
        for number, part in enumerate((None, *PARTS) if isfinite(self.distance) else PARTS):
            yield number / (1 + len(PARTS))
            try:
                shape = fine if part is None else bridged.closed(part)
                needed.append(LEAST_PER_LOOP * len(shape.loops))
                wanted = max(min(total, len(shape.vertices)), needed[-1])
                mesh = self.decimation.decimate(shape, wanted, clearance=clearance) if wanted <= total else None
            except (NestingError, InvalidMeshError) as error:
                failure = error
                needed.append(int(error.data.get("least", 0)))
                continue
            if mesh is not None and (best is None or mesh.area < best.area):
                best = mesh
        if best is None:
            enough = [count for count in needed if count > total]
            raise NestingError(
                f"{total} vertices are too few for this shape even with parts closer than {self.distance:.6g} merged; "
                "ask for more vertices, or merge over a larger distance.",
                code="count.too_small",
                total=total,
                **({"least": min(enough)} if enough else {}),
            ) from failure
        return [Start(best, "merged parts")]


@dataclass(frozen=True)
class Bridged:
    """A shape with bridges between its parts that are closer than a distance."""

    fine: Mesh
    distance: float
    """Infinite: all parts are joined, and all holes filled."""
    solid: Any
    """Of the shape, without bridges."""
    together: Any
    longest: float
    """Length of the longest bridge."""

    @classmethod
    def of(cls, fine: Mesh, distance: float) -> Bridged:
        """Thin bridges from each part to the nearest one. Raises NestedCagesError where shapely is missing."""
        shapely = load_shapely("Merging parts")
        solid = together = shapely.geometry.shape(fine.__geo_interface__)
        longest, within = 0.0, distance if isfinite(distance) else None
        while len(parts := np.array(getattr(together, "geoms", [together]))) > 1:
            tree = shapely.STRtree(parts)
            own, other = tree.query_nearest(parts, max_distance=within, exclusive=True, all_matches=False)
            lines = shapely.shortest_line(parts[own], parts[other])
            lengths = shapely.length(lines)
            bridges = shapely.buffer(lines, BRIDGE * lengths, quad_segs=1)
            joined = shapely.union_all([together, *bridges])
            if len(getattr(joined, "geoms", [joined])) == len(parts):  # none is close, or they touch
                break
            together, longest = joined, max(longest, float(lengths.max()))
        return cls(fine, distance, solid, together, longest)

    def closed(self, part: float) -> Mesh:
        """The bridged shape with gaps narrower than a part of the distance closed, an infinite one being that of the
        longest bridge, and holes of less than the square of the distance filled. Raises InvalidMeshError.
        """
        shapely, together = load_shapely("Merging parts"), self.together
        reach = 0.5 * part * (self.distance if isfinite(self.distance) else self.longest)
        if reach > 0.0:
            closed = self.solid.buffer(reach, quad_segs=ARC).buffer(-reach, quad_segs=ARC)
            together = shapely.union(together, closed)
        least = self.distance**2
        filled = [
            shapely.Polygon(each.exterior, [hole for hole in each.interiors if shapely.Polygon(hole).area >= least])
            for each in getattr(together, "geoms", [together])
            if each.geom_type == "Polygon"  # unions of nearly touching outlines may leave lines
        ]
        whole = shapely.union_all([*filled, self.solid])
        # grown, so that outlines that only touch overlap
        return mesh_of(whole.buffer(NEGLIGIBLE * self.fine.diagonal, join_style="mitre").union(self.solid))
