"""nested_cages(): decimation, flow, reinflation, tightening and verification, level by level."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..libraries import imported_later
from ..tolerance.within import Within
from .nested_cages import inner_cages, listed_levels, nested_cages
from .progress import Progress
from .report import Hierarchy, Level, NestingReport
from .settings import DEFAULT_CLEARANCE, Settings
from .targets import Rising, Share, Wanted, in_order, wanted_levels

if TYPE_CHECKING:
    from .level_text import level_words as level_words
    from .level_text import parse_level as parse_level
    from .narrow_places import tightest_place as tightest_place
    from .runs import InnerCagesRun as InnerCagesRun
    from .runs import NestedCagesRun as NestedCagesRun

__all__ = [
    "DEFAULT_CLEARANCE",
    "Hierarchy",
    "Level",
    "NestingReport",
    "Progress",
    "Rising",
    "Settings",
    "Share",
    "Wanted",
    "Within",
    "in_order",
    "inner_cages",
    "listed_levels",
    "nested_cages",
    "wanted_levels",
]

if not TYPE_CHECKING:  # what few runs need is imported when it is asked for
    __getattr__ = imported_later(
        __name__,
        {
            "level_text": "level_words parse_level",
            "narrow_places": "tightest_place",
            "runs": "InnerCagesRun NestedCagesRun",
        },
    )
