"""Transforms of SVG as matrices (3, 3) (SVG 1.1, section 7.6)."""

from __future__ import annotations

import math
import re

import numpy as np

from ...geometry.arrays import FloatArray
from ..limits import invalid

CALL = re.compile(r"[\s,]*([A-Za-z]+)\s*\(([^)]*)\)[\s,]*")
NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")

VALUE = re.compile(rf"({NUMBER.pattern})(deg|rad|grad|turn|px)?")
DEGREES = {"": 1.0, "px": 1.0, "deg": 1.0, "rad": 180.0 / math.pi, "grad": 0.9, "turn": 360.0}
"""Units of angles and lengths, in style sheets only."""

MAX_TRANSFORM_SHOWN = 60
"""Maximum length of a transform in a message."""


def read_transform(text: str) -> FloatArray:
    """The product of a list of transforms; the identity for an empty one. Raises NestedCagesError."""
    product = np.eye(3)
    place = 0
    text = text.rstrip()
    while place < len(text) and text != "none":
        found = CALL.match(text, place)
        values = [float(x) * DEGREES[unit] for x, unit in VALUE.findall(found[2])] if found else []
        whole = found is not None and not VALUE.sub("", found[2]).strip(" ,\t\r\n") and np.isfinite(values).all()
        matrix = _matrix(found[1], values) if found and whole else None
        if found is None or matrix is None:
            raise invalid(
                f"The transform '{text[:MAX_TRANSFORM_SHOWN]}' cannot be read; use matrix, translate, scale, "
                "rotate, skewX and skewY with finite numbers."
            )
        product = product @ matrix
        place = found.end()
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


def _matrix(name: str, values: list[float]) -> FloatArray | None:
    """The matrix of one transform; None if the name or the number of values is wrong."""
    count = len(values)
    if name == "matrix" and count == 6:
        return np.array([values[0::2], values[1::2], [0.0, 0.0, 1.0]])
    if name == "translate" and count in (1, 2):
        return translation(values[0], values[1] if count == 2 else 0.0)
    if name in ("translateX", "translateY") and count == 1:
        return translation(values[0], 0.0) if name[-1] == "X" else translation(0.0, values[0])
    if name in ("scaleX", "scaleY") and count == 1:
        return scaling(values[0], 1.0) if name[-1] == "X" else scaling(1.0, values[0])
    if name == "scale" and count in (1, 2):
        return scaling(values[0], values[-1])
    if name == "rotate" and count in (1, 3):
        about = values[1:] or [0.0, 0.0]
        return translation(*about) @ turned(values[0]) @ translation(-about[0], -about[1])
    if name in ("skewX", "skewY") and count == 1:
        matrix = np.eye(3)
        matrix[(0, 1) if name == "skewX" else (1, 0)] = math.tan(math.radians(values[0]))
        return matrix
    return None
