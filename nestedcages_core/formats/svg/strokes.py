"""Outlines of strokes: width, caps, joins and dashes (SVG 1.1, section 11.4)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...geometry.arrays import FloatArray
from ..limits import Limits, Quota
from ..solids import shapely, spend
from .faults import quoted
from .lengths import Viewport, numbers, parse_length

MAX_ARC_SEGMENTS = 64
"""Maximum number of chords of a quarter circle at a cap or join."""

FLAT = "flat"
CAPS = {"butt": FLAT, "round": "round", "square": "square"}
"""GEOS's names of caps."""


@dataclass(frozen=True)
class Stroke:
    """Style of a line, in the units of the line."""

    width: float
    cap: str = "butt"
    join: str = "miter"
    miter_limit: float = 4.0
    dashes: tuple[float, ...] = ()
    offset: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "dashes", self.dashes * (1 + len(self.dashes) % 2))

    def scaled(self, factor: float) -> Stroke:
        """The same stroke in other units."""
        return replace(self.along(factor), width=factor * self.width)

    def along(self, factor: float) -> Stroke:
        """The same stroke with other lengths along its line."""
        return replace(self, dashes=tuple(factor * dash for dash in self.dashes), offset=factor * self.offset)


@dataclass(frozen=True, eq=False)
class Polyline:
    """Points (k, 2) of a line; a closed one does not repeat its first point."""

    points: FloatArray
    closed: bool


def stroke_of(style: Mapping[str, str], viewport: Viewport) -> Stroke | None:
    """The stroke of an element with these properties, None if it has none."""
    if style.get("stroke", "none") == "none":
        return None
    width = parse_length(style.get("stroke-width", "1"), "r", "stroke-width", viewport, 1.0)
    if not width > 0.0:
        return None
    dashes: tuple[float, ...] = ()
    text = style.get("stroke-dasharray", "none")
    if text != "none":
        lengths = [viewport.length(part, "r") for part in text.replace(",", " ").split()]
        if None in lengths:
            what = f"The stroke-dasharray is {quoted(text)}, which is not a list of lengths: it is left out"
            viewport.faults.add(what)
        elif min(filter(None, lengths), default=0.0) >= 0.0:
            dashes = tuple(length or 0.0 for length in lengths)
    limit = numbers(style.get("stroke-miterlimit", "4"))
    return Stroke(
        width,
        style.get("stroke-linecap", "butt"),
        style.get("stroke-linejoin", "miter"),
        limit[0] if limit and limit[0] >= 1.0 else 4.0,
        dashes,
        parse_length(style.get("stroke-dashoffset", "0"), "r", "stroke-dashoffset", viewport),
    )


def stroked(lines: Sequence[Polyline], stroke: Stroke, tolerance: float, quota: Quota) -> list[Any]:
    """Geometries that together cover a stroke.

    tolerance: largest distance of chords from round caps and joins. Raises NestedCagesError for too many
    dashes, and for lines that cross themselves too often.
    """
    lines = _dashed(lines, stroke, quota.limits)
    radius = 0.5 * stroke.width
    ratio = min(max(tolerance / radius, 1e-9), 0.5)
    segments = min(max(math.ceil(math.pi / 4.0 / math.acos(1.0 - ratio)), 2), MAX_ARC_SEGMENTS)
    found = []
    for line in lines:
        points = _different(line)
        closed = line.closed and len(points) > 2
        if len(points) == 1:
            curve = shapely.points(points[0])
        else:
            curve = shapely.linearrings(points) if closed else shapely.linestrings(points)
        if not shapely.is_simple(curve):
            spend([curve], quota, own=True)
        mitred = stroke.join not in ("round", "bevel")
        tips = _tips(points, closed, radius, stroke.miter_limit) if mitred else None
        join = ("mitre" if tips is None else "bevel") if mitred else stroke.join
        style = {"cap_style": CAPS.get(stroke.cap, FLAT), "join_style": join, "mitre_limit": stroke.miter_limit}
        found.append(shapely.buffer(curve, radius, quad_segs=segments, **style))
        if tips is not None and len(tips):
            found += list(shapely.polygons(tips))
    return [geometry for geometry in found if not geometry.is_empty]


def _different(line: Polyline) -> FloatArray:
    """Points without those that repeat the one before, at least one."""
    repeated = (np.diff(line.points, axis=0) == 0.0).all(axis=1)
    points = line.points[np.append(True, ~repeated)]
    repeats = line.closed and len(points) > 1 and bool((points[0] == points[-1]).all())
    return np.asarray(points[:-1] if repeats else points)


def _tips(points: FloatArray, closed: bool, radius: float, limit: float) -> FloatArray | None:
    """(K, 4, 2) quadrilaterals that mitres add to bevels; None if no corner exceeds the limit, so that GEOS can.

    SVG bevels corners beyond the limit, GEOS cuts their mitres off.
    """
    corner = points if closed else points[1:-1]
    before = corner - (np.roll(points, 1, axis=0) if closed else points[:-2])
    after = (np.roll(points, -1, axis=0) if closed else points[2:]) - corner
    before, after = (step / np.hypot(*step.T)[:, None] for step in (before, after))
    cosine = (before * after).sum(axis=1)
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    with np.errstate(divide="ignore"):
        squared = np.where(cosine > -1.0, 2.0 / (1.0 + cosine), np.inf)  # square of mitre length by width
    within = squared <= limit * limit
    if within.all():
        return None
    bent = within & (turn != 0.0)
    side = -np.sign(turn[bent])[:, None] * radius
    first, second = (side * np.stack((-step[bent, 1], step[bent, 0]), axis=1) for step in (before, after))
    tip = (first + second) / (1.0 + cosine[bent])[:, None]
    centre = corner[bent]
    return np.asarray(np.stack((centre, centre + first, centre + tip, centre + second), axis=1))


def _dashed(lines: Sequence[Polyline], stroke: Stroke, limits: Limits) -> list[Polyline]:
    """The dashes of lines; the whole line if dashes leave no gap."""
    period = sum(stroke.dashes)
    if not period > 0.0 or not math.isfinite(period):
        return list(lines)
    found: list[Polyline] = []
    for line in lines:
        points = np.concatenate((line.points, line.points[:1])) if line.closed else line.points
        along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
        limits.check("points", len(found) + math.ceil(min(2.0 * along[-1] / period, 1e18)) * len(stroke.dashes))
        found += [Polyline(_substring(points, along, *ends), False) for ends in _dashes(stroke, period, along[-1])]
    return found


def _dashes(stroke: Stroke, period: float, length: float) -> Iterator[tuple[float, float]]:
    """Start and end of each dash along a line."""
    at = -(stroke.offset % period)
    while at < length:
        for k, size in enumerate(stroke.dashes):
            low, high = max(at, 0.0), min(at + size, length)
            if k % 2 == 0 and low <= high and low < length:
                yield low, high
            at += size


def _substring(points: FloatArray, along: FloatArray, low: float, high: float) -> FloatArray:
    """The part of a line between two lengths."""
    first, last = int(along.searchsorted(low, "right")), int(along.searchsorted(high))
    around = slice(max(min(first - 1, last), 0), last + 1)
    ends = [[np.interp(at, along[around], points[around, axis]) for axis in (0, 1)] for at in (low, high)]
    return np.concatenate((ends[:1], points[first:last], ends[1:]))
