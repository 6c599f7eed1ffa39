"""Pictures in: PNG files, the boundary of what is opaque in them, and collision outlines."""

from .collision import (
    HALF,
    alpha_channel,
    boundaries_of_picture,
    boundary_of_pixels,
    collision_outline,
    corresponding,
    picture_cages,
)
from .png import decode_png, encode_png, read_png

__all__ = [
    "HALF",
    "alpha_channel",
    "boundaries_of_picture",
    "boundary_of_pixels",
    "collision_outline",
    "corresponding",
    "decode_png",
    "encode_png",
    "picture_cages",
    "read_png",
]
