"""Which loops the cages of a run keep: all, those worth their vertices, or one."""

from __future__ import annotations

from dataclasses import replace

from ..decimation import Decimation, LineCycles
from ..errors import NestingError
from .settings import Settings


def keeps_loops(settings: Settings, side: int) -> bool:
    """Whether each level keeps all loops, so that it needs three vertices for each.

    Raises NestingError for cages inside with one loop.
    """
    if side < 0 and settings.loops == "one":
        raise NestingError('Inner cages keep all loops; leave out loops="one".', code="setting.conflict")
    return side < 0 or settings.loops == "keep"


def with_loops(settings: Settings) -> Settings:
    """The settings of a level whose cage need not have all loops of the mesh in it."""
    if settings.convex:
        return settings
    from ..decimation.starts import AlongSequence

    def along(method: Decimation) -> Decimation:
        return AlongSequence(method, settings.loops == "one") if isinstance(method, LineCycles) else method

    fallback = None if settings.fallback is None else along(settings.fallback)
    return replace(settings, decimation=along(settings.decimation), fallback=fallback)
