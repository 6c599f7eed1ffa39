"""Outer hull: a coarse mesh that strictly encloses the fine one from the start, with any number of vertices."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np

from .._types import FloatArray, IntArray
from ..errors import InvalidMeshError, NestingError
from ..mesh import Mesh
from ..mesh.validation import place
from .base import Count, checked_budget
from .enclosure import Enclosure
from .hull_search import search_hulls
from .offset import strict_offset
from .outline import Outline, padded
from .unrolled import Unrolled, unroll

OFFSET = 5e-5
"""Distance, in diagonals, that the hull keeps from the fine mesh where there is room and no clearance asks for more."""

CLEARANCE_RESERVE = 1.05
"""The hull aims at so many clearances: room to move for what comes next."""

SAME_AREA = 1e-9
"""Relative difference of area below which two hulls are the same one."""

LOOPS_NAMED = 8
"""Number of loops up to which a message lists what was found for each."""


@dataclass(frozen=True)
class OuterHull:
    """Progressive hull of a strict offset of the fine mesh, the best of several seeded runs."""

    restarts: int = 24
    """Runs with varied weights; large vertex counts get fewer."""
    seed: int = 0
    """Where the random numbers of the runs begin."""

    def decimate(self, fine: Mesh, count: Count, *, clearance: float = 0.0) -> Mesh:
        """The hull of least area; see `candidates`."""
        return self.candidates(fine, count, clearance=clearance, keep=1)[0]

    def candidates(self, fine: Mesh, count: Count, *, clearance: float = 0.0, keep: int = 3) -> list[Mesh]:
        """Up to `keep` different meshes that strictly enclose the fine one, by exact predicates, least area first.

        count: total number of vertices, or one per loop of the fine mesh (exactly these, even if it has fewer itself).
        clearance: distance to keep from the fine mesh where there is room, in input units.
        Loop k of each mesh belongs to loop k of the fine mesh.

        Raises NestingError if the count is impossible, with the smallest one found, or if doubles are too coarse.
        """
        budget = checked_budget(fine, count)
        unrolled = unroll(fine)
        outline = unrolled.outline
        wanted = unrolled.wanted(budget)
        minimum = np.minimum(wanted, outline.sizes).tolist()
        total = budget.total if budget.per_loop is None else sum(minimum)
        enclosure = Enclosure(fine)
        distance = max(OFFSET * fine.diagonal, CLEARANCE_RESERVE * clearance)

        start, stuck = strict_offset(outline, distance, enclosure.tree)
        tight = outline.vertices[stuck]
        # where a gap has no room for the offset, the hull comes first, fills the gap, and is moved outwards afterwards
        for first, later in ((start, 0.0), (outline, distance)):
            if first is start and len(tight):
                continue
            hulls = search_hulls(first, total, minimum, self.restarts, self.seed)
            if len(hulls[0].vertices) > total:
                raise NestingError(_unreachable(hulls[0], total, unrolled))
            outwards = (_moved_out(hull, later, enclosure) for hull in _different(hulls))
            widened = (enclosure.widened(hull, CLEARANCE_RESERVE * clearance) for hull in outwards if hull)
            meshes = (_mesh(hull, wanted, unrolled) for hull in widened)
            found = list(islice((mesh for mesh in meshes if mesh and enclosure.holds(mesh)), keep))
            if found:
                return found
        raise NestingError(_no_room(tight, outline))


def _different(hulls: Iterable[Outline]) -> Iterator[Outline]:
    """Those of the hulls, sorted by size and area, that are not the same as the one before; of the first one's size."""
    size, area = 0, 0.0
    for hull in hulls:
        if size == 0:
            size = len(hull.vertices)
        if len(hull.vertices) == size and abs(hull.area - area) > SAME_AREA * hull.area:
            area = hull.area
            yield hull


def _moved_out(hull: Outline, distance: float, enclosure: Enclosure) -> Outline | None:
    """The hull moved off the fine mesh; None if there is no room for it."""
    if not distance:
        return hull
    moved, stuck = strict_offset(hull, distance, enclosure.tree)
    return None if len(stuck) else moved


def _mesh(hull: Outline, wanted: IntArray, unrolled: Unrolled) -> Mesh | None:
    """The hull as a mesh with at least as many vertices per loop as wanted; None if it is not valid."""
    try:
        return unrolled.rolled_up(padded(hull.loops, wanted))
    except InvalidMeshError:
        return None


def _unreachable(best: Outline, total: int, unrolled: Unrolled) -> str:
    sizes = [best.sizes[k] for k in np.argsort(unrolled.loop_order)]
    per_loop = f" ({', '.join(map(str, sizes))} for its loops)" if 1 < len(sizes) <= LOOPS_NAMED else ""
    return (
        f"A level of {total} vertices is too small for this shape, whose loops are in each other's way: the smallest "
        f"found has {len(best.vertices)}{per_loop}; ask for at least {len(best.vertices)}."
    )


def _no_room(tight: FloatArray, outline: Outline) -> str:
    where = place(tight[0] if len(tight) else outline.vertices[0])
    return (
        f"There is no room for a cage around the mesh near {where}: a gap there is as small as floating-point numbers "
        "can tell at these coordinates; widen the gap, or move the shape closer to the origin."
    )
