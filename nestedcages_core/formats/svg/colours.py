"""Colours of CSS (Color 4 and what browsers have of Color 5) as sRGB."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ...geometry.arrays import FloatArray
from ...libraries import needed

with needed("tinycss2", "Reading SVG"):
    import tinycss2.color4

LUMINANCE = (0.2125, 0.7154, 0.0721)
"""Weights of red, green and blue (SVG 1.1, section 14.4)."""

CURRENT = "currentcolor"

LIGHT_SYSTEM = frozenset(("canvas", "field", "buttonface", "highlighttext", "selecteditemtext", "accentcolortext"))
DARK_SYSTEM = frozenset(
    ("canvastext", "linktext", "visitedtext", "activetext", "buttontext", "buttonborder", "fieldtext", "highlight",
     "selecteditem", "mark", "marktext", "graytext", "accentcolor")
)  # fmt: skip
"""Colours that the program chooses: dark on light."""

# Rows of matrices, of CSS Color 4, section 18
XYZ_TO_RGB = ((3.24097, -1.537383, -0.498611), (-0.969244, 1.875968, 0.041555), (0.05563, -0.203977, 1.056972))
D50_TO_D65 = ((0.955473, -0.023099, 0.063259), (-0.02837, 1.009996, 0.021042), (0.012314, -0.020508, 1.330366))
TO_XYZ = {
    "display-p3": ((0.486571, 0.265668, 0.198217), (0.228975, 0.691739, 0.079287), (0.0, 0.045113, 1.043944)),
    "a98-rgb": ((0.576669, 0.185558, 0.188229), (0.297345, 0.627364, 0.075291), (0.027031, 0.070689, 0.991338)),
    "rec2020": ((0.636958, 0.144617, 0.168881), (0.2627, 0.677998, 0.059302), (0.0, 0.028073, 1.060985)),
    "prophoto-rgb": ((0.797761, 0.135186, 0.031349), (0.288071, 0.711843, 0.000086), (0.0, 0.0, 0.825105)),
}
GAMMA = {"a98-rgb": 563.0 / 256.0, "rec2020": 2.4, "prophoto-rgb": 1.8}
D50_SPACES = ("lab", "lch", "prophoto-rgb", "xyz-d50")

ALPHA = re.compile(r"/\s*([\d.]+)(%?)\s*\)\s*$")
SHARE = re.compile(r"(?:^|\s)([\d.]+)%(?=\s|$)")
MAX_DEPTH = 8
"""Maximum nesting depth of colours made of others."""


@dataclass(frozen=True)
class Colour:
    """Opacity, luminance and sRGB of a colour, from 0 to 1."""

    alpha: float = 1.0
    luminance: float = 0.0
    rgb: tuple[float, float, float] = (0.0, 0.0, 0.0)


BLACK = Colour()


def colour_from(rgb: Sequence[float] | FloatArray, alpha: float = 1.0) -> Colour:
    """A colour of any numbers, out of range or none."""
    red, green, blue = (float(part) for part in np.clip(np.nan_to_num(np.asarray(rgb, dtype=np.float64)), 0.0, 1.0))
    light = sum(weight * part for weight, part in zip(LUMINANCE, (red, green, blue), strict=True))
    return Colour(float(np.clip(np.nan_to_num(alpha), 0.0, 1.0)), light, (red, green, blue))


@lru_cache(maxsize=4096)
def parsed_colour(text: str, depth: int = 0) -> Colour | str | None:
    """A colour, or `CURRENT`; None for text that is none.

    Mixed colours are mixed in sRGB, and those relative to others have the others' hue.
    """
    text = text.strip()
    lower = text.lower()
    if lower == CURRENT:
        return CURRENT
    if lower in LIGHT_SYSTEM | DARK_SYSTEM:
        return colour_from((float(lower in LIGHT_SYSTEM),) * 3)
    name, bracket, rest = lower.partition("(")
    if bracket and depth < MAX_DEPTH and lower.endswith(")"):
        if name == "color-mix":
            return _mixed(_arguments(rest[:-1]), depth)
        if name == "light-dark":
            light = _arguments(rest[:-1])
            return parsed_colour(light[0], depth + 1) if len(light) == 2 else None
        if rest.lstrip().startswith("from "):
            return _relative(rest.lstrip()[5:], depth)
    try:
        found = tinycss2.color4.parse_color(text)
    except (ValueError, OverflowError, RecursionError):
        return None
    if found is None or isinstance(found, str):
        return None
    return colour_from(_srgb(found), found.alpha or 0.0)


def _srgb(colour: tinycss2.color4.Color) -> FloatArray:
    """Gamma-encoded sRGB."""
    space, given = colour.space, np.array([part or 0.0 for part in colour.coordinates])
    if space in ("srgb", "hsl", "hwb"):
        return np.array(colour.to("srgb").coordinates)
    if space == "srgb-linear":
        linear = given
    else:
        if space in TO_XYZ:
            xyz = TO_XYZ[space] @ (
                np.sign(given) * np.abs(given) ** GAMMA[space] if space in GAMMA else _decoded(given)
            )
        else:
            xyz = np.array(colour.to("xyz-d50" if space in D50_SPACES else "xyz-d65").coordinates)
        linear = np.asarray(XYZ_TO_RGB) @ (np.asarray(D50_TO_D65) @ xyz if space in D50_SPACES else xyz)
    size = np.abs(linear)
    return np.asarray(np.sign(linear) * np.where(size > 0.0031308, 1.055 * size ** (1.0 / 2.4) - 0.055, 12.92 * size))


def _decoded(given: FloatArray) -> FloatArray:
    size = np.abs(given)
    return np.asarray(np.sign(given) * np.where(size > 0.04045, ((size + 0.055) / 1.055) ** 2.4, size / 12.92))


def _arguments(text: str) -> list[str]:
    """What commas outside of parentheses separate."""
    found, depth = [""], 0
    for letter in text:
        depth += (letter == "(") - (letter == ")")
        if letter == "," and depth == 0:
            found.append("")
        else:
            found[-1] += letter
    return [part.strip() for part in found]


def _mixed(parts: list[str], depth: int) -> Colour | str | None:
    """Of `in space, colour share, colour share`."""
    if len(parts) != 3 or not parts[0].startswith("in "):
        return None
    shares = [SHARE.search(part) for part in parts[1:]]
    colours = [parsed_colour(SHARE.sub(" ", part), depth + 1) for part in parts[1:]]
    if None in colours:
        return None
    one, other = (Colour() if isinstance(colour, str) or colour is None else colour for colour in colours)
    first, second = (float(share[1]) / 100.0 if share else None for share in shares)
    first = first if first is not None else (1.0 - second if second is not None else 0.5)
    second = second if second is not None else 1.0 - first
    total = first + second
    if not total > 0.0 or min(first, second) < 0.0:
        return None
    alphas = np.array((first * one.alpha, second * other.alpha)) / total
    alpha = float(alphas.sum())
    rgb = alphas @ (one.rgb, other.rgb) / alpha if alpha > 0.0 else one.rgb
    return colour_from(rgb, alpha * min(total, 1.0))


def _relative(rest: str, depth: int) -> Colour | str | None:
    """Of `colour channels / alpha)`: the colour, with the alpha that is given as a number."""
    opened, end = 0, len(rest)
    for place, letter in enumerate(rest):
        opened += (letter == "(") - (letter == ")")
        if opened == 0 and (letter == ")" or (letter == " " and not rest[place:].lstrip().startswith("("))):
            end = place + (letter == ")")
            break
    colour = parsed_colour(rest[:end], depth + 1)
    alpha = ALPHA.search(rest)
    if not isinstance(colour, Colour) or alpha is None:
        return colour
    return replace(colour, alpha=min(float(alpha[1]) / (100.0 if alpha[2] else 1.0), 1.0))
