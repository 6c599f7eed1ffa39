"""Cages that follow a moving drawing: constant topology, certified at every pose and every instant in between."""

from .animated import AnimatedCagesRun, animated_cages, certified_still, stream_cages
from .following import followed
from .gate import Key
from .results import MotionReport, MovingCages, MovingLevel

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
