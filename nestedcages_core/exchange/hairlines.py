"""Gaps, holes, notches and spikes too narrow to be seen, closed and cut off by their width."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..geometry.arrays import FloatArray
from ..geometry.broad_phase import near_pairs
from ..geometry.mesh import Mesh

MITRE_LIMIT = 50.0
"""Maximum mitre length of offsets, in widths: corners sharper than 2.3 degrees count as narrow."""

MARGIN = 1e-3
"""Depth, in widths, below which a difference from the offset region is the rounding of the offsets."""


class Hairlines(NamedTuple):
    """A region without its hairlines, and their numbers."""

    region: Any
    gaps: int
    """Gaps, holes and notches that were filled."""
    spikes: int

    def note(self, width: float) -> str:
        """What was closed and cut off, in words."""
        counted = ((self.gaps, "gap", "closed"), (self.spikes, "spike", "cut off"))
        words = [f"{number} {what}{'s' if number > 1 else ''} {done}" for number, what, done in counted if number]
        return f"narrower than {width:.3g}: {', '.join(words)}"


def has_hairlines(mesh: Mesh, width: float) -> bool:
    """Whether edges without a common vertex, the sides of a very sharp corner or those of a loop are that close."""
    if not width > 0.0:
        return False
    vertices, after = mesh.vertices, mesh.successor
    thickness = [2.0 * abs(area) / length for area, length in zip(mesh.loop_areas, _perimeters(mesh), strict=True)]
    if min(thickness) < width:
        return True
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    back, on = vertices[before] - vertices, vertices[after] - vertices
    lengths = np.hypot(*back.T) * np.hypot(*on.T)
    turn = np.abs(back[:, 0] * on[:, 1] - back[:, 1] * on[:, 0])
    if bool((((back * on).sum(axis=1) > 0.0) & (turn < 2.0 / MITRE_LIMIT * lengths)).any()):
        return True
    vertex, edge = near_pairs(vertices, vertices, mesh.edge_ends, width)
    end = after[edge]
    apart = (edge != vertex) & (end != vertex) & (edge != after[vertex]) & (after[end] != vertex)
    return bool(apart.any())


def without_hairlines(shapely: Any, region: Any, *, gap: float, spike: float = 0.0) -> Hairlines:
    """A valid region with gaps narrower than `gap` filled and spikes narrower than `spike` cut off.

    All other vertices keep their coordinates. A narrow part that joins others, or is a part of its own, stays.
    """
    fills, spikes = _fills(shapely, region, gap) if gap > 0.0 else [], []
    if fills:
        region = shapely.union_all([region, *fills])
    if spike > 0.0:
        spikes = _spikes(shapely, region, spike)
    if spikes:
        region = shapely.difference(region, shapely.union_all(spikes))
    return Hairlines(region, len(fills), len(spikes))


def without_short_edges(ring: FloatArray, width: float) -> FloatArray:
    """A ring (k, 2) without the second of two points that the mouth of a closed gap leaves next to each other."""
    step = np.roll(ring, -1, axis=0) - ring
    kept = np.roll(np.hypot(*step.T) > MARGIN * width, 1)
    return ring[kept] if kept.sum() > 2 else ring


def _perimeters(mesh: Mesh) -> list[float]:
    return [float(mesh.edge_lengths[loop].sum()) for loop in mesh.loops]


def _fills(shapely: Any, region: Any, width: float) -> list[Any]:
    """What has to be added to a region so that no gap in it is narrower."""
    reach, margin = 0.5 * width, MARGIN * width
    wider = _offset(shapely, region, reach)
    found = shapely.difference(_offset(shapely, wider, -reach - margin), region)
    if found.is_empty:
        return []
    return _parts_at(shapely, shapely.difference(_offset(shapely, wider, -reach), region), found)


def _spikes(shapely: Any, region: Any, width: float) -> list[Any]:
    """The ends of a region narrower than a width; neither its necks, handles nor parts, except for specks."""
    reach, margin = 0.5 * width, MARGIN * width
    core = _offset(shapely, region, -reach)
    found = shapely.difference(region, _offset(shapely, core, reach + margin))
    if found.is_empty:
        return []
    body = _offset(shapely, core, reach)
    spikes = []
    for part in _parts_at(shapely, shapely.difference(region, body), found):
        contacts = shapely.intersection(shapely.buffer(part, margin), body)
        speck = contacts.is_empty and not core.is_empty and max(np.ptp(np.reshape(part.bounds, (2, 2)), axis=0)) < width
        if speck or (not contacts.is_empty and shapely.get_num_geometries(contacts) == 1):
            spikes.append(part)
    return spikes


def _offset(shapely: Any, region: Any, distance: float) -> Any:
    return shapely.buffer(region, distance, join_style="mitre", mitre_limit=MITRE_LIMIT)


def _parts_at(shapely: Any, parts: Any, found: Any) -> list[Any]:
    """The polygons that have an area in common with others, which are what is narrow beyond rounding."""
    candidates = [part for part in shapely.get_parts(parts) if part.geom_type == "Polygon"]
    places = shapely.point_on_surface(shapely.get_parts(found))
    return [
        candidates[k]
        for k in np.unique(shapely.STRtree(candidates).query(places, predicate="dwithin", distance=0.0)[1])
    ]
