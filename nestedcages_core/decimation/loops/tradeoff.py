"""Counts against excess: what each number of vertices would give, from the costs that the search for lines knows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ...errors import Fault, NestedCagesError, note
from ...geometry.mesh import Mesh
from ...tasks import drain
from ..base import NOTHING_KEPT
from ..budget import LEAST_PER_LOOP
from .choosing import LoopChoice

FEW_MORE, PART_MORE = 4, 4
"""A few vertices more: this many, or 1 for this many of those there are."""

HALF = 0.5
"""Part of the excess that is left where a few vertices more are told."""

MOST_TOLD = 64
"""Number of vertices up to which a few more are looked at: beyond, the curve has no knees, and searches take long."""

LEAST_TOLD = 0.2
"""Excess below which none are told."""


class Tradeoff(Mapping[int, float]):
    """About the excess for each number of vertices, certified for that of the cage; empty where it is not known.

    With crossings of the outlines left aside, whatever loops that takes.
    """

    def __init__(self, excess: Mapping[int, float], count: int) -> None:
        self.excess, self.count = dict(excess), count

    @classmethod
    def of(cls, fine: Mesh, cage: Mesh, clearance: float = 0.0, most: int | None = None) -> Tradeoff:
        """The numbers around that of a cage. most: the largest; default: a few more than the cage has."""
        count = len(cage.vertices)
        most = min(count + max(FEW_MORE, count // PART_MORE) if most is None else most, len(fine.vertices))
        choice = LoopChoice(fine, max(most, LEAST_PER_LOOP), NOTHING_KEPT, clearance)
        try:
            drain(choice.look(np.inf, count))
        except NestedCagesError:  # also of loops that are as small as round-off
            return cls({}, count)
        least = np.minimum.accumulate(choice.costs())
        if not 0.0 < least[min(count, len(least) - 1)] < np.inf:
            return cls({}, count)
        scale = (cage.area / fine.area - 1.0) / least[min(count, len(least) - 1)]
        return cls({k: float(scale * least[k]) for k in np.flatnonzero(np.isfinite(least)).tolist()}, count)

    def __getitem__(self, count: int) -> float:
        return self.excess[count]

    def __iter__(self) -> Iterator[int]:
        return iter(self.excess)

    def __len__(self) -> int:
        return len(self.excess)

    def __repr__(self) -> str:
        return f"Tradeoff({', '.join(f'{count}: {100.0 * excess:.3g} %' for count, excess in self.items())})"

    @property
    def knee(self) -> int | None:
        """The least number of vertices, a few more than the cage has, with at most half the excess; None if none."""
        own = self.excess.get(self.count, 0.0)
        few = self.count + max(FEW_MORE, self.count // PART_MORE)
        return next((k for k, excess in self.items() if self.count < k <= few and excess <= HALF * own), None)

    def plot(self, ax: Any = None) -> Any:
        """Draw the curve with matplotlib, with the cage and the knee, and return the axes; ax: those to draw on.

        Raises NestedCagesError if matplotlib is missing.
        """
        from ...geometry.picture import plotted_curve

        marked = [count for count in (self.count, self.knee) if count in self.excess]
        return plotted_curve(self.excess, marked, ("vertices", "excess"), ax)


def knee_note(fine: Mesh, cage: Mesh, clearance: float) -> tuple[Fault, ...]:
    """A note where a few vertices more would halve the excess."""
    excess = cage.area / fine.area - 1.0
    if excess < LEAST_TOLD or len(cage.vertices) > MOST_TOLD:
        return ()
    found = Tradeoff.of(fine, cage, clearance)
    if found.knee is None:
        return ()
    return (note("note.knee", given=found.count, better=found.knee, excess=excess, less=found[found.knee]),)
