"""Pictures in: PNG files, the boundary of what is opaque in them, and collision outlines."""

from __future__ import annotations

from .boundary import boundary_of_pixels
from .collision import alpha_channel, collision_outline, picture_cages, picture_cages_run
from .png import decode_png, read_png
from .sequence import corresponding

__all__ = [
    "alpha_channel",
    "boundary_of_pixels",
    "collision_outline",
    "corresponding",
    "decode_png",
    "picture_cages",
    "picture_cages_run",
    "read_png",
]
