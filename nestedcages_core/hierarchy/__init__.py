"""nested_cages(): decimation, flow, reinflation, tightening and verification, level by level."""

from __future__ import annotations

from .clearance_bounds import least_room
from .results import Hierarchy, Level, NestingReport, Progress
from .run import NestedCagesRun, nested_cages
from .settings import Settings

__all__ = [
    "Hierarchy",
    "Level",
    "NestedCagesRun",
    "NestingReport",
    "Progress",
    "Settings",
    "least_room",
    "nested_cages",
]
