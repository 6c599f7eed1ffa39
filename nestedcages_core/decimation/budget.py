"""Numbers of vertices of a level: clamped, checked and compared with what became of them."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import Fault, NestingError, note
from ..geometry.mesh import Mesh
from .base import Count

LEAST_PER_LOOP = 3
"""Vertices of the smallest polygon."""


def clamped(count: int, fine: Mesh) -> tuple[int, tuple[Fault, ...]]:
    """A number of vertices, clamped to that of the fine mesh, with a note if it was larger."""
    available = len(fine.vertices)
    if count <= available:
        return count, ()
    return available, (note("note.count", on="mesh", asked=count, given=available),)


def shared_anew(count: Count, coarse: Mesh) -> tuple[Fault, ...]:
    """A note if the numbers of vertices per loop of a coarse mesh differ from the request."""
    if isinstance(count, int | np.integer) or list(count) == [len(loop) for loop in coarse.loops]:
        return ()
    return (note("note.count", on="loops", asked=list(count), given=[len(loop) for loop in coarse.loops]),)


def count_fault(total: int, least: int) -> Fault:
    """The message for a number of vertices below the least for which a coarse mesh was found."""
    return Fault(
        f"A level of {total} vertices is too small for this shape, whose loops block each other: the smallest that was "
        f"found has {least}; ask for at least {least}.",
        "count.too_small",
        total=total,
        least=least,
    )


@dataclass(frozen=True)
class Budget:
    """A checked count: `total` vertices; `per_loop` in the order of `fine.loops`, or None to distribute them freely."""

    total: int
    per_loop: tuple[int, ...] | None


def checked_budget(fine: Mesh, count: Count) -> Budget:
    """The count as a Budget. Raises NestingError unless every loop gets 3 and the total is at most that of `fine`.

    Numbers per loop may exceed those of the fine mesh, as they come from a given coarse mesh.
    """
    loops, available = len(fine.loops), len(fine.vertices)
    try:
        if isinstance(count, Sequence | np.ndarray):
            per_loop = tuple(operator.index(k) for k in count)
            total = sum(per_loop)
        else:
            per_loop = None
            total = operator.index(count)
    except TypeError:
        raise NestingError(
            f"A level needs a whole number of vertices, or one per loop, not {count!r}.", code="level.invalid"
        ) from None
    if per_loop is not None:
        if len(per_loop) != loops:
            raise NestingError(
                f"The level lists vertices for {len(per_loop)} loops, but the mesh inside it has {loops}; give one "
                "number per loop, or only their sum.",
                code="count.per_loop",
            )
        if min(per_loop) < LEAST_PER_LOOP:
            k = int(np.argmin(per_loop))
            raise NestingError(
                f"The level gives {per_loop[k]} vertices to loop {k}, but a loop needs at least {LEAST_PER_LOOP}.",
                code="count.too_small",
                total=total,
                least=LEAST_PER_LOOP * loops,
            )
    elif total < LEAST_PER_LOOP * loops:
        raise NestingError(
            f"A level of {total} vertices is too small: the mesh inside it has {loops} "
            f"loop{'s' if loops > 1 else ''} and each needs at least {LEAST_PER_LOOP}, so ask for at least "
            f"{LEAST_PER_LOOP * loops}.",
            code="count.too_small",
            total=total,
            least=LEAST_PER_LOOP * loops,
        )
    elif total > available:
        raise NestingError(
            f"A level of {total} vertices has more than the {available} of the mesh inside it; ask for at most "
            f"{available}.",
            code="count.too_large",
            total=total,
            largest=available,
        )
    return Budget(total, per_loop)
