"""Nodes: cells of all that an edge or a vertex of a cage can be where it touches the outline."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .outline import Outline, Seen

EDGE, CORNER, ENTER, LEAVE = range(4)
"""Kinds. EDGE: an edge that touches a convex vertex, in an interval of directions. CORNER: a cage vertex on a vertex of
the outline. ENTER, LEAVE: a cage vertex in an interval of an edge of the outline, between an EDGE and a chord, and
between a chord and an EDGE."""


@dataclass(frozen=True, eq=False)
class Nodes:
    """Arrays (N,); angles from the direction of the edge before a vertex, or parameters of an edge."""

    outline: Outline
    kind: np.ndarray
    at: np.ndarray
    """Vertex or edge of the outline."""
    low: np.ndarray
    high: np.ndarray

    def __post_init__(self) -> None:
        edges = np.flatnonzero(self.kind == EDGE)
        ahead, behind = (
            self.outline.seen(way, self.at[edges], self.low[edges], self.high[edges]) for way in (True, False)
        )
        reach = np.full((2, len(self.kind)), np.inf)
        reach[0, edges], reach[1, edges] = ahead.reach, behind.reach
        self.__dict__.update(edges=edges, ahead=ahead, behind=behind, reach=reach)

    edges: np.ndarray = None  # type: ignore[assignment]
    """Those of kind EDGE; the next three are about them."""
    ahead: Seen = None  # type: ignore[assignment]
    behind: Seen = None  # type: ignore[assignment]
    reach: np.ndarray = None  # type: ignore[assignment]
    """(2, N) how far an edge comes at most, ahead and behind."""

    @property
    def key(self) -> np.ndarray:
        """Place along the outline: vertices are even, edges odd."""
        return 2 * self.at + (self.kind >= ENTER)

    def ends(self, of: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Both ends of cells of cage vertices on the outline, with the area swept up to them."""
        return [self.outline.on(self.at[of], end[of]) for end in (self.low, self.high)]

    def halved(self, alive: np.ndarray, split: np.ndarray) -> tuple[Nodes, np.ndarray, np.ndarray]:
        """Nodes without the dead, and with some in two; of each old node its first new one and their number."""
        count = np.where(alive, np.where(split, 2, 1), 0)
        first = np.cumsum(count) - count
        kind, at, low, high = (np.repeat(a, count) for a in (self.kind, self.at, self.low, self.high))
        middle = 0.5 * (self.low + self.high)[split]
        high[first[split]], low[first[split] + 1] = middle, middle
        return Nodes(self.outline, kind, at, low, high), first, count


def first_nodes(outline: Outline, per_half_turn: int, pieces: int) -> Nodes:
    """Cells of so many to half a turn, and edges in about so many pieces in all."""
    rows: list[tuple[int, int, float, float]] = []
    for vertex in outline.convex:
        turn = outline.turn[vertex]
        bounds = np.linspace(0.0, turn, 1 + max(1, int(np.ceil(per_half_turn * turn / np.pi))))
        rows += [(EDGE, vertex, *pair) for pair in pairwise(bounds)]
    rows += [(CORNER, vertex, 0.0, 0.0) for vertex in range(len(outline))]
    lengths = np.hypot(*outline.edges.T)
    for edge, length in enumerate(lengths):
        bounds = np.linspace(0.0, 1.0, 1 + max(1, int(np.ceil(pieces * length / lengths.sum()))))
        rows += [(kind, edge, *pair) for kind in (ENTER, LEAVE) for pair in pairwise(bounds)]
    kind, at, low, high = np.array(rows).T
    return Nodes(outline, kind.astype(int), at.astype(int), low, high)
