"""Line cycles: the default start of a level."""

from __future__ import annotations

from .method import LineCycles

__all__ = ["LineCycles"]
