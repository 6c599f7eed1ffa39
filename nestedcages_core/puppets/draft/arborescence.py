"""The best tree: every part has a parent so that the sum of gains is greatest (Chu & Liu 1965, Edmonds 1967)."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import FloatArray, IntArray


def best_parents(gain: FloatArray, root: int) -> IntArray:
    """(n,) the parent of each node, -1 for the root, such that they form a tree and the sum of their gains is greatest.

    gain: (n, n) of each node with each parent; -inf where that is not allowed.
    """
    count = len(gain)
    gain = gain.copy()
    np.fill_diagonal(gain, -np.inf)
    parent = np.asarray(gain.argmax(axis=1))
    parent[root] = -1
    circle = _circle(parent)
    if circle is None:
        return parent
    # the circle becomes one node, which pays for the edge of the circle that its parent replaces
    inside = np.isin(np.arange(count), circle)
    outside = np.flatnonzero(~inside)
    size = len(outside)
    smaller = np.full((size + 1, size + 1), -np.inf)
    smaller[:size, :size] = gain[np.ix_(outside, outside)]
    smaller[:size, size] = gain[np.ix_(outside, circle)].max(axis=1)
    entering = gain[np.ix_(circle, outside)] - gain[circle, parent[circle]][:, None]
    smaller[size, :size] = entering.max(axis=0)
    found = best_parents(smaller, int(np.flatnonzero(outside == root)[0]))
    for node, above in zip(outside, found[:size], strict=True):
        if above >= 0:
            parent[node] = outside[above] if above < size else circle[gain[node, circle].argmax()]
    entry = outside[found[size]]
    opened = circle[entering[:, found[size]].argmax()]
    parent[opened] = entry
    return parent


def _circle(parent: IntArray) -> IntArray | None:
    """The nodes of a circle of parents, if there is one."""
    for start in range(len(parent)):
        seen: list[int] = []
        node = start
        while node >= 0 and node not in seen:
            seen.append(node)
            node = int(parent[node])
        if node >= 0:
            return np.array(seen[seen.index(node) :])
    return None
