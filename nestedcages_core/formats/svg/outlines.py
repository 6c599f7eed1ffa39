"""Outlines of paths and basic shapes (SVG 1.1, sections 8 and 9), which are paths too."""

from __future__ import annotations

from xml.etree import ElementTree as ET

from ..limits import Quota
from .curves import Subpath
from .elements import name_of, title_of
from .lengths import Viewport, attribute
from .path_data import PathReader

OUTLINED = frozenset(("path", "rect", "circle", "ellipse", "line", "polyline", "polygon"))
"""Elements with an outline."""


def outline(item: ET.Element, viewport: Viewport, quota: Quota) -> list[Subpath]:
    """The outline of an element, in its own units, up to what cannot be read; nothing for other elements.

    Raises NestedCagesError where points go beyond the quota.
    """
    reader = PathReader(_path_data(item, viewport), quota)
    found = reader.read()
    if reader.fault:
        viewport.faults.add(f"The data of the {title_of(item)} {reader.fault}; the rest is left out")
    return found


def _path_data(item: ET.Element, viewport: Viewport) -> str:
    name = name_of(item)

    def length(key: str) -> float:
        return attribute(item, key, viewport)

    if name == "path":
        return item.get("d", "")
    if name in ("polygon", "polyline"):
        points = item.get("points", "").strip()
        return f"M{points}{'Z' if name == 'polygon' else ''}" if points else ""
    if name == "line":
        return f"M{length('x1')} {length('y1')}L{length('x2')} {length('y2')}"
    rx, ry = (length("r"), length("r")) if name == "circle" else _radii(item, viewport)
    if name == "rect":
        return rectangle(length("x"), length("y"), length("width"), length("height"), rx, ry)
    x, y, arc = length("cx"), length("cy"), f"A{rx} {ry} 0 0 1 "
    around = f"M{x + rx} {y}{arc}{x} {y + ry}{arc}{x - rx} {y}{arc}{x} {y - ry}{arc}{x + rx} {y}Z"
    return around if min(rx, ry) > 0.0 else ""


def _radii(item: ET.Element, viewport: Viewport) -> tuple[float, float]:
    """Of an ellipse or of round corners; one that is not given is the other one."""
    given = [key for key in ("rx", "ry") if item.get(key, "auto").strip() != "auto"]
    rx, ry = (attribute(item, key if key in given else (given or [key])[0], viewport) for key in ("rx", "ry"))
    return rx, ry


def rectangle(x: float, y: float, width: float, height: float, rx: float = 0.0, ry: float = 0.0) -> str:
    """Path data of a rectangle, with corners of radii that are at most half of its sides."""
    if not (width > 0.0 and height > 0.0):
        return ""
    right, low, rx, ry = x + width, y + height, min(rx, width / 2.0), min(ry, height / 2.0)
    if not (rx > 0.0 and ry > 0.0):
        return f"M{x} {y}H{right}V{low}H{x}Z"
    arc = f"A{rx} {ry} 0 0 1 "
    return (
        f"M{x + rx} {y}H{right - rx}{arc}{right} {y + ry}V{low - ry}{arc}{right - rx} {low}"
        f"H{x + rx}{arc}{x} {low - ry}V{y + ry}{arc}{x + rx} {y}Z"
    )
