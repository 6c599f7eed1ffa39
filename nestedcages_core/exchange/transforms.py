"""Transforms of SVG as matrices (3, 3) (SVG 1.1, section 7.6)."""

from __future__ import annotations

import math
import re

import numpy as np

from ..errors import NestedCagesError
from ..geometry.arrays import FloatArray

CALL = re.compile(r"[\s,]*([A-Za-z]+)\s*\(([^)]*)\)[\s,]*")
NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")


def read_transform(text: str) -> FloatArray:
    """The product of a list of transforms; the identity for an empty one. Raises NestedCagesError."""
    product = np.eye(3)
    place = 0
    while place < len(text.rstrip()):
        found = CALL.match(text, place)
        matrix = _matrix(found[1], [float(x) for x in NUMBER.findall(found[2])]) if found else None
        if found is None or matrix is None:
            raise NestedCagesError(
                f"The transform '{text}' cannot be read; use matrix, translate, scale, rotate, skewX and skewY."
            )
        product = product @ matrix
        place = found.end()
    return product


def translation(x: float, y: float) -> FloatArray:
    return np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]])


def scaling(x: float, y: float) -> FloatArray:
    return np.diag([x, y, 1.0])


def moved(points: FloatArray, matrix: FloatArray) -> FloatArray:
    """Points (..., 2) under a matrix."""
    with np.errstate(all="ignore"):  # coordinates are judged where they are used
        return np.asarray(points @ matrix[:2, :2].T + matrix[:2, 2])


def _matrix(name: str, values: list[float]) -> FloatArray | None:
    """The matrix of one transform; None where name or number of values are wrong."""
    count = len(values)
    if name == "matrix" and count == 6:
        return np.array([values[0::2], values[1::2], [0.0, 0.0, 1.0]])
    if name == "translate" and count in (1, 2):
        return translation(values[0], values[1] if count == 2 else 0.0)
    if name == "scale" and count in (1, 2):
        return scaling(values[0], values[-1])
    if name == "rotate" and count in (1, 3):
        turn = math.radians(values[0])
        matrix = np.eye(3)
        matrix[:2, :2] = [[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]
        about = values[1:] or [0.0, 0.0]
        return translation(*about) @ matrix @ translation(-about[0], -about[1])
    if name in ("skewX", "skewY") and count == 1:
        matrix = np.eye(3)
        matrix[(0, 1) if name == "skewX" else (1, 0)] = math.tan(math.radians(values[0]))
        return matrix
    return None
