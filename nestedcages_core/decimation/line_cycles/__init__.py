"""Line cycles: the default start of a level."""

from __future__ import annotations

from .method import LineCycles, inner_cycles

__all__ = ["LineCycles", "inner_cycles"]
