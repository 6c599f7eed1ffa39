"""Numbers, lengths and viewports of SVG."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from xml.etree import ElementTree as ET

import numpy as np

from ...errors import NestedCagesError
from ...geometry.arrays import FloatArray
from .transforms import NUMBER, scaling, translation

UNITS_OF_LENGTH = {
    "": 1.0,
    "px": 1.0,
    "in": 96.0,
    "cm": 96.0 / 2.54,
    "mm": 96.0 / 25.4,
    "q": 96.0 / 101.6,
    "pt": 96.0 / 72.0,
    "pc": 16.0,
}
"""User units of each unit of length (CSS: 96 px to the inch)."""

ACROSS, DOWN = ("x", "width", "cx", "rx", "x1", "x2"), ("y", "height", "cy", "ry", "y1", "y2")
"""Attributes whose percentages refer to the viewport's width, and to its height; others refer to its diagonal."""

LENGTH = re.compile(r"([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d+)?)\s*([a-z%]*)", re.IGNORECASE)

ALIGNED = {"xmin": 0.0, "xmid": 0.5, "xmax": 1.0, "ymin": 0.0, "ymid": 0.5, "ymax": 1.0}
"""Fraction of the empty space before the view box, for each part of preserveAspectRatio."""

MAX_SHOWN = 30
"""Maximum length of a value in a message."""


@dataclass(frozen=True)
class Viewport:
    """Size in user units that percentages refer to; None if the document has none."""

    width: float | None = None
    height: float | None = None

    def reference(self, key: str) -> float | None:
        """The value of 100 % of an attribute."""
        if self.width is None or self.height is None:
            return None
        if key in ACROSS:
            return self.width
        return self.height if key in DOWN else math.hypot(self.width, self.height) / math.sqrt(2.0)


def quoted(text: str) -> str:
    """A value, shortened for messages."""
    return f"'{text}'" if len(text) <= MAX_SHOWN else f"'{text[:MAX_SHOWN]}…'"


def numbers(text: str) -> list[float]:
    """All numbers in a list."""
    return [float(number) for number in NUMBER.findall(text)]


def measure(text: str, key: str, what: str, viewport: Viewport, missing: float = 0.0) -> float:
    """A length in user units. Raises NestedCagesError."""
    text = text.strip()
    if not text or text == "auto":
        return missing
    found = LENGTH.fullmatch(text)
    unit = found[2].lower() if found else ""
    scale: float | None = UNITS_OF_LENGTH.get(unit)
    if unit == "%":
        reference = viewport.reference(key)
        scale = reference / 100.0 if reference is not None else None
    if found is None or scale is None:
        raise NestedCagesError(
            f"The {what} is {quoted(text)}; use a number, or one with {', '.join(filter(None, UNITS_OF_LENGTH))}.",
            code="file.invalid",
        )
    value = float(found[1]) * scale
    if not math.isfinite(value):
        raise NestedCagesError(
            f"The {what} is {quoted(text)}, which is not finite; correct it.", code="mesh.not_finite"
        )
    return value


def attribute(item: ET.Element, key: str, viewport: Viewport, missing: float = 0.0) -> float:
    """A length in user units, `missing` if the attribute is not there. Raises NestedCagesError."""
    return measure(item.get(key, ""), key, f"{key} of the {name_of(item)}", viewport, missing)


def share(text: str | None, missing: float = 1.0) -> float:
    """A number or percentage as a fraction from 0 to 1."""
    found = LENGTH.fullmatch(text.strip()) if text else None
    if found is None or found[2] not in ("", "%"):
        return missing
    return min(max(float(found[1]) / (100.0 if found[2] else 1.0), 0.0), 1.0)


def name_of(item: ET.Element) -> str:
    """The tag without its namespace; comments have none."""
    return item.tag.rpartition("}")[2] if isinstance(item.tag, str) else ""


def link_of(item: ET.Element) -> str:
    """The target of a reference, with its `#`."""
    return (item.get("href") or item.get("{http://www.w3.org/1999/xlink}href") or "").strip()


def view_box_of(item: ET.Element) -> tuple[float, float, float, float] | None:
    """x, y, width and height of a view box that has an inside."""
    box = numbers(item.get("viewBox", ""))
    if len(box) != 4 or not np.isfinite(box).all() or not (box[2] > 0.0 and box[3] > 0.0):
        return None
    return box[0], box[1], box[2], box[3]


def fitted(
    box: tuple[float, float, float, float] | None, x: float, y: float, width: float, height: float, aspect: str
) -> FloatArray:
    """The matrix from a view box to the rectangle that it is fitted into (SVG 1.1, section 7.8)."""
    if box is None:
        return translation(x, y)
    across, down = width / box[2], height / box[3]
    words = aspect.lower().replace("defer", "").split() or ["xmidymid"]
    if words[0] != "none":
        across = down = max(across, down) if "slice" in words else min(across, down)
        x += (width - across * box[2]) * ALIGNED.get(words[0][:4], 0.5)
        y += (height - down * box[3]) * ALIGNED.get(words[0][4:], 0.5)
    return translation(x, y) @ scaling(across, down) @ translation(-box[0], -box[1])
