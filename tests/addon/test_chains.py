"""Edges to loops, against loops that were cut up and shuffled; and places along outlines."""

from __future__ import annotations

import numpy as np
import pytest

from support.drawings import circle

SHUFFLES = 20


@pytest.mark.parametrize("seed", range(SHUFFLES))
def test_shuffled_edges_come_back_as_lines(addon, seed) -> None:
    rng = np.random.default_rng(seed)
    sizes = rng.integers(2, 8, rng.integers(1, 6)).tolist()
    count, closed = sum(sizes), int(rng.integers(32))
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
    found = addon.scene.chains.chains(edges, count)
    assert {frozenset(line.tolist()) for line in found.closed} == expected_closed
    assert {frozenset(line.tolist()) for line in found.opened} == expected_open
    pairs = {frozenset(edge) for edge in edges.tolist()}
    for line in found.closed:
        assert all(frozenset(edge) in pairs for edge in zip(line.tolist(), np.roll(line, -1).tolist(), strict=True))
    for line in found.opened:
        assert all(frozenset(edge) in pairs for edge in zip(line[:-1].tolist(), line[1:].tolist(), strict=True))


def test_a_branch_is_found(addon) -> None:
    found = addon.scene.chains.chains(np.array([[0, 1], [1, 2], [1, 3]]), 4)
    assert found.branching.tolist() == [1]


@pytest.mark.parametrize("scale", [1.0, 0.2])
def test_a_new_outline_is_found_on_the_old_one_loop_by_loop(addon, core, scale: float) -> None:
    """Halved edges lie in the middle of the old ones, also where the new outline is smaller."""
    loops = [circle(40), circle(40, 0.5)]
    old = core.Mesh.from_loops(loops)
    halved = [np.stack([loop, 0.5 * (loop + np.roll(loop, -1, axis=0))], axis=1).reshape(-1, 2) for loop in loops]
    new = core.Mesh.from_loops([scale * loop for loop in halved])
    points = [np.column_stack([mesh.vertices, np.zeros(len(mesh.vertices))]) for mesh in (old, new)]
    maps = addon.rigging.outline_map
    places = maps.outline_map(maps.Outline.of(points[0], old.edges), maps.Outline.of(points[1], new.edges))
    np.testing.assert_allclose(scale * places.of(points[0]), points[1], atol=1e-9)
    assert places.nearest(points[0], 7) == int(np.linalg.norm(points[1] / scale - points[0][7], axis=1).argmin())
    np.testing.assert_allclose(places.part.round(6) % 0.5, 0.0, atol=1e-6)
