"""Gaps, holes, notches and spikes too narrow to be seen, closed and cut off by their width."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.broad_phase import near_pairs
from ..geometry.mesh import Mesh

MITRE_LIMIT = 50.0
"""Maximum mitre length of offsets, in widths: corners sharper than 2.3 degrees count as narrow."""

MARGIN = 1e-3
"""Depth, in widths, below which a difference from the offset region is the rounding of the offsets."""

SAMPLE = 64
"""Number of vertices that are looked at first, and by how much the next ones are more."""

GRID = 1e-6
"""Spacing, in widths, of the grid that overlays are rounded to where they need one."""


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
    perimeters = np.array([mesh.edge_lengths[loop].sum() for loop in mesh.loops])
    if (2.0 * np.abs(mesh.loop_areas) < width * perimeters).any():
        return True
    back, on = vertices[mesh.predecessor] - vertices, vertices[after] - vertices
    lengths = np.hypot(*back.T) * np.hypot(*on.T)
    turn = np.abs(back[:, 0] * on[:, 1] - back[:, 1] * on[:, 0])
    if bool((((back * on).sum(axis=1) > 0.0) & (turn < 2.0 / MITRE_LIMIT * lengths)).any()):
        return True
    return comes_close(mesh, width)


def comes_close(mesh: Mesh, width: float) -> bool:
    """Whether parts of a mesh are that close, apart from short edges and sharp corners."""
    after, first, size = mesh.successor, 0, SAMPLE
    # crowds show in a sample, before they make all pairs
    order = np.random.default_rng(0).permutation(len(mesh.vertices))
    while first < len(order):
        chosen = order[first : first + size]
        place, edge = near_pairs(mesh.vertices[chosen], mesh.vertices, mesh.edge_ends, width)
        vertex, end = chosen[place], after[edge]
        if bool(((edge != vertex) & (end != vertex) & (edge != after[vertex]) & (after[end] != vertex)).any()):
            return True
        first, size = first + size, SAMPLE * size
    return False


def without_hairlines(shapely: Any, region: Any, *, gap: float, spike: float = 0.0) -> Hairlines:
    """A valid region with gaps narrower than `gap` filled and spikes narrower than `spike` cut off.

    All other vertices keep their coordinates. A narrow part that joins others, or is a part of its own, stays.
    """
    region, holes = _without_small_holes(shapely, region, gap)
    whole, fills, spikes = region, [], []
    try:
        fills = _fills(shapely, region, gap) if gap > 0.0 else []
        if fills:
            region = _overlaid(shapely, "union", gap, region, _overlaid(shapely, "union_all", gap, fills))
        spikes = _spikes(shapely, region, spike) if spike > 0.0 else []
        if spikes:
            region = _overlaid(shapely, "difference", spike, region, _overlaid(shapely, "union_all", spike, spikes))
    except shapely.errors.GEOSException:  # hairlines cost vertices, but no drawing
        return Hairlines(whole, holes, 0)
    return Hairlines(region, holes + len(fills), len(spikes))


def _without_small_holes(shapely: Any, region: Any, width: float) -> tuple[Any, int]:
    """A region without holes that are smaller in both directions, and their number; overlays lose the smallest ones."""
    parts, small = [], 0
    for part in shapely.get_parts(region):
        rings = getattr(part, "interiors", ())
        wide = [ring for ring in rings if np.ptp(np.reshape(ring.bounds, (2, 2)), axis=0).max() >= width]
        parts.append(shapely.Polygon(part.exterior, wide) if len(wide) < len(rings) else part)
        small += len(rings) - len(wide)
    return (shapely.union_all(parts), small) if small else (region, 0)


def _overlaid(shapely: Any, operation: str, width: float, *given: Any) -> Any:
    """An operation of GEOS, rounded to a fine grid where boundaries are too close together to do without."""
    try:
        return getattr(shapely, operation)(*given)
    except shapely.errors.GEOSException:  # offsets may be invalid
        return getattr(shapely, operation)(*map(shapely.make_valid, given), grid_size=GRID * width)


def without_short_edges(ring: FloatArray, width: float) -> FloatArray:
    """A ring (k, 2) without the second of two points that the mouth of a closed gap leaves next to each other."""
    step = np.roll(ring, -1, axis=0) - ring
    kept = np.roll(np.hypot(*step.T) > MARGIN * width, 1)
    return ring[kept] if width > 0.0 and kept.sum() > 2 else ring


def _fills(shapely: Any, region: Any, width: float) -> list[Any]:
    """What has to be added to a region so that no gap in it is narrower."""
    reach, margin = 0.5 * width, MARGIN * width
    wider = _offset(shapely, region, reach)
    found = _overlaid(shapely, "difference", width, _offset(shapely, wider, -reach - margin), region)
    if found.is_empty:
        return []
    closed = _offset(shapely, wider, -reach)
    return _parts_at(shapely, _overlaid(shapely, "difference", width, closed, region), found)


def _spikes(shapely: Any, region: Any, width: float) -> list[Any]:
    """The ends of a region narrower than a width; neither its necks, handles nor parts, except for specks."""
    reach, margin = 0.5 * width, MARGIN * width
    core = _offset(shapely, region, -reach)
    found = _overlaid(shapely, "difference", width, region, _offset(shapely, core, reach + margin))
    if found.is_empty:
        return []
    body = _offset(shapely, core, reach)
    parts = _parts_at(shapely, _overlaid(shapely, "difference", width, region, body), found)
    if not parts:
        return []
    contacts = _contacts(shapely, shapely.buffer(parts, margin), body)
    extent = np.ptp(shapely.bounds(parts).reshape(-1, 2, 2), axis=1).max(axis=1)
    specks = (contacts == 0) & (extent < width) & (not core.is_empty)
    return [part for part, ends in zip(parts, specks | (contacts == 1), strict=True) if ends]


def _contacts(shapely: Any, parts: Any, body: Any) -> IntArray:
    """(P,) number of stretches of a body's boundary within each part."""
    points, ring = shapely.get_coordinates(shapely.get_rings(shapely.get_parts(body)), return_index=True)
    edges = shapely.linestrings(np.stack((points[:-1], points[1:]), axis=1)[ring[1:] == ring[:-1]])
    part, edge = shapely.STRtree(edges).query(parts, predicate="intersects")
    pieces, index = shapely.get_parts(shapely.intersection(edges[edge], parts[part]), return_index=True)
    part = part[index]
    stretches = shapely.length(pieces) > 0.0
    number = np.zeros(len(parts), dtype=np.int64)
    if stretches.any():
        near, index = np.unique(part[stretches], return_inverse=True)
        lines = shapely.multilinestrings(pieces[stretches], indices=index)
        number[near] = shapely.get_num_geometries(shapely.line_merge(lines))
    return number


def _offset(shapely: Any, region: Any, distance: float) -> Any:
    return shapely.buffer(region, distance, join_style="mitre", mitre_limit=MITRE_LIMIT)


def _parts_at(shapely: Any, parts: Any, found: Any) -> list[Any]:
    """The polygons that have an area in common with others, which are what is narrow beyond rounding."""
    candidates = [part for part in shapely.get_parts(parts) if part.geom_type == "Polygon"]
    places = shapely.point_on_surface(shapely.get_parts(found))
    touched = shapely.STRtree(candidates).query(places, predicate="dwithin", distance=0.0)[1]
    return [candidates[k] for k in np.unique(touched)]
