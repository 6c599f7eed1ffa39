"""Caps in pictures: opaque pixels of a part that stay on its parent where it is jointed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..geometry.arrays import FloatArray, IntArray
from ..layers import PicturePart
from ..layers.layer import NORMAL
from ..libraries import load_shapely
from ..puppet import Cap, PuppetPart
from ..puppet.parts import NEEDED_FOR
from .mesh import Placement

PAINT = 4
"""Bits of each colour that tell ink from what it encloses."""


def cap_picture(cap: Cap, drawn: PuppetPart, part: PicturePart, place: Placement) -> PicturePart | None:
    """What a cap repeats of its part's picture, with its ink; None if it would show at rest, where both are drawn."""
    corner = np.array([part.left, part.top])
    around = np.maximum(place.down(cap.outline.vertices) - corner, 0.0)
    (left, top), (right, bottom) = around.min(axis=0).astype(int), np.ceil(around.max(axis=0)).astype(int)
    pixels = part.seen[top:bottom, left:right]
    corner += (left, top)
    rows, columns = np.nonzero(pixels[..., 3] == 255)
    centres = place.up(np.column_stack([columns, rows]) + corner + 0.5)
    shapely = load_shapely(NEEDED_FOR)
    inside = shapely.contains_xy(cap.solid, *centres.T)
    if part.blend != NORMAL or not inside.any():
        return None
    kept = np.zeros_like(pixels)
    kept[rows[inside], columns[inside]] = pixels[rows[inside], columns[inside]]
    height, width = part.seen.shape[:2]

    def paints_at(places: FloatArray) -> IntArray:
        column, row = np.floor(place.down(places) - (part.left, part.top)).astype(int).T
        there = (row >= 0) & (row < height) & (column >= 0) & (column < width)
        return np.where(there, _paints_of(part.seen[row * there, column * there]), -1)

    ink = cap.ink(drawn, paints_at)
    if ink is not None:
        line = inside & shapely.contains_xy(ink.area, *centres.T)
        kept[rows[line], columns[line]] = np.median(part.seen[_paints_of(part.seen) == ink.paint], axis=0).astype(
            np.uint8
        )
    return replace(part, left=int(corner[0]), top=int(corner[1]), pixels=kept, opacity=1.0)


def _paints_of(pixels: NDArray[np.uint8]) -> IntArray:
    """Numbers (…) of colours that are about the same, -1 where pixels (…, 4) are not opaque."""
    red, green, blue = (pixels[..., channel].astype(np.int64) >> 8 - PAINT for channel in range(3))
    return np.where(pixels[..., 3] == 255, (red << 2 * PAINT) + (green << PAINT) + blue, -1)
