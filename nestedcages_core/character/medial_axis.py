"""The medial axis of a shape as a graph: centres of the largest discs inside, pruned to what protrudes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.predicates import winding_number

SAMPLES = 600
"""Points on all outlines together, whose Voronoi diagram gives the axis."""

LEAST_SAMPLES = 8
"""Minimum number of points on an outline."""

AROUND = 1.3
"""An edge of the axis lies between points of the outline that are this many times as far apart along it as straight."""

SEPARATE = 0.5
"""The same along the outline, in radii of the two ends of the edge; nearer ones are noise of the outline."""

Graph = dict[int, set[int]]


@dataclass(frozen=True, eq=False)
class MedialAxis:
    """Points of the axis with the radii of their discs, and how they are linked."""

    points: FloatArray
    """(N, 2)."""
    radii: FloatArray
    """(N,) distance to the outline."""
    links: Graph
    """Neighbours of each point that is used."""

    def length(self, path: list[int]) -> float:
        """Length of a path."""
        steps = np.diff(self.points[path], axis=0)
        return float(np.hypot(steps[:, 0], steps[:, 1]).sum())


def medial_axis(mesh: Mesh) -> MedialAxis:
    """The edges of the Voronoi diagram of points on the outline that lie inside, without those that noise makes."""
    points, loop, along, total = _on_outline(mesh)
    diagram = scipy.spatial.Voronoi(points)
    centres = diagram.vertices
    inside = winding_number(centres, mesh.vertices, mesh.edge_ends) == 1
    radii = scipy.spatial.cKDTree(points).query(centres)[0]
    pairs, ends = diagram.ridge_points, np.array(diagram.ridge_vertices)
    bounded = (ends >= 0).all(axis=1)
    pairs, ends = pairs[bounded], ends[bounded]
    used = inside[ends].all(axis=1)
    pairs, (first, second) = pairs[used], ends[used].T
    a, b = pairs.T
    between = np.abs(along[a] - along[b])
    between = np.where(loop[a] == loop[b], np.minimum(between, total[loop[a]] - between), np.inf)
    straight = np.hypot(*(points[a] - points[b]).T)
    real = (between > AROUND * straight) & (between > SEPARATE * (radii[first] + radii[second]))
    links: Graph = {}
    for i, j in zip(first[real].tolist(), second[real].tolist(), strict=True):
        links.setdefault(i, set()).add(j)
        links.setdefault(j, set()).add(i)
    return MedialAxis(centres, radii, links)


def pruned(axis: MedialAxis, protrudes: float) -> MedialAxis:
    """The axis without branches that reach less than `protrudes` radii beyond their fork, shortest first."""
    links = {point: set(others) for point, others in axis.links.items()}
    while True:
        worst, least = None, protrudes
        for tip in [point for point, others in links.items() if len(others) == 1]:
            path = _branch(links, tip)
            fork = path[-1]
            if len(links[fork]) >= 3:
                reach = (axis.length(path) + axis.radii[tip]) / axis.radii[fork] - 1.0
                if reach < least:
                    worst, least = path, reach
        if worst is None:
            return MedialAxis(axis.points, axis.radii, {point: others for point, others in links.items() if others})
        for i, j in pairwise(worst):
            links[i].discard(j)
            links[j].discard(i)


def _branch(links: Graph, tip: int) -> list[int]:
    """The path from a tip to the next fork or other tip."""
    path = [tip]
    while True:
        ahead = [point for point in links[path[-1]] if len(path) < 2 or point != path[-2]]
        if not ahead or (len(path) > 1 and len(links[path[-1]]) != 2):
            return path
        path.append(ahead[0])


def _on_outline(mesh: Mesh) -> tuple[FloatArray, IntArray, FloatArray, FloatArray]:
    """Evenly spaced points (P, 2), their loops, their places along these, and the length of each loop."""
    spacing = float(mesh.edge_lengths.sum()) / SAMPLES
    points, loops, places, lengths = [], [], [], []
    for number, loop in enumerate(mesh.loops):
        ends = np.concatenate(([0.0], np.cumsum(mesh.edge_lengths[loop])))
        count = max(round(ends[-1] / spacing), LEAST_SAMPLES)
        at = (np.arange(count) + 0.5) * ends[-1] / count
        ring = mesh.vertices[np.append(loop, loop[0])]
        points.append(np.stack([np.interp(at, ends, ring[:, axis]) for axis in (0, 1)], axis=1))
        loops.append(np.full(count, number))
        places.append(at)
        lengths.append(ends[-1])
    return np.concatenate(points), np.concatenate(loops), np.concatenate(places), np.array(lengths)
