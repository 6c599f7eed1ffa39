"""Corners of outlines correspond from frame to frame."""

from __future__ import annotations

import numpy as np

from nestedcages_core import Mesh
from nestedcages_core.exchange.pictures import corresponding
from support.shapes import ring


def loops_of(mesh: Mesh) -> list[np.ndarray]:
    return [mesh.vertices[loop] for loop in mesh.loops]


def test_corners_keep_their_order() -> None:
    random = np.random.default_rng(3)
    shape = ring(9) * (1.0 + 0.3 * random.random((9, 1)))
    frames = [Mesh.from_loops([np.roll(shape + 0.1 * k, random.integers(9), axis=0)]) for k in range(5)]
    ordered = corresponding(frames)
    first = loops_of(ordered[0])[0]
    for k, frame in enumerate(ordered):
        assert np.allclose(loops_of(frame)[0], first + 0.1 * k)


def test_parts_and_holes_are_matched() -> None:
    one = [ring(8), ring(5, 0.4), ring(6, 0.5) + np.array([3.0, 0.0])]
    two = [loop + 0.05 for loop in (one[2], one[1], one[0])]
    first, second = corresponding([Mesh.from_loops(one), Mesh.from_loops(two)])
    for a, b in zip(loops_of(first), loops_of(second), strict=True):
        assert np.allclose(a + 0.05, b)


def test_other_numbers_begin_anew() -> None:
    frames = [Mesh.from_loops([ring(8)]), Mesh.from_loops([ring(7)]), Mesh.from_loops([ring(7), ring(4, 0.3)])]
    assert [len(mesh.vertices) for mesh in corresponding(frames)] == [8, 7, 11]
