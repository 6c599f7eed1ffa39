"""nested_cages(): decimation, flow, reinflation, tightening and verification, level by level."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..geometry.group import Symmetry
from ..level.report import Hierarchy, Level, NestingReport, Progress
from ..level.settings import DEFAULT_CLEARANCE
from ..tolerance.within import Within
from .asked import Wanted, in_order, listed_levels
from .levels import LEAST, Rising, Share, wanted_levels
from .run import InnerCagesRun, NestedCagesRun, inner_cages, nested_cages
from .settings import Settings

if TYPE_CHECKING:
    from ..level.tightest_place import tightest_place as tightest_place
    from .level_text import level_words as level_words
    from .level_text import parse_level as parse_level

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
        from ..level.tightest_place import tightest_place

        return tightest_place
    if name not in {"level_words", "parse_level"}:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import level_text

    return getattr(level_text, name)
