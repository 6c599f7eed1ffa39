"""Trees over the fine mesh as a broad phase: built when they are needed, or kept from the steps of the flow.

Gurditta & Jacobson (2022), section 5: a hierarchy would be calculated for each F^(j) in the flow, and could be reused
in the reinflation when F_t = F^(j). Here the tree of the nearest step serves as long as the fine mesh is near: every
search is wider by the largest distance of a vertex from its place in the tree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial import cKDTree

from nestedcages_core.contact.pairs import Bodies, CandidateList, Pairs, find_pairs
from nestedcages_core.geometry.distance import point_edge


@dataclass(frozen=True, eq=False)
class FineTree:
    """Trees over the vertices of the fine mesh and the middles of its edges."""

    vertices: np.ndarray
    points: cKDTree
    middles: cKDTree
    longest: float
    """Half of the longest edge."""

    @classmethod
    def of(cls, vertices: np.ndarray, successor: np.ndarray) -> FineTree:
        """At one position."""
        ends = vertices[successor]
        half = 0.5 * float(np.hypot(*(ends - vertices).T).max())
        return cls(vertices, cKDTree(vertices), cKDTree(0.5 * (vertices + ends)), half)

    def pairs(self, bodies: Bodies, x: np.ndarray, radius: float) -> Pairs:
        """As :func:`nestedcages_core.contact.pairs.find_pairs`, for one radius."""
        m = bodies.m
        cage, fine = x[:m], x[m:]
        away = float(np.hypot(*(fine - self.vertices).T).max())
        ends, fine_ends = cage[bodies.cage_successor], fine[bodies.fine_successor]
        reach = radius + away + 0.5 * np.hypot(*(ends - cage).T)
        near = self.points.query_ball_point(0.5 * (cage + ends), reach)
        edge, vertex = _flat(near)
        keep = point_edge(fine[vertex], cage[edge], ends[edge]).distance < radius
        edge, vertex = edge[keep], vertex[keep]
        near = self.middles.query_ball_point(cage, radius + away + self.longest)
        corner, fine_edge = _flat(near)
        keep = point_edge(cage[corner], fine[fine_edge], fine_ends[fine_edge]).distance < radius
        corner, fine_edge = corner[keep], fine_edge[keep]
        own = _own_pairs(bodies, x, radius)
        first, second = len(edge), len(edge) + len(corner)
        return Pairs(
            np.concatenate([vertex + m, corner, own.point]),
            np.concatenate([edge, fine_edge + m, own.start]),
            np.concatenate([bodies.cage_successor[edge], bodies.fine_successor[fine_edge] + m, own.end]),
            slice(0, first), slice(first, second), slice(second, second + len(own)),
        )  # fmt: skip


def _flat(lists: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Owner and member of every entry."""
    owner = np.repeat(np.arange(len(lists)), [len(members) for members in lists])
    return owner, np.array([k for members in lists for k in members], np.int64)


def _own_pairs(bodies: Bodies, x: np.ndarray, radius: float) -> Pairs:
    """Those of the cage with itself, which no tree of the fine mesh helps with."""
    found = find_pairs(bodies, np.concatenate([x[: bodies.m], np.full((bodies.n, 2), 1e6)]), radius)
    own = np.zeros(len(found), bool)
    own[found.cage_cage] = True
    return found.subset(own)


@dataclass(frozen=True)
class NewTrees:
    """A broad phase with a tree for every search."""

    def candidates(self, bodies: Bodies) -> CandidateList:
        """A list of pairs found by it."""

        def find(bodies: Bodies, x: np.ndarray, radius: float) -> Pairs:
            return FineTree.of(x[bodies.m :], bodies.fine_successor).pairs(bodies, x, radius)

        return CandidateList(bodies, find)


@dataclass(frozen=True)
class KeptTrees:
    """A broad phase with the trees of the flow."""

    trees: Sequence[FineTree] = field(repr=False)

    def candidates(self, bodies: Bodies) -> CandidateList:
        """A list of pairs found by the tree of the nearest step."""

        def find(bodies: Bodies, x: np.ndarray, radius: float) -> Pairs:
            fine = x[bodies.m :]
            nearest = min(self.trees, key=lambda tree: float(np.abs(fine - tree.vertices).max()))
            return nearest.pairs(bodies, x, radius)

        return CandidateList(bodies, find)
