"""How the loops of two meshes lie in each other."""

from __future__ import annotations

import numpy as np
import pytest

from nestedcages_core import Mesh
from nestedcages_core.geometry.mesh import Nesting
from support.shapes import ring

FINE = Mesh.from_loops([ring(20), ring(12, 0.4)])
AROUND, WITHIN = ring(20, 1.1), ring(12, 0.3)
ASIDE = np.array([0.7, 0.0])


def test_a_cage_encloses_loop_by_loop() -> None:
    assert Nesting(Mesh.from_loops([AROUND, WITHIN]), FINE).encloses_loop_by_loop()


@pytest.mark.parametrize(
    "loops",
    [
        pytest.param([AROUND, ring(12, 0.5)], id="the hole cuts into the solid"),
        pytest.param([ring(20, 0.9), WITHIN], id="the solid sticks out"),
        pytest.param([AROUND, ring(12, 1.05)], id="a thin ring around the boundary only"),
        pytest.param([AROUND, ring(12, 0.05) + ASIDE], id="the hole is in the solid"),
        pytest.param([ring(20), WITHIN], id="touching"),
        pytest.param([AROUND * [0.9, 1.0], WITHIN], id="the solid sticks out on both sides only"),
    ],
)
def test_what_does_not_enclose_is_rejected(loops: list[np.ndarray]) -> None:
    nesting = Nesting(Mesh.from_loops(loops), FINE)
    assert not nesting.encloses()
    assert not nesting.encloses_loop_by_loop()


@pytest.mark.parametrize("others", [[], [WITHIN + 4.0 * ASIDE]], ids=["no other loop", "a component instead"])
def test_a_cage_that_fills_a_hole_encloses_but_not_loop_by_loop(others: list[np.ndarray]) -> None:
    filled = Nesting(Mesh.from_loops([AROUND, *others]), FINE)
    assert filled.encloses()
    assert not filled.encloses_loop_by_loop()


def test_swapped_loops_are_told_from_lost_ones() -> None:
    fine = Mesh.from_loops([ring(12), ring(12) + 3.0])
    swapped = Nesting(Mesh.from_loops([ring(12, 1.2) + 3.0, ring(12, 1.2)]), fine)
    assert swapped.encloses()
    assert not swapped.encloses_loop_by_loop()
    assert Nesting(Mesh.from_loops([ring(12, 1.2), ring(12, 1.2) + 3.0]), fine).encloses_loop_by_loop()
    outside, inside = Nesting(Mesh.from_loops([ring(12, 1.2)]), fine).uncovered
    assert outside.tolist() == [1]
    assert inside.tolist() == []


def test_contact_names_the_edges() -> None:
    square = Mesh.from_loops([[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]])
    touching = Mesh.from_loops([[(0.2, 0.2), (0.8, 0.2), (0.5, 1.0)]])
    assert Nesting(square, touching).contact in {(2, 1), (2, 2)}
    assert Nesting(square, Mesh.from_loops([[(0.2, 0.2), (0.8, 0.2), (0.5, 0.9)]])).contact is None
    assert Nesting(square, square.moved(square.vertices + 0.5)).contact in {(1, 0), (2, 3)}


def test_parents_are_kept_by_moved_and_pickled_meshes() -> None:
    mesh = Mesh.from_loops([ring(12, 3.0), ring(12, 2.0), ring(12, 1.0), ring(12, 1.0) + 9.0])
    assert mesh.parent_of_loop.tolist() == [-1, 0, 1, -1]
    assert mesh.moved(mesh.vertices + 1.0).parent_of_loop.tolist() == [-1, 0, 1, -1]
    assert np.array_equal(mesh.edge_tree.starts, mesh.vertices[mesh.loop_order.numbers])
    assert np.array_equal(mesh.edge_tree.ends, mesh.edge_ends[mesh.loop_order.numbers])


def test_a_tree_and_all_pairs_agree_on_what_lies_in_what(monkeypatch: pytest.MonkeyPatch) -> None:
    random = np.random.default_rng(3)
    many = [
        ring(9, size) + np.array([x, y])
        for size in (0.4, 0.3, 0.1)
        for x in range(6)
        for y in range(int(random.integers(6)))
    ]
    for loops in (many[:7], many):
        meshes = Mesh.from_loops(loops), Mesh.from_loops([0.99 * loop + 0.003 for loop in loops])
        nesting = Nesting(*meshes)
        with monkeypatch.context() as patch:
            patch.setattr("nestedcages_core.geometry.loops.ALL_WINDINGS_LIMIT", -1)
            by_tree = Nesting(*meshes)
            for one, other in zip(nesting.pairs, by_tree.pairs, strict=True):
                assert len(one) > 0
                np.testing.assert_array_equal(one, other)
            assert np.array_equal(Mesh.from_loops(loops).parent_of_loop, meshes[0].parent_of_loop)
