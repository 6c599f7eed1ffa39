"""Outlines of a sequence of pictures, with corresponding corners in the same order where possible."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from ...geometry.arrays import FloatArray
from ...geometry.mesh import Mesh


def corresponding(outlines: Sequence[Mesh]) -> list[Mesh]:
    """The outlines with loops and corners in the order of the previous frame, if their numbers agree.

    Loops are matched by their centres, outer ones with outer ones; corners by the cyclic order with the least squared
    distances. An outline with other numbers begins a new sequence.
    """
    ordered: list[Mesh] = []
    for outline in outlines:
        ordered.append(_in_the_order_of(ordered[-1], outline) if ordered else outline)
    return ordered


def _in_the_order_of(before: Mesh, outline: Mesh) -> Mesh:
    old, new = ([mesh.vertices[loop] for loop in mesh.loops] for mesh in (before, outline))
    if sorted(before.loop_signs) != sorted(outline.loop_signs):
        return outline
    cost = np.array([[float(np.sum((a.mean(axis=0) - b.mean(axis=0)) ** 2)) for b in new] for a in old])
    cost[before.loop_signs[:, None] != outline.loop_signs] += len(cost) * (1.0 + cost.max())
    _, partner = scipy.optimize.linear_sum_assignment(cost)
    if any(len(a) != len(new[k]) for a, k in zip(old, partner, strict=True)):
        return outline
    return Mesh.from_loops([_turned_to(a, new[k]) for a, k in zip(old, partner, strict=True)])


def _turned_to(target: FloatArray, loop: FloatArray) -> FloatArray:
    """A loop (k, 2) from the vertex on that brings its corners closest to those of another, centres aside."""
    target, own = target - target.mean(axis=0), loop - loop.mean(axis=0)
    distances = [float(np.sum((target - np.roll(own, -shift, axis=0)) ** 2)) for shift in range(len(loop))]
    turned: FloatArray = np.roll(loop, -int(np.argmin(distances)), axis=0)
    return turned
