"""Edges to loops, against loops that were cut up and shuffled; and places along outlines."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nestedcages_core import Mesh
from nestedcages_core.coordinates.outline_map import Outline, outline_map
from nestedcages_core.geometry.chains import chains
from shapes import annulus


@pytest.mark.slow
@given(sizes=st.lists(st.integers(2, 7), min_size=1, max_size=5), closed=st.integers(0, 31), seed=st.integers(0, 2**16))
def test_shuffled_edges_come_back_as_lines(sizes, closed, seed) -> None:
    rng = np.random.default_rng(seed)
    count = sum(sizes)
    names = rng.permutation(count)
    edges, expected_closed, expected_open, offset = [], set(), set(), 0
    for number, size in enumerate(sizes):
        line = names[offset : offset + size]
        is_closed = size > 2 and bool(closed >> number & 1)
        for i in range(size if is_closed else size - 1):
            edges.append(rng.permutation([line[i], line[(i + 1) % size]]))
        (expected_closed if is_closed else expected_open).add(frozenset(line.tolist()))
        offset += size
    edges = rng.permutation(np.array(edges))
    found = chains(edges, count)
    assert {frozenset(line.tolist()) for line in found.closed} == expected_closed
    assert {frozenset(line.tolist()) for line in found.opened} == expected_open
    pairs = {frozenset(edge) for edge in edges.tolist()}
    for line in found.closed:
        assert all(frozenset(edge) in pairs for edge in zip(line.tolist(), np.roll(line, -1).tolist(), strict=True))
    for line in found.opened:
        assert all(frozenset(edge) in pairs for edge in zip(line[:-1].tolist(), line[1:].tolist(), strict=True))


def test_a_branch_is_found() -> None:
    found = chains(np.array([[0, 1], [1, 2], [1, 3]]), 4)
    assert found.branching.tolist() == [1]


@pytest.mark.parametrize("scale", [1.0, 0.2])
def test_a_new_outline_is_found_on_the_old_one_loop_by_loop(scale: float) -> None:
    """Halved edges lie in the middle of the old ones, also where the new outline is smaller."""
    old = annulus(40)
    loops = [old.vertices[loop] for loop in old.loops]
    halved = [np.stack([loop, 0.5 * (loop + np.roll(loop, -1, axis=0))], axis=1).reshape(-1, 2) for loop in loops]
    new = Mesh.from_loops([scale * loop for loop in halved])
    points = [np.column_stack([mesh.vertices, np.zeros(len(mesh.vertices))]) for mesh in (old, new)]
    places = outline_map(Outline.of(points[0], old.edges), Outline.of(points[1], new.edges))
    np.testing.assert_allclose(scale * places.of(points[0]), points[1], atol=1e-9)
    assert places.nearest(points[0], 7) == int(np.linalg.norm(points[1] / scale - points[0][7], axis=1).argmin())
    np.testing.assert_allclose(places.part.round(6) % 0.5, 0.0, atol=1e-6)
