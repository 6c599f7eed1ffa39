"""Cages that follow a moving drawing: one topology, certified at every pose and at every instant between."""

from __future__ import annotations

from .animated import AnimatedCagesRun, animated_cages, stream_cages
from .results import Key, MotionReport, MovingCages, MovingLevel
from .stepping import followed

__all__ = [
    "AnimatedCagesRun",
    "Key",
    "MotionReport",
    "MovingCages",
    "MovingLevel",
    "animated_cages",
    "followed",
    "stream_cages",
]
