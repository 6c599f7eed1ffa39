"""The shapes of a document with their clips, and what elements pass on to their children."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from xml.etree import ElementTree as ET

import numpy as np

from ...errors import invalid_file
from ...geometry.arrays import FloatArray
from ..limits import Quota
from .curves import Subpath, box_around
from .document import Document
from .elements import name_of
from .faults import Faults, quoted
from .lengths import Viewport, parse_length
from .names import layer_names
from .options import SvgOptions
from .outlines import rectangle
from .paints import Gradient, Paint
from .path_data import PathReader
from .strokes import Stroke
from .style import Style
from .transforms import moved, scaling, translation

PLACES_OF_ORIGIN = {"left": "0%", "top": "0%", "center": "50%", "right": "100%", "bottom": "100%"}

PAINT, CLIP, MASK = "paint", "clip", "mask"
"""Purposes of shapes: to be painted, to clip by their outlines, to mask by their luminance."""


@dataclass(frozen=True, eq=False)
class Shape:
    """One element with an outline."""

    name: str
    """Name in messages."""
    subpaths: list[Subpath]
    """In its own units."""
    matrix: FloatArray
    """From its units to those of the document."""
    evenodd: bool = False
    fill: Paint | None = None
    stroke: Stroke | None = None
    stroke_paint: Paint | None = None
    scales: bool = True
    """Whether the width of its stroke follows its transforms."""
    id: str = ""
    groups: tuple[str, ...] = ()
    """Names of the groups around it, the outermost first."""
    classes: str = ""
    """Its own ones, as written."""
    clips: tuple[Clip, ...] = ()
    """Of itself and of the groups around it, the innermost first."""

    @cached_property
    def placed(self) -> list[FloatArray]:
        """Control points of its subpaths in the document."""
        return [moved(path.points, self.matrix) for path in self.subpaths]


@dataclass(frozen=True, eq=False)
class Clip:
    """What is kept of shapes: the inside of others, or what these show as a mask."""

    shapes: list[Shape]
    is_mask: bool = False


def rectangular_clip(x: float, y: float, width: float, height: float, matrix: FloatArray, quota: Quota) -> Clip:
    subpaths = PathReader(rectangle(x, y, width, height), quota).read()
    return Clip([Shape("rect", subpaths, matrix, fill=Paint(1.0))] if subpaths else [])


def unit_box(shapes: Sequence[Shape], matrix: FloatArray) -> FloatArray:
    """The matrix to the document from the unit square that is the box around shapes in units that `matrix` places.

    Not invertible where these units are none.
    """
    if not abs(np.linalg.det(matrix[:2, :2])) > 0.0:
        return matrix
    back = np.asarray(np.linalg.inv(matrix), np.float64)
    low, high = box_around(
        [path for shape in shapes for path in shape.subpaths],
        [moved(points, back) for shape in shapes for points in shape.placed],
    )
    return matrix @ translation(*low) @ scaling(*(high - low))


def units_of(shape: Shape, gradient: Gradient) -> FloatArray:
    """The matrix (3, 3) to the document from the units of a gradient of a shape, before its own matrix."""
    return unit_box([shape], shape.matrix) if gradient.of_box else shape.matrix


@dataclass(frozen=True)
class Context:
    """Inherited state of an element."""

    matrix: FloatArray
    viewport: Viewport
    style: Style = field(default_factory=dict)
    opacity: float = 1.0
    purpose: str = PAINT
    in_element: bool = True
    in_layer: bool = True
    users: tuple[ET.Element, ...] = ()
    """References that are being followed."""
    depth: int = 0
    groups: tuple[str, ...] = ()
    used_as: str = ""
    """Name of the reference to the element, which is that of what it shows."""


def check_names(document: Document, options: SvgOptions) -> None:
    """Raise NestedCagesError if the element or a layer that is asked for is not in the drawing."""
    element = options.element
    if element is not None and element not in document.by_id:
        known = ", ".join(sorted(filter(None, document.by_id))[:12]) or "none"
        raise invalid_file(f"The drawing has no element with the id {quoted(element)}; its ids: {known}.")
    labels = [name for item in document.root if name_of(item) == "g" for name in layer_names(item)]
    for layer in options.layers:
        if layer not in labels:
            known = ", ".join(labels[:12]) or "none"
            raise invalid_file(f"The drawing has no layer {quoted(layer)}; its layers: {known}.")


def origin_of(style: Style, viewport: Viewport, title: str, faults: Faults) -> tuple[float, float]:
    """The point that the transform of an element leaves where it is."""
    words = style.get("transform-origin", "").replace(",", " ").split()
    if not words:
        return 0.0, 0.0
    if style.get("transform-box", "view-box") != "view-box":
        faults.add(f"The transform-box of the {title} is not the view box: the origin is at 0 0")
        return 0.0, 0.0
    if words[0] in ("top", "bottom") or words[1:2] in (["left"], ["right"]):
        words[:2] = [[*words, "center"][1], words[0]]
    x, y = (PLACES_OF_ORIGIN.get(word, word) for word in [*words, "center"][:2])
    what = f"transform-origin of the {title}"
    return parse_length(x, "x", what, viewport), parse_length(y, "y", what, viewport)


def is_meant(item: ET.Element) -> bool:
    """Whether an element needs no extensions and is for readers of English, if it is for some only."""
    languages = item.get("systemLanguage")
    return not item.get("requiredExtensions") and (
        languages is None or any(part.strip().lower().startswith("en") for part in languages.split(","))
    )


def chosen(item: ET.Element) -> list[ET.Element]:
    """The element that a `switch` draws: the first of its children that is meant."""
    return [child for child in item if name_of(child) not in ("", "foreignObject") and is_meant(child)][:1]
