"""The middle of a part: its medial axis in one piece, ways along it, and where it forks."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy

from ...errors import NestedCagesError
from ...geometry.arrays import FloatArray
from ...geometry.mesh import Mesh
from ...geometry.vectors import norm
from ..part import PuppetPart
from .skeleton import Graph, MedialAxis, along_path, medial_axis, pruned, trimmed

PROTRUDES = 0.9
"""Branches of the middle that reach less than this beyond their fork, in radii, are none."""

TIP_REACH, TIP_POINTS = 0.8, 4
"""How far a way goes on beyond its last point, in radii there, and the points that tell its direction."""

FORKED = 0.6
"""A fork: the shorter of two branches is at least this long, in lengths of the longer one."""

LEAVES_FORK = 2.0
"""A branch begins where it leaves the disc of its fork, in radii of that."""


class Midline(NamedTuple):
    """A way along the middle of a part."""

    points: FloatArray
    """(P, 2)."""
    radii: FloatArray
    """(P,) of the largest discs in the part there."""
    median: float
    """Of the radii."""

    @property
    def length(self) -> float:
        """Length of the way."""
        return float(along_path(self.points)[-1])

    @property
    def slenderness(self) -> float:
        """Length in radii."""
        return self.length / self.median


class PartAxis:
    """The medial axis of a part's largest component. Ways are lists of points of the axis."""

    def __init__(self, axis: MedialAxis) -> None:
        self.points, self.radii, self.links = axis.points, axis.radii, axis.links
        self._axis, self._nodes = axis, list(axis.links)

    @classmethod
    def of(cls, part: PuppetPart) -> PartAxis | None:
        """The axis of a part; None where it is too round to have one."""
        try:
            axis = pruned(_joined(medial_axis(largest_component(part.outline))), PROTRUDES)
        except (NestedCagesError, scipy.spatial.QhullError):
            return None
        return cls(axis) if len(axis.links) >= TIP_POINTS else None

    @cached_property
    def _number(self) -> dict[int, int]:
        return {node: k for k, node in enumerate(self._nodes)}

    @cached_property
    def _graph(self) -> scipy.sparse.csr_array:
        pairs = np.array([(self._number[i], self._number[j]) for i, others in self.links.items() for j in others]).T
        ends = self.points[self._nodes]
        lengths = norm(ends[pairs[0]] - ends[pairs[1]]) + np.finfo(float).tiny
        return scipy.sparse.csr_array((lengths, tuple(pairs)), shape=(len(self._nodes),) * 2)

    def nearest(self, place: tuple[float, float]) -> int:
        """The point of the axis nearest to a place."""
        return self._nodes[int(norm(self.points[self._nodes] - np.array(place)).argmin())]

    def way(self, start: int, end: int | None = None) -> list[int]:
        """The shortest way from a point to another one, or to the farthest one."""
        distance, before = scipy.sparse.csgraph.dijkstra(
            self._graph, indices=self._number[start], return_predecessors=True
        )
        found = [int(distance.argmax()) if end is None else self._number[end]]
        while before[found[-1]] >= 0:
            found.append(int(before[found[-1]]))
        return [self._nodes[k] for k in found[::-1]]

    @cached_property
    def longest(self) -> list[int]:
        """The way between the two points that are farthest apart."""
        return self.way(self.way(self._nodes[0])[-1])

    def fork(self, way: list[int]) -> tuple[int, int] | None:
        """Where the longest other branch leaves a way, if it is about as long as the rest of that, and its tip."""
        along = along_path(self.points[way])
        best = (0.0, 0, way[0])
        for k, at in enumerate(way):
            for side in self.links[at] - {*way}:
                branch, waiting = {side}, [side]
                while waiting:
                    fresh = self.links[waiting.pop()] - branch - {at}
                    branch |= fresh
                    waiting += fresh
                tip = max(branch, key=lambda point: float(norm(self.points[point] - self.points[at])))
                length = float(along_path(self.points[self.way(at, tip)])[-1])
                best = max(best, (length, k, tip))
        length, k, tip = best
        return (way[k], tip) if length > 0.0 and length >= FORKED * (along[-1] - along[k]) else None

    def branch(self, fork: int, tip: int) -> list[int]:
        """The way from a fork to a tip, from where it leaves the fork's disc."""
        way = self.way(fork, tip)
        away = norm(self.points[way] - self.points[fork])
        return way[int((away > LEAVES_FORK * self.radii[fork]).argmax()) :]

    def midline(self, way: list[int], begin: FloatArray | None = None, *, from_tip: bool = False) -> Midline | None:
        """A way that goes on to the tip, from a place, from its own first point, or from the tip before that; None if
        it is too short."""
        way = trimmed(self._axis, way)
        way = trimmed(self._axis, way[::-1])[::-1] if from_tip else way
        if len(way) < TIP_POINTS:
            return None
        points, radii = self.points[way], self.radii[way]
        start = begin if begin is not None else _beyond(points[::-1], radii[::-1]) if from_tip else points[0]
        first = 0
        if begin is not None:
            ahead = norm(points - begin) > radii.min()
            first = int(ahead.argmax()) if ahead.any() else 0
        places = np.concatenate(([start], points[first:], [_beyond(points, radii)]))
        return Midline(places, np.concatenate(([radii[first]], radii[first:], [radii[-1]])), float(np.median(radii)))


def _beyond(points: FloatArray, radii: FloatArray) -> FloatArray:
    """(2,) a little beyond the last of some points."""
    ahead = points[-1] - points[-TIP_POINTS]
    return np.asarray(points[-1] + TIP_REACH * radii[-1] * ahead / (float(norm(ahead)) or 1.0))


def _joined(axis: MedialAxis) -> MedialAxis:
    """The axis in one piece: where noise was dropped, its pieces are linked where they are nearest."""
    links: Graph = {point: set(others) for point, others in axis.links.items() if others}
    while len(pieces := _pieces_of(links)) > 1:
        one = min(pieces, key=len)
        rest = [point for piece in pieces if piece is not one for point in piece]
        gaps, nearest = scipy.spatial.cKDTree(axis.points[rest]).query(axis.points[one])
        k = int(gaps.argmin())
        links[one[k]].add(rest[int(nearest[k])])
        links[rest[int(nearest[k])]].add(one[k])
    return MedialAxis(axis.points, axis.radii, links)


def _pieces_of(links: Graph) -> list[list[int]]:
    found, seen = list[list[int]](), set[int]()
    for start in links:
        if start not in seen:
            seen.add(start)
            found.append([start])
            for point in found[-1]:  # grows
                found[-1] += sorted(links[point] - seen)
                seen |= links[point]
    return found


def largest_component(mesh: Mesh) -> Mesh:
    """The largest outer loop of a mesh with its holes."""
    component = mesh.component_of_loop
    areas = np.bincount(component, mesh.loop_areas)
    if len(areas) == 1:
        return mesh
    return Mesh.from_loops([ring for ring, owner in zip(mesh.rings, component, strict=True) if owner == areas.argmax()])
