"""Apportioning vertices in proportion to lengths: between loops, or between the edges of a loop."""

from __future__ import annotations

from heapq import heapify, heapreplace

import numpy as np

from ...geometry.arrays import FloatArray, IntArray
from ...geometry.loops import Loops
from ...geometry.vectors import norm


def shares(total: int, lengths: FloatArray, least: int) -> IntArray:
    """Numbers (K,) in proportion to lengths (K,), at least `least` each, whose sum is `total` or the least possible.

    Each vertex in turn goes where the spacing is longest (D'Hondt's method), which minimises the longest spacing. Ties
    go to the first.
    """
    numbers = np.full(len(lengths), least, dtype=np.int64)
    queue = [(-length / least, k) for k, length in enumerate(lengths.tolist())]
    heapify(queue)
    for _ in range(total - least * len(lengths)):
        k = queue[0][1]
        numbers[k] += 1
        heapreplace(queue, (-float(lengths[k]) / int(numbers[k]), k))
    return numbers


def padded(outline: Loops, total: int, per_loop: IntArray | None) -> list[FloatArray]:
    """The loops (k, 2) of an outline with edges divided evenly until there are enough vertices.

    total: wanted number of vertices. per_loop: (L,) wanted number for each loop, instead of the total.
    """
    steps = outline.vertices[outline.successor] - outline.vertices
    lengths = norm(steps)
    if per_loop is None:
        pieces = shares(total, lengths, 1)
    else:
        of_loop = np.split(lengths, outline.begins[1:])
        pieces = np.concatenate([shares(k, edges, 1) for k, edges in zip(per_loop.tolist(), of_loop, strict=True)])
    begin = np.cumsum(pieces) - pieces
    fraction = (np.arange(pieces.sum()) - np.repeat(begin, pieces)) / np.repeat(pieces, pieces)
    vertices = np.repeat(outline.vertices, pieces, axis=0) + fraction[:, None] * np.repeat(steps, pieces, axis=0)
    return np.split(vertices, begin[outline.begins[1:]])
