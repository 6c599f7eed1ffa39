"""Narrow gaps in a region: those between parts that nearly touch, and slits."""

from __future__ import annotations

from typing import Any

SMALLEST_BRIDGE = 1e-3
"""Area of a bridge over the squared distance, below which it counts as rounding."""


def bridges(shapely: Any, region: Any, distance: float) -> list[Any]:
    """The fill of a region's gaps narrower than a distance (morphological closing with mitred corners)."""
    radius = 0.5 * distance
    closed = shapely.buffer(shapely.buffer(region, radius, join_style="mitre"), -radius, join_style="mitre")
    added = shapely.get_parts(shapely.difference(closed, region))
    return list(added[shapely.area(added) > SMALLEST_BRIDGE * distance * distance])
