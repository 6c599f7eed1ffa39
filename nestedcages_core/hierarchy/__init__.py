"""nested_cages(): decimation, flow, reinflation, tightening and verification, level by level."""

from __future__ import annotations

from ..geometry.group import Symmetry
from ..level.choices import DEFAULT_CLEARANCE
from ..level.report import Hierarchy, Level, NestingReport, Progress
from ..level.tightest_place import tightest_place
from ..tolerance.within import Within
from .levels import LEAST, Rising, Share, level_words, order_of, parse_level, wanted_levels
from .run import InnerCagesRun, NestedCagesRun, inner_cages, nested_cages
from .settings import Settings

__all__ = [
    "DEFAULT_CLEARANCE",
    "LEAST",
    "Hierarchy",
    "InnerCagesRun",
    "Level",
    "NestedCagesRun",
    "NestingReport",
    "Progress",
    "Rising",
    "Settings",
    "Share",
    "Symmetry",
    "Within",
    "inner_cages",
    "level_words",
    "nested_cages",
    "order_of",
    "parse_level",
    "tightest_place",
    "wanted_levels",
]
