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
    pixels = part.seen
    rows, columns = np.nonzero(pixels[..., 3] == 255)
    centres = place.up(np.column_stack([columns, rows]) + np.array([part.left + 0.5, part.top + 0.5]))
    shapely = load_shapely(NEEDED_FOR)
    inside = shapely.contains_xy(shapely.geometry.shape(cap.outline.__geo_interface__), *centres.T)
    if part.blend != NORMAL or not inside.any():
        return None
    kept = np.zeros_like(pixels)
    kept[rows[inside], columns[inside]] = pixels[rows[inside], columns[inside]]
    return replace(part, pixels=kept, opacity=1.0)
