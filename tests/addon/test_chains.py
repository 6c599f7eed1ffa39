"""Edges to loops: against loops that were cut up and shuffled."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st


@pytest.mark.slow
@given(sizes=st.lists(st.integers(2, 7), min_size=1, max_size=5), closed=st.integers(0, 31), seed=st.integers(0, 2**16))
def test_shuffled_edges_come_back_as_lines(sizes, closed, seed) -> None:
    from nested_cages_extension.addon.scene.chains import chains

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


def test_a_branch_is_found(addon) -> None:
    found = addon.scene.chains.chains(np.array([[0, 1], [1, 2], [1, 3]]), 4)
    assert found.branching.tolist() == [1]
