"""PSD and PSB, by psd-tools: 8, 16 or 32 bits, in grey, RGB or CMYK."""

from __future__ import annotations

import io
import warnings
from typing import Any

import numpy as np

from ...errors import invalid_file
from ...formats.limits import Limits, Quota
from ...formats.pictures.png import Pixels
from ...geometry.arrays import FloatArray
from ...libraries import needed
from .layer import NORMAL, PASS_THROUGH, Layer, LayeredPicture, LayerMask, Notes, Opacities, check_depth

SIGNATURE = b"8BPS"

GREY, CMYK = ("GRAYSCALE", "DUOTONE"), "CMYK"
MODES, DEPTHS = (*GREY, "RGB", CMYK), (8, 16, 32)
"""Colour modes that are read, duotones as grey, and bits of a channel."""

BLENDS = {
    "norm": NORMAL,
    "pass": PASS_THROUGH,
    "mul ": "multiply",
    "scrn": "screen",
    "lddg": "add",
    "over": "overlay",
    "dark": "darken",
    "lite": "lighten",
    "sLit": "soft light",
    "hLit": "hard light",
    "diff": "difference",
    "div ": "colour dodge",
    "idiv": "colour burn",
}
"""Names of blend modes; others keep their keys."""

ENCODINGS = "utf-8", "cp932"
"""Of names without Unicode, which programs wrote in the encoding of their system, besides Mac Roman."""

SRGB_LINEAR, SRGB_SLOPE, SRGB_POWER, SRGB_OFFSET = 0.0031308, 12.92, 2.4, 0.055
"""The curve of sRGB (IEC 61966-2-1); colours of 32 bits are linear."""


def read_psd(data: bytes, limits: Limits) -> LayeredPicture:
    """The layers of a PSD or PSB. Raises NestedCagesError, also where psd-tools is missing."""
    with needed("psd-tools", "Reading PSD"):
        import psd_tools
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        document = psd_tools.PSDImage.open(io.BytesIO(data))
        document.compatibility_mode = psd_tools.constants.CompatibilityMode.CLIP_STUDIO_PAINT  # groups clip, too
        mode = document.color_mode.name
        if mode not in MODES or document.depth not in DEPTHS:
            raise invalid_file(
                f"Colour mode {mode} with {document.depth} bits is not read. Convert it to 8 bits in RGB."
            )
        notes = Notes()
        layers = _layers(document, document, Quota(limits), notes)
    return LayeredPicture(document.width, document.height, layers, notes.sentences)


def _layers(group: Any, document: Any, quota: Quota, notes: Notes, depth: int = 0) -> tuple[Layer, ...]:
    check_depth(depth)
    return tuple(_layer(each, document, quota, notes, depth) for each in group)


def _layer(layer: Any, document: Any, quota: Quota, notes: Notes, depth: int) -> Layer:
    quota.spend("elements", 1)
    blend = layer.blend_mode.value.decode("latin-1")
    name = _name(layer)
    children = _layers(layer, document, quota, notes, depth + 1) if layer.is_group() else None
    if children is None:
        if layer.has_effects():
            notes.add("Effects of layers, such as shadows and outlines, are left out: {}.", name)
        if layer.has_vector_mask() and not (layer.mask is not None and layer.mask.has_real()):
            notes.add("Vector masks are left out: {}.", name)
    return Layer(
        name,
        0 if children is not None else layer.left,
        0 if children is not None else layer.top,
        None if children is not None else _pixels(layer, document, quota),
        is_visible=layer.visible,
        opacity=(layer.opacity / 255) * (layer.fill_opacity / 255),
        blend=BLENDS.get(blend, blend.strip()),
        is_clipped=layer.clipping,
        masks=_masks(layer, quota),
        children=children,
    )


def _name(layer: Any) -> str:
    """A name; one that was written without Unicode in UTF-8 or Shift-JIS where all of it is that, else in Mac Roman."""
    from psd_tools.constants import Tag

    name: str = layer.name
    if Tag.UNICODE_LAYER_NAME in layer.tagged_blocks:
        return name.rstrip("\0")
    data = name.encode("macroman", errors="replace")
    for encoding in ENCODINGS:
        try:
            found = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        if encoding == "utf-8" or all(ord(letter) > 0x2FFF or not letter.isalpha() for letter in found):
            return found
    return name


def _pixels(layer: Any, document: Any, quota: Quota) -> Pixels | None:
    """(h, w, 4) colours and alpha; opaque where there is none."""
    if not layer.has_pixels() or not layer.width or not layer.height:
        return None
    quota.spend("pixels", layer.width * layer.height)
    colour, alpha = layer.numpy("color"), layer.numpy("shape")
    if colour is None:
        return None
    if document.color_mode.name == CMYK:  # stored inverted: 1 is no ink
        colour = colour[..., :3] * colour[..., 3:]
    elif document.color_mode.name in GREY:
        colour = colour[..., :1]
    out: Pixels = np.full((layer.height, layer.width, 4), 255, np.uint8)
    out[..., :3] = _bytes(_curved(colour) if document.depth == 32 else colour)
    if alpha is not None:
        out[..., 3] = _bytes(alpha[..., 0])
    return out


def _masks(layer: Any, quota: Quota) -> tuple[LayerMask, ...]:
    """The mask of a layer, together with its vector mask where the file has both as one."""
    mask = layer.mask
    if mask is None or mask.disabled:
        return ()
    quota.spend("pixels", max(mask.width, 0) * max(mask.height, 0))
    values = layer.numpy("mask") if mask.width > 0 < mask.height else None
    opacities = np.zeros((0, 0), np.uint8) if values is None else _bytes(values[..., 0])
    density = mask.parameters.user_mask_density if mask.parameters is not None else None
    found = LayerMask(mask.left, mask.top, opacities, mask.background_color)
    return (found if density is None else found.thinned(density),)


def _bytes(values: FloatArray) -> Opacities:
    """Values from 0 to 1 as bytes."""
    return np.asarray(np.round(255.0 * np.clip(np.nan_to_num(values), 0.0, 1.0)), np.uint8)


def _curved(light: FloatArray) -> FloatArray:
    """Linear light as values of sRGB."""
    light = np.clip(np.nan_to_num(light), 0.0, 1.0)
    curved = (1.0 + SRGB_OFFSET) * light ** (1.0 / SRGB_POWER) - SRGB_OFFSET
    return np.where(light <= SRGB_LINEAR, SRGB_SLOPE * light, curved)
