"""A pyramid of bounding boxes over consecutive segments: which segments of two sets may touch."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray, IntArray
from .sweep import SWEEP_LIMIT, swept_pairs, swept_self_pairs

if TYPE_CHECKING:
    from .oriented_boxes import OrientedBoxes

FANOUT = 4
"""Boxes that share a parent; 4 was the fastest of 2, 4 and 8 for loops of 1,000 to 100,000 segments."""

BLOCK_PAIRS = 2**16
"""Pairs compared at once; bounds the memory to about 100 MB."""

CROWDED = 8
"""Overlaps per box above which oriented boxes are tested too; smooth loops have about 3."""

FEW_CHAINS = 8
"""Number of chains up to which sorting them costs more than it saves."""

FEW_PAIRS = 20_000
"""Number of point-segment pairs up to which testing all of them is faster than descending the tree (measured)."""

MORTON_BITS = 16
"""Bits per coordinate of the space-filling curve that sorts chains of segments."""


class BoxTree:
    """Pyramid of boxes over segments (E, 2) -> (E, 2), built along the order of the segments.

    Segments that follow each other (the end of one is the start of the next) form a chain. Chains stay whole and are
    sorted along a space-filling curve, so any order of the input is accepted, and loops given in their own order are
    the fastest. Level 0 holds the boxes of the segments; each level is padded with empty boxes to a multiple of FANOUT.

    Few pairs of segments are found without it: it is built on first use.

    starts, ends: the segments as given, (E, 2).
    """

    def __init__(self, starts: FloatArray, ends: FloatArray) -> None:
        self.starts = np.asarray(starts, dtype=np.float64).reshape(-1, 2)
        self.ends = np.asarray(ends, dtype=np.float64).reshape(-1, 2)
        self._oriented: list[OrientedBoxes] = []

    @cached_property
    def _chains(self) -> tuple[IntArray, IntArray]:
        """`order` and `chain_starts`."""
        count = len(self.starts)
        (x, y), (next_x, next_y) = self.ends[:-1].T, self.starts[1:].T
        breaks = 1 + np.flatnonzero((x != next_x) | (y != next_y))
        bounds = np.concatenate(([0], breaks, [count])) if count else np.zeros(1, dtype=np.int64)
        sizes, order = np.diff(bounds), np.arange(count)
        if len(sizes) > FEW_CHAINS:
            sequence = _along_curve(self.starts[bounds[:-1]])
            sizes = sizes[sequence]
            order += np.repeat(bounds[:-1][sequence] - (np.cumsum(sizes) - sizes), sizes)
        return order, np.concatenate(([0], np.cumsum(sizes))).astype(np.int64)

    @property
    def order(self) -> IntArray:
        """(E,) the given index of each segment in tree order."""
        return self._chains[0]

    @property
    def chain_starts(self) -> IntArray:
        """(chains + 1,) where each chain begins in tree order."""
        return self._chains[1]

    @cached_property
    def chain(self) -> IntArray:
        """(E,) the number of the chain of each segment in tree order."""
        return np.repeat(np.arange(len(self.chain_starts) - 1), np.diff(self.chain_starts))

    @cached_property
    def closed(self) -> bool:
        """Whether every chain ends where it starts."""
        first, last = self.order[self.chain_starts[:-1]], self.order[self.chain_starts[1:] - 1]
        return bool((self.starts[first] == self.ends[last]).all())

    @cached_property
    def _boxes(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest coordinates of each segment, as given, (2, E), (2, E)."""
        starts, ends = self.starts.T.copy(), self.ends.T.copy()
        return np.minimum(starts, ends), np.maximum(starts, ends)

    @cached_property
    def levels(self) -> list[FloatArray]:
        """The boxes of each level."""
        low, high = self._boxes
        return _pyramid(low[:, self.order], high[:, self.order])

    @cached_property
    def counts(self) -> list[int]:
        """How many boxes of each level are not padding."""
        return [-(-len(self) // FANOUT**level) for level in range(len(self.levels))]

    def __len__(self) -> int:
        return len(self.starts)

    @cached_property
    def sorted_segments(self) -> tuple[FloatArray, FloatArray]:
        """Starts and ends, (E, 2) each, in tree order."""
        return self.segments(self.order)

    def segments(self, chosen: IntArray) -> tuple[FloatArray, FloatArray]:
        """Starts and ends, (K, 2) each, of some segments (K,) by their given index."""
        return self.starts.take(chosen, axis=0), self.ends.take(chosen, axis=0)

    def self_pairs(self) -> tuple[IntArray, IntArray]:
        """Pairs i < j of segments whose boxes overlap or touch, (K,), (K,)."""
        return _concatenated(self.blocks())

    def pairs(self, other: BoxTree) -> tuple[IntArray, IntArray]:
        """Pairs (i of this tree, j of the other) of segments whose boxes overlap or touch, (K,), (K,)."""
        return _concatenated(self.blocks(other))

    def blocks(self, other: BoxTree | None = None, *, slim: bool = False) -> Iterator[tuple[IntArray, IntArray]]:
        """The pairs of `pairs(other)`, or of `self_pairs()`, in blocks of bounded size.

        slim: whether to drop pairs that oriented boxes separate, where axis-aligned boxes overlap too often. All pairs
        of segments that share a point are kept.
        """
        swept = self._swept(other)
        if swept is not None:
            yield swept
            return
        second = self if other is None else other
        a, b = len(self.levels) - 1, len(second.levels) - 1
        here, there = np.indices((self.levels[a].shape[1], second.levels[b].shape[1])).reshape(2, -1)
        tally: Counter[tuple[int, int]] = Counter()
        waiting = [(a, b, *self._meeting(a, here, other, b, there, slim, tally))]
        while waiting:
            a, b, i, j = waiting.pop()
            if a == 0 and b == 0:
                yield self._as_given(i, j, other)
            elif len(i) > BLOCK_PAIRS:
                middle = len(i) // 2
                waiting += [(a, b, i[middle:], j[middle:]), (a, b, i[:middle], j[:middle])]
            else:
                if other is None:
                    a, b, i, j = a - 1, b - 1, *_children_of_both(i, j)
                elif b == 0 or (a > 0 and self.sizes[a] >= second.sizes[b]):
                    a, i, j = a - 1, children(i), np.repeat(j, FANOUT)
                else:
                    b, i, j = b - 1, np.repeat(i, FANOUT), children(j)
                waiting.append((a, b, *self._meeting(a, i, other, b, j, slim, tally)))

    def _swept(self, other: BoxTree | None) -> tuple[IntArray, IntArray] | None:
        """The pairs without a tree, if there are few segments and pairs."""
        if other is None:
            return swept_self_pairs(*self._boxes, BLOCK_PAIRS) if len(self) <= SWEEP_LIMIT else None
        few = len(self) + len(other) <= SWEEP_LIMIT
        return swept_pairs(*self._boxes, *other._boxes, BLOCK_PAIRS) if few else None

    def _meeting(
        self,
        a: int,
        i: IntArray,
        other: BoxTree | None,
        b: int,
        j: IntArray,
        slim: bool,
        tally: Counter[tuple[int, int]],
    ) -> tuple[IntArray, IntArray]:
        """The pairs of boxes i of level a and j of the other tree's level b that overlap; tally counts them."""
        second = self if other is None else other
        if other is None:
            ordered = i <= j
            i, j = i[ordered], j[ordered]
        i, j = _overlapping(self.levels[a], i, second.levels[b], j)
        tally[a, b] += len(i)
        if slim and tally[a, b] > CROWDED * (self.levels[a].shape[1] + second.levels[b].shape[1]):
            meet = self.oriented(a).gap(i, second.oriented(b), j) <= 0.0
            i, j = i[meet], j[meet]
        return i, j

    def _as_given(self, i: IntArray, j: IntArray, other: BoxTree | None) -> tuple[IntArray, IntArray]:
        """Pairs in the numbering of the input; within one tree i < j."""
        if other is not None:
            return self.order[i], other.order[j]
        i, j = self.order[i[i < j]], self.order[j[i < j]]
        return np.minimum(i, j), np.maximum(i, j)

    @cached_property
    def sizes(self) -> list[float]:
        """Mean extent of the boxes of each level."""
        with np.errstate(over="ignore", invalid="ignore"):  # only decides which level to open first
            return [
                float(boxes[2:, :count].mean() - boxes[:2, :count].mean()) if count else 0.0
                for boxes, count in zip(self.levels, self.counts, strict=True)
            ]

    def oriented(self, level: int) -> OrientedBoxes:
        """The oriented boxes of a level, made on first use."""
        if not self._oriented:
            from .oriented_boxes import OrientedBoxes  # for crowded segments only

            self._oriented.append(OrientedBoxes.of_segments(*self.sorted_segments))
        while len(self._oriented) <= level:
            self._oriented.append(self._oriented[-1].parents(FANOUT))
        return self._oriented[level]


def _concatenated(blocks: Iterator[tuple[IntArray, IntArray]]) -> tuple[IntArray, IntArray]:
    """Blocks of pairs as one."""
    listed = list(blocks)
    none = np.zeros(0, dtype=np.int64)
    return np.concatenate([none, *(i for i, _ in listed)]), np.concatenate([none, *(j for _, j in listed)])


def _along_curve(points: FloatArray) -> IntArray:
    """Order of points (K, 2) along a Morton curve, (K,)."""
    low, high = points.min(axis=0), points.max(axis=0)
    with np.errstate(all="ignore"):
        cells = np.nan_to_num((points - low) / (high - low), nan=0.0, posinf=0.0, neginf=0.0)
    bits = (np.clip(cells, 0.0, 1.0) * (2**MORTON_BITS - 1)).astype(np.int64)
    code = np.zeros(len(points), dtype=np.int64)
    for bit in range(MORTON_BITS):
        code |= ((bits[:, 0] >> bit) & 1) << (2 * bit) | ((bits[:, 1] >> bit) & 1) << (2 * bit + 1)
    return np.argsort(code, kind="stable")


def _pyramid(lower: FloatArray, upper: FloatArray) -> list[FloatArray]:
    """Boxes per level, each (4, N): least x, least y, greatest x, greatest y."""
    boxes = np.concatenate((lower, upper))
    levels = [boxes]
    while boxes.shape[1] > FANOUT:
        missing = -boxes.shape[1] % FANOUT
        empty = np.repeat([[np.inf], [np.inf], [-np.inf], [-np.inf]], missing, axis=1)
        boxes = np.ascontiguousarray(np.concatenate((boxes, empty), axis=1))
        levels[-1] = boxes
        groups = boxes.reshape(4, -1, FANOUT)
        boxes = np.concatenate((groups[:2].min(axis=2), groups[2:].max(axis=2)))
        levels.append(boxes)
    return levels


def _overlapping(boxes: FloatArray, i: IntArray, others: FloatArray, j: IntArray) -> tuple[IntArray, IntArray]:
    """The pairs (i, j) whose boxes share a point."""
    for axis in (0, 1):
        keep = boxes[axis].take(i) <= others[axis + 2].take(j)
        keep &= others[axis].take(j) <= boxes[axis + 2].take(i)
        i, j = i[keep], j[keep]
    return i, j


def children(nodes: IntArray) -> IntArray:
    """The boxes, one level down, of boxes (K,) of a level, (K FANOUT,)."""
    return (FANOUT * nodes[:, None] + np.arange(FANOUT)).ravel()


def _children_of_both(i: IntArray, j: IntArray) -> tuple[IntArray, IntArray]:
    offsets = np.indices((FANOUT, FANOUT)).reshape(2, -1)
    return (FANOUT * i[:, None] + offsets[0]).ravel(), (FANOUT * j[:, None] + offsets[1]).ravel()
