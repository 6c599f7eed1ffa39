"""Transforms and view boxes as matrices (SVG 1.1, sections 7.6 to 7.8)."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from xml.etree import ElementTree as ET

import numpy as np

from ...errors import invalid_file
from ...geometry.arrays import FloatArray
from .lengths import NUMBER, numbers

ALIGNED = {"xmin": 0.0, "xmid": 0.5, "xmax": 1.0, "ymin": 0.0, "ymid": 0.5, "ymax": 1.0}
"""Fraction of the empty space before the view box, for each part of preserveAspectRatio."""

CALL = re.compile(r"[\s,]*([A-Za-z]+)\s*\(([^)]*)\)[\s,]*")
VALUE = re.compile(rf"({NUMBER.pattern})(deg|rad|grad|turn|px)?")
DEGREES = {"": 1.0, "px": 1.0, "deg": 1.0, "rad": 180.0 / math.pi, "grad": 0.9, "turn": 360.0}
"""Units of angles and lengths, in style sheets only."""

MAX_TRANSFORM_SHOWN = 60
"""Maximum length of a transform in a message."""


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


def read_transform(text: str) -> FloatArray:
    """The product of a list of transforms; the identity for an empty one. Raises NestedCagesError."""
    product = np.eye(3)
    place = 0
    text = text.rstrip()
    while place < len(text) and text != "none":
        found = CALL.match(text, place)
        values = [float(x) * DEGREES[unit] for x, unit in VALUE.findall(found[2])] if found else []
        whole = found is not None and not VALUE.sub("", found[2]).strip(" ,\t\r\n") and np.isfinite(values).all()
        try:
            product = product @ MATRICES[found[1] if found and whole else ""](*values)
            place = found.end() if found else place
        except (KeyError, TypeError, ValueError):  # another name, or a wrong number of values
            raise invalid_file(
                f"The transform '{text[:MAX_TRANSFORM_SHOWN]}' cannot be read; use matrix, translate, scale, "
                "rotate, skewX and skewY with finite numbers."
            ) from None
    return product


def translation(x: float, y: float) -> FloatArray:
    return np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]])


def scaling(x: float, y: float) -> FloatArray:
    return np.diag([x, y, 1.0])


def turned(degrees: float) -> FloatArray:
    matrix = np.eye(3)
    angle = math.radians(degrees)
    matrix[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    return matrix


def moved(points: FloatArray, matrix: FloatArray) -> FloatArray:
    """Points (..., 2) under a matrix."""
    return np.asarray(points @ matrix[:2, :2].T + matrix[:2, 2])


def _rotation(degrees: float, *about: float) -> FloatArray:
    x, y = about or (0.0, 0.0)
    return translation(x, y) @ turned(degrees) @ translation(-x, -y)


def _skew(degrees: float, row: int) -> FloatArray:
    matrix = np.eye(3)
    matrix[row, 1 - row] = math.tan(math.radians(degrees))
    return matrix


MATRICES: dict[str, Callable[..., FloatArray]] = {
    "matrix": lambda a, b, c, d, e, f: np.array([(a, c, e), (b, d, f), (0.0, 0.0, 1.0)]),
    "translate": lambda x, y=0.0: translation(x, y),
    "translateX": lambda x: translation(x, 0.0),
    "translateY": lambda y: translation(0.0, y),
    "scale": lambda x, y=None: scaling(x, x if y is None else y),
    "scaleX": lambda x: scaling(x, 1.0),
    "scaleY": lambda y: scaling(1.0, y),
    "rotate": _rotation,
    "skewX": lambda degrees: _skew(degrees, 0),
    "skewY": lambda degrees: _skew(degrees, 1),
}
"""The matrix of each transform, from its numbers."""
