"""The smallest distance between two boundaries against shapely's."""

from __future__ import annotations

import itertools
from fractions import Fraction

import numpy as np
import pytest
import shapely

from nestedcages_core import check, verify
from nestedcages_core.checker_distance import squared_gaps, whole_numbers
from nestedcages_core.geometry import smallest_gap as room
from nestedcages_core.geometry.predicates import BoxTree
from nestedcages_core.geometry.smallest_gap import smallest_gap
from support.shapes import jagged, ring


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


@pytest.mark.parametrize("gap", [1e-9, 1e-6, 1e-3])
def test_certificate_and_checker_agree_to_the_last_digits(gap: float) -> None:
    """Far from the origin, by clearances just within the tolerance of both and just beyond it."""
    random = np.random.default_rng(7)
    for _ in range(6):
        turn = ring(4, 1.0, float(random.random()))
        around, inside = turn + 1e6, (1.0 - gap) * turn + gap * random.random(2) * 0.1 + 1e6
        edges = [np.stack([loop, np.roll(loop, -1, axis=0)], axis=1) for loop in (around, inside)]
        pairs = [(p, *e) for k in (0, 1) for p in edges[k][:, 0] for e in edges[1 - k]]
        whole, factor = whole_numbers(np.array(pairs))
        squared, length = squared_gaps(*np.moveaxis(whole, 1, 0))
        exact = min(Fraction(*each) for each in zip(squared.tolist(), length.tolist(), strict=True))
        true = float(exact * 10**60) ** 0.5 / 1e30 / factor
        assert true == pytest.approx(gap, rel=0.9)
        assert verify(around, inside).clearance == pytest.approx(true, rel=1e-14)
        for beyond in (0.0, 0.99e-9, 1.01e-9, 1e-6):
            clearance = true * (1.0 + beyond)
            assert bool(verify(around, inside, clearance)) is bool(check(inside, around, clearance)) is (beyond < 1e-9)
