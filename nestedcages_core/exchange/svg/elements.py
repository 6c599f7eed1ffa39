"""Single elements: what they inherit, their names, the origin of their transforms, and what a `switch` draws."""

from __future__ import annotations

from dataclasses import dataclass, field
from xml.etree import ElementTree as ET

from ...geometry.arrays import FloatArray
from ..limits import invalid
from .document import Document
from .lengths import Faults, Viewport, measure, name_of, quoted
from .options import SvgOptions
from .style import Style

PLACES_OF_ORIGIN = {"left": "0%", "top": "0%", "center": "50%", "right": "100%", "bottom": "100%"}

PAINT, CLIP, MASK = "paint", "clip", "mask"
"""Purposes of shapes: to be painted, to clip by their outlines, to mask by their luminance."""

LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"


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


def layer_names(item: ET.Element) -> list[str]:
    """Its label in Inkscape and its ID, those that it has."""
    return [name for name in (item.get(LABEL), item.get("id")) if name]


def check_names(document: Document, options: SvgOptions) -> None:
    """Raise NestedCagesError if the element or a layer that is asked for is not in the drawing."""
    element = options.element
    if element is not None and element not in document.by_id:
        known = ", ".join(sorted(filter(None, document.by_id))[:12]) or "none"
        raise invalid(f"The drawing has no element with the id {quoted(element)}; its ids: {known}.")
    labels = [name for item in document.root if name_of(item) == "g" for name in layer_names(item)]
    for layer in options.layers:
        if layer not in labels:
            known = ", ".join(labels[:12]) or "none"
            raise invalid(f"The drawing has no layer {quoted(layer)}; its layers: {known}.")


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
    return measure(x, "x", what, viewport), measure(y, "y", what, viewport)


def chosen(item: ET.Element) -> list[ET.Element]:
    """The element that a `switch` draws: its first child without unknown requirements."""
    for child in item:
        languages = child.get("systemLanguage")
        if (
            name_of(child) not in ("", "foreignObject")
            and not child.get("requiredExtensions")
            and (languages is None or any(part.strip().startswith("en") for part in languages.split(",")))
        ):
            return [child]
    return []
