"""Layered pictures in: PSD, OpenRaster, Krita and folders of PNG pictures, as layers and as painted parts."""

from .layer import LAYERED_LIMITS, Layer, LayeredPicture, LayerMask
from .parts import PicturePart, parts_of
from .reading import ENDINGS, layers_of, read_layers

__all__ = [
    "ENDINGS",
    "LAYERED_LIMITS",
    "Layer",
    "LayerMask",
    "LayeredPicture",
    "PicturePart",
    "layers_of",
    "parts_of",
    "read_layers",
]
