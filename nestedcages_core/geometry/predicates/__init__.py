"""Certified predicates on plain arrays: every answer is exact for the doubles that come in, however degenerate."""

from .orientation import Signs, as_integers, crossing_pairs, orientation, orientation_sign, segments_intersect
from .winding import (
    ON_BOUNDARY,
    loop_windings,
    winding_number,
)

__all__ = [
    "ON_BOUNDARY",
    "Signs",
    "as_integers",
    "crossing_pairs",
    "loop_windings",
    "orientation",
    "orientation_sign",
    "segments_intersect",
    "winding_number",
]
