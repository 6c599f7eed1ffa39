"""nested_cages(): decimation, flow, reinflation, tightening and verification, level by level."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..geometry.group import Symmetry
from ..tolerance.within import Within
from .level_text import level_words, listed_levels, parse_level
from .nested_cages import InnerCagesRun, NestedCagesRun, inner_cages, nested_cages
from .progress import Progress
from .report import Hierarchy, Level, NestingReport
from .settings import DEFAULT_CLEARANCE, Settings
from .targets import LEAST, Rising, Share, Wanted, in_order, wanted_levels

if TYPE_CHECKING:
    from .narrow_places import tightest_place as tightest_place

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
    "Wanted",
    "Within",
    "in_order",
    "inner_cages",
    "level_words",
    "listed_levels",
    "nested_cages",
    "parse_level",
    "tightest_place",
    "wanted_levels",
]


def __getattr__(name: str) -> Any:
    """What few runs need is imported when it is asked for."""
    if name == "tightest_place":
        from .narrow_places import tightest_place

        return tightest_place
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
