"""What stops a symmetric decimation."""

from __future__ import annotations

from ..errors import NestingError

SYMMETRY_TOLERANCE = 1e-3
"""Distance between a vertex and the image of its partner, in diameters, up to which they count as symmetric. Offsets in
narrow gaps, where rounding decides what touches, may differ by their whole length."""


class AsymmetricError(NestingError):
    """An outline that is not symmetric."""
