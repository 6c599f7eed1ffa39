"""Cages that follow a moving drawing: constant topology, certified at every pose and every instant in between."""

from __future__ import annotations

from .animated import AnimatedCagesRun, animated_cages, stream_cages
from .results import Key, MotionReport, MovingCages, MovingLevel
from .stepping import followed
from .still import certified_still

__all__ = [
    "AnimatedCagesRun",
    "Key",
    "MotionReport",
    "MovingCages",
    "MovingLevel",
    "animated_cages",
    "certified_still",
    "followed",
    "stream_cages",
]
