"""The least number of vertices, where a level asks for less."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil

from ..decimation import Decimation
from ..errors import NestedCagesError, NestingError
from ..geometry.mesh import Mesh
from ..geometry.precision import INPUT_ROUND_OFF, MOST_ROUNDS
from .narrow_places import tightest_place

GROWTH = 1.1
"""Factor on a number of vertices that was too small."""

MAX_SEARCHED = 400
"""Number of vertices above which no smaller one is sought."""


def with_least(
    error: NestedCagesError, decimation: Decimation, outline: Mesh, clearances: Sequence[float], side: int
) -> NestedCagesError:
    """The error of a decimation; where it asks for more vertices, with a number that it finds a mesh for.

    Where no mesh around the outline keeps its loops and the clearance, whatever its number, this is the error instead.
    """
    if error.code != "count.too_small" or "total" not in error.data:
        return error
    clearance = clearances[0] if len(clearances) == 1 else 0.0
    bound = tightest_place(outline) if side > 0 else None
    if bound is not None and bound.clearance <= max(clearance, INPUT_ROUND_OFF * outline.diagonal):
        return NestingError(bound.message(clearance))
    total = int(error.data["total"])
    least = max(int(error.data.get("least", 0)), total + 1)
    for _ in range(MOST_ROUNDS):
        failure = _failure(decimation, outline, least, clearances[0])
        if failure is None:
            break
        least = min(max(ceil(GROWTH * least), int(failure.data.get("least", 0))), len(outline.vertices))
    else:
        return error
    too_few = total
    while least - too_few > 1 and least <= MAX_SEARCHED:
        number = (least + too_few) // 2
        if _failure(decimation, outline, number, clearances[0]) is None:
            least = number
        else:
            too_few = number
    return NestingError(
        f"A level of {total} vertices is too small for this shape, whose loops block each other: the smallest that was "
        f"found has {least}; ask for at least {least}.",
        code="count.too_small",
        total=total,
        least=least,
    )


def _failure(decimation: Decimation, outline: Mesh, count: int, clearance: float) -> NestingError | None:
    try:
        decimation.decimate(outline, count, clearance=clearance)
    except NestingError as failure:
        return failure
    return None
