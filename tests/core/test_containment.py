"""E_cont: all pairs and trees agree with shapely on whether the cage meets the fine mesh or itself."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from nestedcages_core.energies.containment_energy import ContainmentEnergy
from nestedcages_core.geometry.predicates import box_tree
from support.shapes import annulus


def meets(cage: np.ndarray, cage_successor: np.ndarray, fine: np.ndarray, fine_successor: np.ndarray) -> bool:
    """By shapely: whether any cage edge meets a fine edge, or a cage edge that is not its neighbour."""
    cage_edges = [shapely.LineString(cage[[v, s]]) for v, s in enumerate(cage_successor)]
    fine_edges = [shapely.LineString(fine[[v, s]]) for v, s in enumerate(fine_successor)]
    if any(c.intersects(f) for c in cage_edges for f in fine_edges):
        return True
    return any(
        cage_edges[i].intersects(cage_edges[j])
        for i in range(len(cage))
        for j in range(i)
        if cage_successor[i] != j and cage_successor[j] != i
    )


@pytest.mark.parametrize("limit", [-1, 4000], ids=["trees", "sweeps"])
def test_contacts_are_those_that_shapely_sees(monkeypatch: pytest.MonkeyPatch, limit: int) -> None:
    monkeypatch.setattr(box_tree, "SWEEP_LIMIT", limit)
    fine, coarse = annulus(20), annulus(10)
    random = np.random.default_rng(5)
    found = []
    for _ in range(30):
        inside = fine.vertices * np.where(np.arange(40) < 20, 0.9, 1.15)[:, None]
        cage = coarse.vertices + 0.06 * random.standard_normal((20, 2))
        expected = meets(cage, coarse.successor, inside, fine.successor)
        energy, x = ContainmentEnergy(coarse.successor, fine.successor), np.concatenate([cage, inside])
        assert (energy.first_contact(x) is not None) == (energy.value(x) == np.inf) == expected
        found.append(expected)
    assert True in found and False in found
