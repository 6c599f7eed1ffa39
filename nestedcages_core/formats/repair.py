"""Published polygons repaired into meshes; every repair is named with its place."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from ..errors import InvalidMeshError, no_outline
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.predicates import orientation
from ..geometry.vectors import format_point
from ..libraries import load_shapely
from .crossings import edges_in, spend_crossings
from .fill import united
from .geometries import Polygon
from .hairlines import has_hairlines
from .limits import Quota

NEEDED_FOR = "Reading polygons that touch or cross"

HAIRLINE_PART, DEFAULT_HAIRLINE = 0.1, 1e-5
"""Width below which gaps are closed and spikes cut off, in tolerances, and by default in diagonals: the clearance."""

LEAST_HAIRLINE = 1e-9
"""The same in diagonals, for polygons that are valid: below what coordinates of maps resolve."""

SAME_AREA = 1e-6
"""Relative change of area up to which a polygon that touches itself is taken for what it says."""

GREATEST_PASSES = 64
"""Maximum number of rounds that remove spikes; GEOS repairs the rest."""


def repaired_mesh(
    polygons: list[Polygon], quota: Quota | None = None, *, tolerance: float | None = None, clean: bool = False
) -> tuple[Mesh, list[str]]:
    """The solid of polygons, each an outer ring (k, 2) and its holes, and the repairs made.

    Simple rings, apart from each other, keep their coordinates to the last bit. Others are repaired as GEOS does
    (`shapely.make_valid`, by structure); parts that touch in points are joined there by a very narrow neck.

    Gaps and spikes narrower than a tenth of the tolerance are closed and cut off. Without a tolerance, those narrower
    than 1e-5 of the diagonal, which have no room for a cage, but in valid polygons only if `clean`, else round-off.
    Raises InvalidMeshError where no area is left, NestedCagesError beyond the quota for crossings.
    """
    kept, notes = _cleaned(polygons)
    if not kept:
        raise no_outline(f"No polygon encloses an area{f' ({notes[-1]})' if notes else ''}.")
    corners = np.concatenate([np.concatenate(polygon) for polygon in kept])
    diagonal = float(np.hypot(*np.ptp(corners, axis=0)))
    width = DEFAULT_HAIRLINE * diagonal if tolerance is None else HAIRLINE_PART * tolerance
    least = width if clean or tolerance is not None else LEAST_HAIRLINE * diagonal
    mesh, fault = None, ""
    try:
        mesh = Mesh.from_geometry({"type": "MultiPolygon", "coordinates": kept})
        if not has_hairlines(mesh, least):
            return mesh, notes
        width = least
    except InvalidMeshError as error:
        fault = _first(error)
    touching = [f"parts that touch are joined: {fault}"] if fault else []
    shapely = load_shapely(NEEDED_FOR)
    shape = shapely.multipolygons([shapely.Polygon(outer, holes) for outer, *holes in kept])
    narrow: list[str] = []
    try:
        if mesh is None:
            spend_crossings(edges_in(shapely, [shape]), quota, own=True)
            faults = _faults(shapely, shape)
            shape = shapely.make_valid(shape, method="structure", keep_collapsed=False) if faults else shape
            touching = [f"{each}: repaired" for each in faults] or touching
        mended = united(shapely, shapely.get_parts(shape), seam=width, spike=width, quota=quota, notes=narrow)
    except shapely.errors.GEOSException as error:
        raise no_outline(f"{fault or 'narrow places'}, which cannot be repaired ({error}).") from error
    return mesh if mesh is not None and not narrow else mended, [*notes, *touching, *narrow]


def repaired_geometry(polygons: list[Polygon]) -> tuple[Mesh, list[str]] | None:
    """The solid of polygons that may touch or overlap each other, and the repairs; None if one crosses itself.

    For geometries of other programs; those that touch themselves without a change of their area are repaired too.
    """
    kept, _ = _cleaned(polygons)
    try:
        Mesh.from_geometry({"type": "MultiPolygon", "coordinates": kept})
    except InvalidMeshError:
        shapely = load_shapely(NEEDED_FOR)
        for outer, *holes in kept:
            part = shapely.Polygon(outer, holes)
            if not part.is_valid:
                whole = shapely.make_valid(part, method="structure", keep_collapsed=False)
                if not abs(whole.area - part.area) <= SAME_AREA * part.area:
                    return None
    return repaired_mesh(polygons) if kept else None


def _faults(shapely: Any, shape: Any) -> list[str]:
    """Each kind of fault once per ring, per polygon and for the whole, innermost first, with its place."""
    found = []
    for part in shapely.get_parts(shape):
        if not shapely.is_valid(part):
            rings = shapely.polygons(shapely.get_rings(part))
            found += [_reason(shapely, ring) for ring in rings[~shapely.is_valid(rings)]] or [_reason(shapely, part)]
    return found or ([] if shapely.is_valid(shape) else [_reason(shapely, shape)])


def _reason(shapely: Any, shape: Any) -> str:
    """The message of GEOS: its reason, and the place in user coordinates."""
    text = shapely.is_valid_reason(shape)
    parts = re.fullmatch(r"(.*)\[(\S+) (\S+).*\]", text)
    return f"{parts[1].lower()} at {format_point((float(parts[2]), float(parts[3])))}" if parts else text.lower()


def _first(error: InvalidMeshError) -> str:
    """The fault, without the advice."""
    return str(error).split(";")[0].rstrip(".").lower()


def _cleaned(polygons: list[Polygon]) -> tuple[list[Polygon], list[str]]:
    """The polygons without repeated points, spikes and rings of zero area."""
    kept: list[Polygon] = []
    notes: list[str] = []
    for polygon in polygons:
        rings: Polygon = []
        for k, ring in enumerate(polygon):
            points, left_out = _without_spikes(ring)
            if len(points) < 3:
                where = f" at {format_point(ring[0])}" if len(ring) else ""
                notes.append(f"{'a hole' if k else 'a polygon'} of zero area{where}: left out")
                if k == 0:
                    break
                continue
            rings.append(points)
            notes += left_out
        if rings:
            kept.append(rings)
    return kept, notes


def _without_spikes(ring: FloatArray) -> tuple[FloatArray, list[str]]:
    """A ring without repeated points and spikes, and a description of what was removed."""
    notes = []
    points = ring[:-1] if len(ring) > 1 and (ring[0] == ring[-1]).all() else ring
    still = (points == np.roll(points, -1, axis=0)).all(axis=1)
    if still.any() and len(points) > 1:
        notes.append(
            f"{_counted(int(still.sum()), 'repeated point')}, the first at {format_point(points[still][0])}: left out"
        )
    points = points[~still] if len(points) > 1 else points
    tips = []
    for _ in range(GREATEST_PASSES):
        if len(points) < 3:
            break
        before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
        straight = orientation(before, points, after) == 0
        tip = straight & (np.sign(points - before) != np.sign(after - points)).any(axis=1)
        if not tip.any():
            break
        apart = tip & ~np.roll(tip, 1)  # of neighbours one at a time
        tip = apart if apart.any() else np.arange(len(points)) == 0
        tips.extend(points[tip])
        points = points[~tip]
        points = points[(points != np.roll(points, -1, axis=0)).any(axis=1)]
    if tips:
        notes.append(f"{_counted(len(tips), 'spike')}, the first to {format_point(tips[0])}: left out")
    return points, notes


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
