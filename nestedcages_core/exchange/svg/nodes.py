"""The tree of a document: shapes, and groups that are filtered and clipped together."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from xml.etree import ElementTree as ET

import numpy as np

from ...geometry.arrays import FloatArray
from .filters import Filter
from .lengths import Viewport, measured_box
from .outlines import through
from .paints import Paint
from .path_data import Subpath
from .strokes import Stroke


@dataclass(frozen=True, eq=False)
class Shape:
    """One element with an outline."""

    name: str
    """Name in messages."""
    subpaths: list[Subpath]
    """In its own units."""
    matrix: FloatArray
    """From its units to those of the document, or of the clip that it is part of."""
    evenodd: bool = False
    fill: Paint | None = None
    stroke: Stroke | None = None
    stroke_paint: Paint | None = None
    scales: bool = True
    """Whether the width of its stroke follows its transforms."""
    id: str = ""
    groups: tuple[str, ...] = ()
    """Names of the groups around it, the outermost first."""


@dataclass(frozen=True, eq=False)
class Group:
    """Shapes that are filtered and clipped together."""

    children: list[Shape | Group] = field(default_factory=list)
    clips: list[Clip] = field(default_factory=list)
    filters: list[Filter] = field(default_factory=list)

    def shapes(self) -> Iterator[Shape]:
        """All shapes, the lowest first."""
        for child in self.children:
            if isinstance(child, Shape):
                yield child
            else:
                yield from child.shapes()


@dataclass(frozen=True, eq=False)
class Clip:
    """The region of a group that is kept."""

    content: Group
    matrix: FloatArray
    """From the units of the group to those of the document."""
    of_box: bool = False
    """Whether the content's units are shares of the group's box."""
    is_mask: bool = False


def attach(group: Group, to: Group) -> None:
    """Add a group to another one; without clips its shapes themselves."""
    if not group.clips and not group.filters:
        to.children.extend(group.children)
    elif group.children:
        to.children.append(group)


def rectangular_clip(x: float, y: float, width: float, height: float, matrix: FloatArray) -> Clip:
    sides = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
    return Clip(Group([Shape("rect", through(sides, closed=True), np.eye(3), fill=Paint(1.0))]), matrix)


def mask_region(item: ET.Element, around: Viewport, matrix: FloatArray) -> Clip:
    """The rectangle outside which a mask hides everything."""
    of_box = item.get("maskUnits", "objectBoundingBox") == "objectBoundingBox"
    corners = measured_box(item, around.sized(1.0, 1.0) if of_box else around, "mask")
    x, y, right, bottom = corners.ravel().tolist()
    return replace(rectangular_clip(x, y, right - x, bottom - y, matrix), of_box=of_box)
