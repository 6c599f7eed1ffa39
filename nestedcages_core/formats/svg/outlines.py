"""Outlines of paths and basic shapes (SVG 1.1, sections 8 and 9)."""

from __future__ import annotations

import math
import re
from itertools import islice
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import ArrayLike

from ..limits import Limits, Quota
from .curves import CONIC, LINE, Subpath
from .elements import name_of, title_of
from .faults import quoted
from .lengths import NUMBER, Viewport, attribute
from .path_data import PathReader, ellipse

OUTLINED = frozenset(("path", "rect", "circle", "ellipse", "line", "polyline", "polygon"))
"""Elements with an outline."""

NOT_POINTS = re.compile(r"[^\d\s,.eE+-].*", re.DOTALL)
"""From the first character that is not part of a number."""


def outline(item: ET.Element, viewport: Viewport, quota: Quota | None = None) -> list[Subpath]:
    """The outline of an element, in its own units, up to what cannot be read; nothing for other elements.

    Raises NestedCagesError where points go beyond the quota.
    """
    quota = quota or Quota(Limits())
    name = name_of(item)

    def length(key: str) -> float:
        return attribute(item, key, viewport)

    if name == "path":
        reader = PathReader(item.get("d", ""), quota)
        found = reader.read()
        if reader.fault:
            viewport.faults.add(f"The data of the {title_of(item)} {reader.fault}; the rest is left out")
        return found
    if name in ("polygon", "polyline"):
        text = item.get("points", "")
        end = NOT_POINTS.search(text)
        if end:
            where = quoted(end[0])
            viewport.faults.add(f"The points of the {title_of(item)} go wrong at {where}; the rest is left out")
            text = text[: end.start()]
        values = [float(found[0]) for found in islice(NUMBER.finditer(text), 2 * quota.limits.points + 2)]
        quota.spend("points", len(values) // 2)
        return through(np.reshape(values[: len(values) // 2 * 2], (-1, 2)), closed=name == "polygon")
    if name == "line":
        return through([[length("x1"), length("y1")], [length("x2"), length("y2")]], closed=False)
    if name == "rect":
        rx, ry = item.get("rx", "auto").strip(), item.get("ry", "auto").strip()
        first = attribute(item, "rx" if rx != "auto" else "ry", viewport)
        second = attribute(item, "ry" if ry != "auto" else "rx", viewport)
        return _rectangle(length("x"), length("y"), length("width"), length("height"), first, second)
    if name in ("circle", "ellipse"):
        radii = [length("r")] * 2 if name == "circle" else _radii(item, viewport)
        centre = np.array([length("cx"), length("cy")])
        points, half = ellipse(centre, np.diag(radii))
        count = len(points) // CONIC
        return [Subpath(points, np.full(count, CONIC), np.full(count, half), True)] if min(radii) > 0.0 else []
    return []


def through(points: ArrayLike, *, closed: bool) -> list[Subpath]:
    """Lines through points."""
    given = np.asarray(points, dtype=np.float64)
    around = np.concatenate((given, given[:1])) if closed else given
    edges = len(around) - 1
    return [Subpath(around, np.full(edges, LINE), np.zeros(edges), closed)] if len(given) > 1 else []


def _radii(item: ET.Element, viewport: Viewport) -> list[float]:
    """Of an ellipse; one that is not given is the other one."""
    given = [key for key in ("rx", "ry") if item.get(key, "auto").strip() != "auto"]
    return [attribute(item, key if key in given else (given or [key])[0], viewport) for key in ("rx", "ry")]


def _rectangle(x: float, y: float, width: float, height: float, rx: float, ry: float) -> list[Subpath]:
    if not (width > 0.0 and height > 0.0):
        return []
    rx, ry = min(rx, width / 2.0), min(ry, height / 2.0)
    corners = np.array([[x + width, y + height], [x, y + height], [x, y], [x + width, y]])
    if not (rx > 0.0 and ry > 0.0):
        return through(np.roll(corners, 2, axis=0), closed=True)
    centres = corners + np.array([[-rx, -ry], [rx, -ry], [rx, ry], [-rx, ry]])
    axes, quarter = np.diag((rx, ry)), math.pi / 2.0
    arcs = [ellipse(centre, axes, k * quarter, quarter)[0] for k, centre in enumerate(centres)]
    points = np.concatenate((*arcs, arcs[0][:1]))
    degrees = np.array([CONIC, LINE] * 4)
    return [Subpath(points, degrees, np.where(degrees == CONIC, quarter / 2.0, 0.0), True)]
