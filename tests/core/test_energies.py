"""Energies: values against shapely, derivatives against central differences, E_cont against shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from nestedcages_core import Mesh
from nestedcages_core.energies import Area, Blocks, CageEnergy
from nestedcages_core.energies.containment import Containment
from nestedcages_core.energies.restoring import Restoring
from shapes import ring

STEP = 1e-6  # of central differences; coordinates are of order 1


@pytest.fixture
def plate() -> Mesh:
    """A wobbly disc with a hole, so that loops of both orientations occur."""
    wobble = np.random.default_rng(2).normal(scale=0.02, size=(16, 2))
    return Mesh.from_loops([ring(10, 1.0) + wobble[:10], ring(6, 0.5) + wobble[10:]])


ENERGIES: list[CageEnergy] = [Area()]


@pytest.mark.parametrize("energy", ENERGIES, ids=lambda energy: type(energy).__name__)
class TestEveryEnergy:
    def test_gradient_agrees_with_differences(self, energy: CageEnergy, plate: Mesh) -> None:
        gradient = energy.gradient(plate.vertices, plate.successor)
        for v in range(len(plate.vertices)):
            for axis in (0, 1):
                step = np.zeros_like(plate.vertices)
                step[v, axis] = STEP
                ahead = energy.value(plate.vertices + step, plate.successor)
                behind = energy.value(plate.vertices - step, plate.successor)
                assert gradient[v, axis] == pytest.approx((ahead - behind) / (2 * STEP), abs=1e-8)

    def test_hessian_agrees_with_differences(self, energy: CageEnergy, plate: Mesh) -> None:
        count = len(plate.vertices)
        hessian = energy.hessian(plate.vertices, plate.successor).dense(count).reshape(count, 2, count, 2)
        for v in range(count):
            for axis in (0, 1):
                step = np.zeros_like(plate.vertices)
                step[v, axis] = STEP
                ahead = energy.gradient(plate.vertices + step, plate.successor)
                behind = energy.gradient(plate.vertices - step, plate.successor)
                assert hessian[:, :, v, axis] == pytest.approx((ahead - behind) / (2 * STEP), abs=1e-7)

    def test_projected_hessian_is_semi_definite_and_no_less(self, energy: CageEnergy, plate: Mesh) -> None:
        count = len(plate.vertices)
        exact = energy.hessian(plate.vertices, plate.successor).dense(count)
        projected = energy.projected_hessian(plate.vertices, plate.successor).dense(count)
        assert np.linalg.eigvalsh(projected)[0] > -1e-12
        assert np.linalg.eigvalsh(projected - exact)[0] > -1e-12


def test_area_agrees_with_shapely_far_from_the_origin(plate: Mesh) -> None:
    expected = shapely.Polygon(plate.vertices[:10], [plate.vertices[10:]]).area
    assert Area().value(plate.vertices, plate.successor) == pytest.approx(expected, rel=1e-14)
    assert Area().value(plate.vertices + 1e6, plate.successor) == pytest.approx(expected, rel=1e-8)


def test_a_negative_area_is_infinitely_bad(plate: Mesh) -> None:
    assert Area().value(plate.vertices * [-1.0, 1.0], plate.successor) == np.inf


def test_blocks_add_up_and_are_symmetric() -> None:
    value = np.array([[[1.0, 2.0], [3.0, 4.0]], [[1.0, 0.0], [0.0, 1.0]], [[1.0, 0.0], [0.0, 1.0]]])
    matrix = Blocks(np.array([0, 1, 1]), np.array([1, 1, 1]), value).dense(2)
    assert matrix.tolist() == [[0, 0, 1, 2], [0, 0, 3, 4], [1, 3, 2, 0], [2, 4, 0, 2]]


def test_restoring_gradient_agrees_with_differences() -> None:
    random = np.random.default_rng(1)
    fine = random.normal(size=(5, 2))
    energy = Restoring(random.normal(size=(5, 2)), random.uniform(size=5))
    gradient = energy.gradient(fine)
    for v in range(5):
        for axis in (0, 1):
            step = np.zeros_like(fine)
            step[v, axis] = STEP
            slope = (energy.value(fine + step) - energy.value(fine - step)) / (2 * STEP)
            assert gradient[v, axis] == pytest.approx(slope, abs=1e-8)


def test_containment_agrees_with_shapely() -> None:
    """Random squares around and across a disc: infinite exactly where boundaries meet or the cage meets itself."""
    random = np.random.default_rng(4)
    fine = Mesh.from_loops([ring(30, 1.0)])
    seen = set()
    for _ in range(200):
        cage = random.uniform(0.8, 2.5, (4, 1)) * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
        cage = cage + random.normal(scale=0.4, size=(4, 2))
        energy = Containment(np.array([1, 2, 3, 0]), fine.successor)
        outline = shapely.LinearRing(cage)
        bad = bool(outline.intersects(shapely.LinearRing(fine.vertices)) or not outline.is_simple)
        assert (energy.value(np.concatenate([cage, fine.vertices])) == np.inf) == bad
        seen.add(bad)
    assert seen == {True, False}
