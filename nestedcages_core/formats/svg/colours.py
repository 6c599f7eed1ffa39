"""Colours of CSS (Color 4) as sRGB."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...geometry.arrays import FloatArray
from ...libraries import needed

with needed("tinycss2", "Reading SVG"):
    import tinycss2.color4

LUMINANCE = np.array((0.2125, 0.7154, 0.0721))
"""Weights of red, green and blue (SVG 1.1, section 14.4)."""

CURRENT = "currentcolor"

XYZ_TO_RGB = {
    "xyz-d65": ((3.24097, -1.537383, -0.498611), (-0.969244, 1.875968, 0.041555), (0.05563, -0.203977, 1.056972)),
    "xyz-d50": ((3.134135, -1.617388, -0.490664), (-0.978796, 1.916257, 0.033444), (0.071955, -0.228977, 1.405387)),
}
"""Matrices to linear sRGB by the white of a space (CSS Color 4, section 18)."""

WHITES = {"xyz": "xyz-d65", "xyz-d65": "xyz-d65", "xyz-d50": "xyz-d50", "lab": "xyz-d50", "lch": "xyz-d50",
          "oklab": "xyz-d65", "oklch": "xyz-d65"}  # fmt: skip
"""Spaces that are not of red, green and blue."""


@dataclass(frozen=True)
class Colour:
    """Opacity and sRGB of a colour, from 0 to 1."""

    alpha: float = 1.0
    rgb: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def luminance(self) -> float:
        return float(LUMINANCE @ self.rgb)


BLACK = Colour()


def colour_from(rgb: Sequence[float] | FloatArray, alpha: float = 1.0) -> Colour:
    """A colour of any numbers, out of range or none."""
    red, green, blue, opacity = np.clip(np.nan_to_num([*rgb, alpha]), 0.0, 1.0).tolist()
    return Colour(opacity, (red, green, blue))


@lru_cache(maxsize=4096)
def parsed_colour(text: str) -> Colour | str | None:
    """A colour, or `CURRENT`; None for text that is none. All spaces of red, green and blue are taken for sRGB."""
    try:
        found = tinycss2.color4.parse_color(text.strip())
    except (ValueError, OverflowError, RecursionError):
        return None
    return found if found is None or isinstance(found, str) else colour_from(_srgb(found), found.alpha)


def _srgb(colour: tinycss2.color4.Color) -> Sequence[float] | FloatArray:
    """Gamma-encoded sRGB, out of range or not."""
    if colour.space in ("hsl", "hwb"):
        return tuple(colour.to("srgb").coordinates)
    given = np.array([part or 0.0 for part in colour.coordinates])
    if colour.space in WHITES:
        white = WHITES[colour.space]
        given = np.asarray(XYZ_TO_RGB[white]) @ colour.to(white).coordinates
    elif colour.space != "srgb-linear":
        return given
    size = np.abs(given)
    return np.asarray(np.sign(given) * np.where(size > 0.0031308, 1.055 * size ** (1.0 / 2.4) - 0.055, 12.92 * size))
