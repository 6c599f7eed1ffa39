"""nested_cages(): decimation, flow, reinflation, tightening and verification, level by level."""

from __future__ import annotations

from ..geometry.symmetry import Mirror, Rotation, Symmetry
from ..geometry.symmetry_search import Found
from .clearance_bounds import tightest_place
from .levels import Share, level_words, parse_level, wanted_levels
from .results import Hierarchy, Level, NestingReport, Progress
from .run import InnerCagesRun, NestedCagesRun, inner_cages, nested_cages
from .settings import Settings
from .tolerance import Within

__all__ = [
    "Found",
    "Hierarchy",
    "InnerCagesRun",
    "Level",
    "Mirror",
    "NestedCagesRun",
    "NestingReport",
    "Progress",
    "Rotation",
    "Settings",
    "Share",
    "Symmetry",
    "Within",
    "inner_cages",
    "level_words",
    "nested_cages",
    "parse_level",
    "tightest_place",
    "wanted_levels",
]
