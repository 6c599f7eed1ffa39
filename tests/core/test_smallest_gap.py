"""The smallest distance between two boundaries against shapely's."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import shapely

from nestedcages_core.geometry import smallest_gap as room
from nestedcages_core.geometry.predicates import BoxTree
from nestedcages_core.geometry.smallest_gap import smallest_gap
from shapes import jagged


@pytest.mark.parametrize("crowded", [-1, room.CROWDED])
@pytest.mark.parametrize(("first", "second"), [*itertools.product([3, 4, 5, 16, 17, 700], [3, 5, 64, 300])])
def test_it_is_that_of_all_pairs(first: int, second: int, crowded: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "CROWDED", crowded)
    random = np.random.default_rng(first * second)
    for shift in (0.0, 0.5, 2.5):
        inner, outer = jagged(random, first), 2.6 * jagged(random, second) + np.array([10.0 * shift, shift])
        expected = shapely.LinearRing(inner).distance(shapely.LinearRing(outer))
        trees = [BoxTree(loop, np.roll(loop, -1, axis=0)) for loop in (inner, outer)]
        if expected > 0:
            assert smallest_gap(*trees) == pytest.approx(expected, rel=1e-12)


def test_edges_may_come_in_any_order() -> None:
    random = np.random.default_rng(5)
    inner, outer = jagged(random, 60), 2.6 * jagged(random, 90)
    expected = shapely.LinearRing(inner).distance(shapely.LinearRing(outer))
    mixed = [(loop, np.roll(loop, -1, axis=0), random.permutation(len(loop))) for loop in (inner, outer)]
    trees = [BoxTree(starts[order], ends[order]) for starts, ends, order in mixed]
    assert smallest_gap(*trees) == pytest.approx(expected, rel=1e-12)
