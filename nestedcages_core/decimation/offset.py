"""Strict offset: loops pushed outwards, less where there is no room, until exact tests say that they touch nothing."""

from __future__ import annotations

import numpy as np

from .._types import BoolArray, FloatArray, IntArray
from ..predicates import BoxTree, orientation, segments_intersect
from .outline import Outline

MITRE_LIMIT = 4.0
"""Longest step of a vertex in units of the distance its edges move: corners below 29 degrees are cut short."""

EDGE_FRACTION = 0.2
"""Longest step of a vertex in units of its shorter edge; below 0.5, so no edge can turn round."""

SAFETY = 2.0
"""Vertices could go this much farther without touching anything: half of every gap stays open."""

HALVINGS = 64
"""Rounds of halving the steps that touch something; what fails after that has less room than doubles can tell."""


def strict_offset(outline: Outline, distance: FloatArray | float, obstacle: BoxTree) -> tuple[Outline, IntArray]:
    """The outline with its edges moved outwards by `distance`, less where there is no room; and who found none at all.

    distance: a length, or one per vertex (n,); 0 keeps a vertex where it is. obstacle: edges to stay clear of, beside
    those of the result itself. Where the second result (K,), indices of vertices, is empty, the moved edges neither
    touch each other nor the obstacle, exactly.
    """
    mitre = _mitres(outline)
    lengths = np.hypot(*(outline.vertices[outline.successor] - outline.vertices).T)
    room = EDGE_FRACTION * np.minimum(lengths, lengths[outline.predecessor])
    step = np.minimum(np.broadcast_to(distance, len(mitre)), room / np.hypot(*mitre.T))
    stuck = np.zeros(0, dtype=np.int64)
    for reserve in (SAFETY, 1.0):
        changed = step > 0.0
        for _ in range(HALVINGS):
            watched = np.flatnonzero(changed | changed[outline.successor])
            there = outline.moved(outline.vertices + reserve * step[:, None] * mitre)
            stuck = _touching_edges(there, watched, obstacle)
            if len(stuck) == 0:
                break
            changed = np.zeros(len(step), dtype=bool)
            for vertex in (stuck, outline.successor[stuck]):
                changed[vertex] = changed[outline.successor[vertex]] = changed[outline.predecessor[vertex]] = True
            step[changed] *= 0.5
    return outline.moved(outline.vertices + step[:, None] * mitre), stuck


def _mitres(outline: Outline) -> FloatArray:
    """(n, 2) step of each vertex that moves both of its edges outwards by one length, but no longer than MITRE_LIMIT.

    With the unit normals n₁, n₂ of the two edges it is 2 (n₁ + n₂) / |n₁ + n₂|².
    """
    along = outline.vertices[outline.successor] - outline.vertices
    along = along / np.hypot(*along.T)[:, None]
    back = along[outline.predecessor]
    normals = back + along
    normals = np.stack((normals[:, 1], -normals[:, 0]), axis=1)
    size = np.hypot(*normals.T)
    # where the normals cancel, the direction of the tip is left
    tip = np.where((back[:, 0] * along[:, 1] >= back[:, 1] * along[:, 0])[:, None], back - along, along - back)
    sharp = MITRE_LIMIT * size < 2.0
    direction = np.where(sharp[:, None], tip / np.maximum(np.hypot(*tip.T), 1.0)[:, None], normals)
    length = np.where(sharp, MITRE_LIMIT, 2.0 / np.maximum(size, 2.0 / MITRE_LIMIT) ** 2)
    mitre: FloatArray = direction * length[:, None]
    return mitre


def _touching_edges(outline: Outline, watched: IntArray, obstacle: BoxTree) -> IntArray:
    """Edges that touch the obstacle or another edge than their neighbours, or fold back on these; watched or touched.

    watched: (W,) the edges to look at; all are compared with all others.
    """
    starts, ends = outline.vertices, outline.vertices[outline.successor]
    everything = outline.tree
    if len(watched) == len(starts):
        i, j = everything.self_pairs()
        k, other = everything.pairs(obstacle)
    else:
        part = BoxTree(starts[watched], ends[watched])
        i, j = part.pairs(everything)
        i = watched[i]
        k, other = part.pairs(obstacle)
        k = watched[k]
    apart = (i != j) & (outline.successor[i] != j) & (outline.successor[j] != i)
    i, j = i[apart], j[apart]
    crossing = segments_intersect(starts[i], ends[i], starts[j], ends[j])
    against = segments_intersect(starts[k], ends[k], obstacle.starts[other], obstacle.ends[other])
    folded = watched[_folds_back(outline, watched)]
    touching: IntArray = np.unique(np.concatenate((i[crossing], j[crossing], k[against], folded)))
    return touching


def _folds_back(outline: Outline, edges: IntArray) -> BoolArray:
    """(K,) whether the edge after each of some edges (K,) runs back over it."""
    middle = outline.successor[edges]
    a, b, c = (outline.vertices[v] for v in (edges, middle, outline.successor[middle]))
    folded: BoolArray = (orientation(a, b, c) == 0) & (((b - a) * (c - b)).sum(axis=1) <= 0.0)
    return folded
