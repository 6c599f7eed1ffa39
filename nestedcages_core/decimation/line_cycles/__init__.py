"""Line cycles: the default start of a level."""

from __future__ import annotations

from .method import InnerCycles, LineCycles

__all__ = ["InnerCycles", "LineCycles"]
