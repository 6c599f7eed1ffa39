"""Caps in pictures: opaque pixels of a part that stay on its parent where it is jointed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..exchange.layers import PicturePart
from ..exchange.layers.layer import NORMAL
from ..libraries import load_shapely
from ..puppet import Cap
from ..puppet.parts import NEEDED_FOR
from .mesh import Placement


def cap_picture(cap: Cap, part: PicturePart, place: Placement) -> PicturePart | None:
    """What a cap repeats of its part's picture; None if it would show at rest, where both are drawn."""
    corner = np.array([part.left, part.top])
    around = np.maximum(place.down(cap.outline.vertices) - corner, 0.0)
    (left, top), (right, bottom) = around.min(axis=0).astype(int), np.ceil(around.max(axis=0)).astype(int)
    pixels = part.seen[top:bottom, left:right]
    corner += (left, top)
    rows, columns = np.nonzero(pixels[..., 3] == 255)
    centres = place.up(np.column_stack([columns, rows]) + corner + 0.5)
    shapely = load_shapely(NEEDED_FOR)
    inside = shapely.contains_xy(shapely.geometry.shape(cap.outline.__geo_interface__), *centres.T)
    if part.blend != NORMAL or not inside.any():
        return None
    kept = np.zeros_like(pixels)
    kept[rows[inside], columns[inside]] = pixels[rows[inside], columns[inside]]
    return replace(part, left=int(corner[0]), top=int(corner[1]), pixels=kept, opacity=1.0)
