"""Which loops the cages of a run keep: all, those worth their vertices, or one."""

from __future__ import annotations

from dataclasses import replace

from ..decimation import LineCycles, OuterHull
from ..decimation.base import KeepingStarts
from ..errors import NestingError
from ..geometry.mesh import Mesh
from .settings import Settings


def keeps_loops(settings: Settings, side: int) -> bool:
    """Whether each level keeps all loops, so that it needs three vertices for each.

    Raises NestingError for cages inside with merged loops.
    """
    if side < 0 and settings.merged_within is not None:
        raise NestingError("Inner cages keep all loops; leave out merge.", code="setting.conflict")
    return side < 0 or (settings.loops == "keep" and settings.merge is None)


def with_loops(settings: Settings, inner: Mesh) -> Settings:
    """The settings of a level around a mesh whose loops need not all be kept."""
    if len(inner.loops) == 1 or settings.convex:
        return settings
    if settings.symmetry is not None and not isinstance(settings.decimation, KeepingStarts):
        return settings
    from ..decimation.loops import FewerLoops

    fallback, outside = settings.fallback, LineCycles(on_curve=False)
    if settings.merged_within is None:
        return replace(settings, decimation=FewerLoops(settings.decimation), fallback=fallback and FewerLoops(fallback))
    from ..decimation.merging import Merging

    others = FewerLoops(outside) if settings.loops != "keep" else Merging(settings.merged_within, OuterHull())
    return replace(settings, decimation=Merging(settings.merged_within, outside), fallback=fallback and others)
