"""The shapes of the paper's figures, redrawn: pairs of a fine and a coarse mesh."""

from __future__ import annotations

import numpy as np

from data import ring
from nestedcages_core import Mesh, OnCurve

Points = np.ndarray
"""(k, 2)."""


def drawings() -> dict[str, tuple[Mesh, Mesh]]:
    """Name -> fine and coarse mesh."""
    thirds = 2.0 * np.pi / 9.0
    return {
        "letter A, 45 + 6 in 32 + 3": figure_2(),
        "figure 3: disc with a hole in a pentagon": (holed(16, 16), holed(5, 5)),
        "figure 4: disc with two holes, one covered": (two_holes(), holed(5, 5)),
        "figure 5: pentagon with a hole in a triangle": (holed(5, 5), holed(3, 3)),
        "octagon with a hole in a square with a hole": (holed(8, 8, 1.0, np.pi / 8), holed(4, 4, 1.0, np.pi / 4)),
        "disc with a hole in an octagon": (holed(32, 32), holed(8, 8)),
        "two discs in one hexagon": (two_discs(), Mesh.from_loops([ring(6, 1.3)])),
        "disc with a hole in a turned triangle": (holed(32, 32), holed(3, 3, 1.0, thirds)),
        "disc with a hole in a very coarse mesh": (holed(32, 32), Mesh.from_loops([ring(5, 1.2), ring(3, 0.9)])),
    }


def holed(outer: int, inner: int, radius: float = 1.0, angle: float = 0.0) -> Mesh:
    """A regular polygon with a hole of half its radius."""
    return Mesh.from_loops([turned(ring(outer, radius), angle), turned(ring(inner, 0.5 * radius), angle)])


def two_holes() -> Mesh:
    """A disc with a large hole in the middle and a small one between that and the rim."""
    return Mesh.from_loops([ring(64, 1.0), ring(32, 0.5), ring(16, 0.2) + np.array([0.75, 0.0])])


def two_discs() -> Mesh:
    """Two discs side by side."""
    return Mesh.from_loops([ring(32, 0.6) + np.array([0.75, 0.0]), ring(32, 0.6) - np.array([0.75, 0.0])])


def letter_a_coarse() -> Mesh:
    """A letter A with arms and a triangular hole."""
    half = [(0.5, 1.1), (0.85, 0.0), (1.5, 0.0), (1.55, 0.3), (1.25, 0.4), (0.95, 1.8), (1.9, 2.15), (1.85, 2.6)]
    half += [(0.72, 2.4), (0.3, 3.8)]
    outline = np.array(half + [(-x, y) for x, y in reversed(half)])
    return Mesh.from_loops([outline, np.array([(-0.3, 1.7), (0.3, 1.7), (0.0, 2.7)])])


def letter_a() -> Mesh:
    """The same with its corners cut."""
    return with_cut_corners(letter_a_coarse())


def figure_2() -> tuple[Mesh, Mesh]:
    """The same with as many vertices as the fine and the coarse mesh of the paper's figures 1 and 2."""
    fine = OnCurve().decimate(letter_a(), [45, 6])
    return fine, OnCurve().decimate(fine, [32, 3])


def star_coarse() -> Mesh:
    """A star with five points, which its mirror images and its turns by a fifth leave as it is."""
    radius = np.tile([1.0, 0.5], 5)
    return Mesh.from_loops([radius[:, None] * turned(ring(10, 1.0), -np.pi / 2.0)])


def star() -> Mesh:
    """The same with its corners cut."""
    return with_cut_corners(star_coarse())


def bean(count: int) -> Mesh:
    """A smooth curve of three waves, bulging and hollow, with an oval hole."""
    points = ring(count, 1.0)
    angle = np.arctan2(points[:, 1], points[:, 0])
    radius = 1.0 + 0.28 * np.cos(2.0 * angle + 0.4) + 0.16 * np.cos(3.0 * angle - 0.7) + 0.05 * np.sin(5.0 * angle)
    hole = ring(count // 2, 0.3) * np.array([1.2, 0.8]) + np.array([0.35, 0.1])
    return Mesh.from_loops([radius[:, None] * points, hole])


def with_cut_corners(mesh: Mesh, pieces: int = 2) -> Mesh:
    """A mesh with its corners cut twice and its edges divided."""
    loops = []
    for loop in mesh.loops:
        points = mesh.vertices[loop]
        for _ in range(2):
            after = np.roll(points, -1, axis=0)
            points = np.stack([0.8 * points + 0.2 * after, 0.2 * points + 0.8 * after], axis=1).reshape(-1, 2)
        after = np.roll(points, -1, axis=0)
        part = np.arange(pieces)[None, :, None] / pieces
        loops.append((points[:, None] * (1.0 - part) + after[:, None] * part).reshape(-1, 2))
    return Mesh.from_loops(loops)


def turned(points: Points, angle: float) -> Points:
    """The points (k, 2) turned about the origin."""
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])
