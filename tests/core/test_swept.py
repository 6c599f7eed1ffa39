"""The region that a motion sweeps, and outlines of an animation for engines."""

from itertools import pairwise

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import Mesh, swept
from support.shapes import ring, star

shapely = pytest.importorskip("shapely")


def test_a_square_that_is_moved_sweeps_a_hexagon() -> None:
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    union = swept(Mesh.from_loops([square]), [square, square + np.array([2.0, 1.0])])
    assert union.area == pytest.approx(1.0 + 2.0 + 1.0)
    assert len(union.loops) == 1


@pytest.mark.slow
def test_all_positions_lie_in_it_and_it_is_hardly_more() -> None:
    fine = star()
    angles = np.linspace(0.0, 1.0, 7)
    turns = [np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in angles]
    poses = np.array([fine.vertices @ turn.T + np.array([2.0 * a, 0.0]) for turn, a in zip(turns, angles, strict=True)])
    union = shapely.geometry.shape(swept(fine, poses).__geo_interface__)
    inside = union.buffer(1e-9)
    between = []
    for before, after in pairwise(poses):
        for share in np.linspace(0.0, 1.0, 9):
            place = shapely.geometry.shape(fine.moved(before + share * (after - before)).__geo_interface__)
            assert inside.contains(place)
            between.append(place)
    assert union.area < 1.02 * shapely.union_all(between).area
    still = core.nested_cages(swept(fine, poses), [24]).cages[0]
    assert all(core.verify(still, fine.moved(pose), same_loops=False) for pose in poses)


def test_a_hole_that_stays_open_is_kept() -> None:
    fine = Mesh.from_loops([ring(40), ring(30, 0.6)])
    union = swept(fine, [fine.vertices, fine.vertices + np.array([0.2, 0.0])])
    assert len(union.loops) == 2
