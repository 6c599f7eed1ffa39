"""nested_cages(): decimation, flow, reinflation, tightening and verification, level by level."""

from __future__ import annotations

from .results import Hierarchy, Level, NestingReport, Progress
from .run import NestedCagesRun, nested_cages
from .settings import Settings

__all__ = ["Hierarchy", "Level", "NestedCagesRun", "NestingReport", "Progress", "Settings", "nested_cages"]
