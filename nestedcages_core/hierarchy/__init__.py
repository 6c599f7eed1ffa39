"""nested_cages(): decimation, flow, reinflation, tightening and verification, level by level."""

from __future__ import annotations

from .clearance_bounds import tightest_place
from .results import Hierarchy, Level, NestingReport, Progress
from .run import InnerCagesRun, NestedCagesRun, inner_cages, nested_cages
from .settings import Settings
from .tolerance import Within

__all__ = [
    "Hierarchy",
    "InnerCagesRun",
    "Level",
    "NestedCagesRun",
    "NestingReport",
    "Progress",
    "Settings",
    "Within",
    "inner_cages",
    "nested_cages",
    "tightest_place",
]
