"""Colours of CSS (Color 4 and what browsers have of Color 5) as sRGB."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from ...geometry.arrays import FloatArray
from ...libraries import needed

with needed("tinycss2", "Reading SVG"):
    import tinycss2.color4

LUMINANCE = np.array((0.2125, 0.7154, 0.0721))
"""Weights of red, green and blue (SVG 1.1, section 14.4)."""

CURRENT = "currentcolor"

LIGHT_SYSTEM = ("canvas", "field", "buttonface", "highlighttext", "selecteditemtext", "accentcolortext")
DARK_SYSTEM = (
    *("canvastext", "linktext", "visitedtext", "activetext", "buttontext", "buttonborder", "fieldtext", "highlight"),
    *("selecteditem", "mark", "marktext", "graytext", "accentcolor"),
)
"""Colours that the program chooses: dark on light."""

XYZ_TO_RGB = {
    "xyz-d65": ((3.24097, -1.537383, -0.498611), (-0.969244, 1.875968, 0.041555), (0.05563, -0.203977, 1.056972)),
    "xyz-d50": ((3.134135, -1.617388, -0.490664), (-0.978796, 1.916257, 0.033444), (0.071955, -0.228977, 1.405387)),
}
"""Matrices to linear sRGB by the white of a space (CSS Color 4, section 18)."""

WHITES = {"xyz": "xyz-d65", "xyz-d65": "xyz-d65", "xyz-d50": "xyz-d50", "lab": "xyz-d50", "lch": "xyz-d50",
          "oklab": "xyz-d65", "oklch": "xyz-d65"}  # fmt: skip
"""Spaces that are not of red, green and blue."""

MAX_DEPTH = 8
"""Maximum nesting depth of colours made of others."""


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
    """A colour, or `CURRENT`; None for text that is none.

    Mixed colours are mixed in sRGB, those relative to others are the others, and all of red, green and blue are sRGB.
    """
    try:
        return _parsed(tinycss2.parse_one_component_value(text.strip(), skip_comments=True), 0)
    except (ValueError, OverflowError, RecursionError):
        return None


def _parsed(token: Any, depth: int) -> Colour | str | None:
    if token.type == "ident" and token.lower_value in LIGHT_SYSTEM + DARK_SYSTEM:
        return colour_from((float(token.lower_value in LIGHT_SYSTEM),) * 3)
    if token.type == "function" and depth < MAX_DEPTH:
        parts = _parts(token.arguments)
        if token.lower_name == "light-dark":
            return _parsed(parts[0][0], depth + 1) if len(parts) == 2 and parts[0] else None
        if token.lower_name == "color-mix":
            return _mixed(parts, depth)
        if _word(parts[0]) == "from":
            return _relative(parts[0][1:], depth)
    found = tinycss2.color4.parse_color(token)
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


def _parts(tokens: Sequence[Any]) -> list[list[Any]]:
    """What commas separate, without blanks and comments."""
    found: list[list[Any]] = [[]]
    for token in tokens:
        if token == ",":
            found.append([])
        elif token.type not in ("whitespace", "comment"):
            found[-1].append(token)
    return found


def _word(tokens: Sequence[Any]) -> str:
    """The first token, if it is a word; empty if not."""
    return tokens[0].lower_value if tokens and tokens[0].type == "ident" else ""


def _mixed(parts: list[list[Any]], depth: int) -> Colour | None:
    """Of `in space, colour share, colour share`."""
    if len(parts) != 3 or _word(parts[0]) != "in":
        return None
    shares: list[float | None] = []
    colours: list[Colour] = []
    for part in parts[1:]:
        given = [token.value / 100.0 for token in part if token.type == "percentage"]
        found = [_parsed(token, depth + 1) for token in part if token.type != "percentage"]
        if len(found) != 1 or found[0] is None or min(given, default=0.0) < 0.0:
            return None
        shares.append(given[0] if given else None)
        colours.append(BLACK if isinstance(found[0], str) else found[0])
    first, second = shares
    first = first if first is not None else (1.0 - second if second is not None else 0.5)
    second = second if second is not None else 1.0 - first
    total = first + second
    if not total > 0.0:
        return None
    alphas = np.array((first, second)) / total * [colour.alpha for colour in colours]
    alpha = float(alphas.sum())
    rgb = alphas @ [colour.rgb for colour in colours] / alpha if alpha > 0.0 else colours[0].rgb
    return colour_from(rgb, alpha * min(total, 1.0))


def _relative(tokens: list[Any], depth: int) -> Colour | str | None:
    """Of `colour channels / alpha`: the colour, with the alpha that is given as a number."""
    colour = _parsed(tokens[0], depth + 1) if tokens else None
    alpha = tokens[-1] if len(tokens) > 1 and tokens[-2] == "/" else None
    if not isinstance(colour, Colour) or alpha is None or alpha.type not in ("number", "percentage"):
        return colour
    return replace(colour, alpha=min(max(alpha.value / (100.0 if alpha.type == "percentage" else 1.0), 0.0), 1.0))
