"""Layered SVG as painted parts: each shape filled with its colours, smooth at its edges."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import Any

import numpy as np

from ...errors import invalid_setting
from ...formats import SvgPart, svg_parts
from ...formats.pictures.png import Pixels
from ...formats.svg.gradients import Shades, shaded
from ...geometry.arrays import FloatArray
from ...geometry.mesh import Mesh
from .grouping import without_aids
from .layer import Notes
from .painting import PicturePart

ROWS_PER_PIXEL = 8
"""Scan lines per row of pixels; along them coverage is exact."""

LEAST_GROUPS = 3
"""From as many groups on, a group of shapes is a part; with fewer, each shape is."""

FAINTEST = 1e-9
"""Opacity below which a colour means nothing."""

LONGER_SIDE = 1024
"""Pixels of the longer side of a drawing, by default."""

Paint = tuple[Mesh, "tuple[float, ...] | Shades"]
"""An area, y pointing down, and its red, green, blue and opacity from 0 to 1, or these by their places."""


def parts_of_svg(
    text: str | bytes, pixels: int = LONGER_SIDE, **options: Any
) -> tuple[tuple[PicturePart, ...], tuple[int, int], tuple[str, ...]]:
    """The parts of a document, the lowest first, the size of their canvas, which holds them, and notes.

    A part is a group, or a shape where few are grouped.

    pixels: of the longer side; options: fields of `SvgOptions`. Raises NestedCagesError.
    """
    if pixels < 1:
        raise invalid_setting(f"A picture has at least one pixel, not {pixels}.")
    shapes, notes = svg_parts(text, **options)
    corners = np.concatenate([mesh.vertices for shape in shapes for mesh in (shape.fill, shape.stroke) if mesh])
    low, high = corners.min(axis=0), corners.max(axis=0)
    scale = pixels / float((high - low).max())
    width, height = np.maximum(np.ceil((high - low) * scale).astype(int), 1).tolist()
    drawn = (picture_of(s.name, s.groups, _paints_of(s), low, scale) for s in shapes)
    said = Notes()
    found = without_aids([part for part in drawn if part is not None], said)
    if len({part.groups for part in found if part.groups}) >= LEAST_GROUPS:
        found = [painted_as_one(list(own)) for _, own in groupby(found, key=lambda part: part.groups or part.name)]
    return tuple(found), (width, height), (*notes, *said.sentences)


def painted_as_one(parts: Sequence[PicturePart]) -> PicturePart:
    """The parts of one group as one part, the lowest first."""
    if not parts[0].groups:
        return parts[0]
    left, top = min(part.left for part in parts), min(part.top for part in parts)
    right = max(part.left + part.pixels.shape[1] for part in parts)
    bottom = max(part.top + part.pixels.shape[0] for part in parts)
    light, alpha = np.zeros((bottom - top, right - left, 3)), np.zeros((bottom - top, right - left))
    for part in parts:
        h, w = part.pixels.shape[:2]
        box = np.s_[part.top - top : part.top - top + h, part.left - left : part.left - left + w]
        own = part.pixels[..., 3] / 255.0
        light[box] = light[box] * (1.0 - own[..., None]) + own[..., None] * part.pixels[..., :3] / 255.0
        alpha[box] = alpha[box] * (1.0 - own) + own
    *above, name = parts[0].groups
    return PicturePart(name, tuple(above), left, top, _as_bytes(light, alpha))


def _as_bytes(light: FloatArray, alpha: FloatArray) -> Pixels:
    """(h, w, 4) pixels of colours (h, w, 3) times their opacities (h, w)."""
    out: Pixels = np.zeros((*alpha.shape, 4), np.uint8)
    out[..., 3] = np.round(255.0 * np.minimum(alpha, 1.0))
    out[..., :3] = np.round(255.0 * np.clip(light / np.maximum(alpha, FAINTEST)[..., None], 0.0, 1.0))
    return out


def picture_of(
    name: str, groups: tuple[str, ...], paints: Sequence[Paint], low: FloatArray, scale: float
) -> PicturePart | None:
    """The picture of a shape; None if it covers no pixel.

    paints: areas that share borders at most; low: (2,) the upper left corner of the canvas; scale: pixels per unit.
    """
    placed = [(_in_pixels(mesh, low, scale), colours) for mesh, colours in paints]
    corners = np.concatenate([np.concatenate(rings) for rings, _ in placed])
    left, top = np.floor(corners.min(axis=0)).astype(int).tolist()
    right, bottom = np.ceil(corners.max(axis=0)).astype(int).tolist()
    size = (max(bottom - top, 1), max(right - left, 1))
    light, alpha = np.zeros((*size, 3)), np.zeros(size)
    corner, other = np.array([left, top]), np.array([left + size[1], top + size[0]])
    for rings, colours in placed:  # coverages add up
        ends = corner / scale + low, other / scale + low
        shades = np.array(colours) if isinstance(colours, tuple) else shaded(colours, *ends, size)
        covered = shades[..., 3] * coverage([ring - corner for ring in rings], size)
        light += covered[..., None] * shades[..., :3]
        alpha += covered
    out = _as_bytes(light, alpha)
    return PicturePart(name, groups, left, top, out) if out[..., 3].any() else None


def _paints_of(shape: SvgPart) -> list[Paint]:
    fill, stroke = shape.fill_gradient or shape.fill_colour, shape.stroke_gradient or shape.stroke_colour
    return [(mesh, colours) for mesh, colours in ((shape.fill, fill), (shape.stroke, stroke)) if mesh is not None]


def _in_pixels(mesh: Mesh, low: FloatArray, scale: float) -> list[FloatArray]:
    return [np.asarray((ring - low) * scale) for ring in mesh.rings]


def coverage(rings: list[FloatArray], size: tuple[int, int]) -> FloatArray:
    """(h, w) how much of each pixel rings (k, 2) fill, by the even-odd rule, y pointing down."""
    height, width = size
    out = np.zeros((height, width + 1))
    start = np.concatenate(rings)
    end = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    for line in range(height * ROWS_PER_PIXEL):
        y = (line + 0.5) / ROWS_PER_PIXEL
        crossed = (start[:, 1] <= y) != (end[:, 1] <= y)
        a, b = start[crossed], end[crossed]
        x = np.sort(a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]))
        x = np.clip(x, 0.0, width)
        column = np.minimum(x.astype(int), width - 1)
        # everything right of a crossing is filled or emptied: in its own pixel by the rest of it, later ones whole
        sign = np.where(np.arange(len(x)) % 2, -1.0, 1.0)
        rest = column + 1.0 - x
        np.add.at(out[line // ROWS_PER_PIXEL], column, sign * rest)
        np.add.at(out[line // ROWS_PER_PIXEL], column + 1, sign * (1.0 - rest))
    return np.asarray(np.clip(np.cumsum(out[:, :-1], axis=1) / ROWS_PER_PIXEL, 0.0, 1.0))
