"""The least number of vertices, where a level asks for less."""

from __future__ import annotations

from collections.abc import Sequence

from ..decimation import Decimation
from ..decimation.budget import count_fault
from ..errors import NestedCagesError, NestingError
from ..geometry.mesh import Mesh
from ..geometry.precision import MOST_ROUNDS
from ..tasks import Stage
from ..verification import verify
from .settings import LevelSettings
from .tightest_place import too_narrow

MAX_SEARCHED = 400
"""Vertices of all searches for fewer from which no further one begins; errors take about twice the time."""


def with_least(
    failures: Sequence[NestedCagesError], settings: LevelSettings, outline: Mesh, clearances: Sequence[float]
) -> Stage[float, NestedCagesError]:
    """The last of the failures of all attempts; for a count that is too small, with the least one that has a start.

    Where a clearance leaves no room whatever the count, this is the error instead.
    """
    error, clearance = failures[-1], clearances[0]
    if error.code != "count.too_small" or "least" not in error.data:
        return error
    wanted = clearance if len(clearances) == 1 else 0.0
    no_room = too_narrow(outline, wanted)
    if no_room is not None:
        return NestingError(no_room)
    total = int(error.data["total"])
    least = _reached(settings.fallback, outline, int(error.data["least"]), clearance)
    searched = 0
    for method in (settings.decimation, settings.fallback):
        if method is None:
            continue
        low, step = total, 1
        while least - low > 1 and searched < MAX_SEARCHED:
            number = max(least - step, (low + least) // 2)
            searched += number
            yield 0.0
            if _leads(getattr(method, "outside", method), outline, number, clearance, wanted):
                least, step = number, 2 * step
            else:
                low = number
        if step > 1:
            break
    return error if least == error.data["least"] else NestingError(count_fault(total, least))


def _reached(method: Decimation | None, outline: Mesh, least: int, clearance: float) -> int:
    """The least number of vertices that a search for fewer named, or the one that a search for that names."""
    for _ in range(MOST_ROUNDS):
        try:
            if method is not None:
                method.decimate(outline, least, clearance=clearance)
            break
        except NestingError as error:
            least = min(max(least + 1, int(error.data.get("least", 0))), len(outline.vertices))
    return least


def _leads(method: Decimation, outline: Mesh, count: int, clearance: float, kept: float) -> bool:
    """Whether a method finds a start for a count and a clearance that keeps the latter, or one of this length."""
    try:
        coarse = method.decimate(outline, count, clearance=clearance)
        return bool(verify(coarse, outline, kept, same_loops=False))
    except NestingError:
        return False
