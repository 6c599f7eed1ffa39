"""Energies: values against shapely, derivatives against central differences, E_cont against shapely."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
import shapely

from nestedcages_core import (
    IPC,
    Area,
    BoundaryARAP,
    ElementEnergy,
    InitialDisplacement,
    InteriorARAP,
    Mesh,
    NestedCagesError,
    NoEnergy,
    Settings,
    ShapeKeeping,
    StepDisplacement,
    WeightedSum,
    nested_cages,
)
from nestedcages_core.energies import Blocks, CageEnergy, Energy
from nestedcages_core.energies.restoring import Restoring
from support.marks import slow_after
from support.shapes import annulus, assert_nested, derivative, octagon_with_hole, ring, star


@pytest.fixture
def plate() -> Mesh:
    """A wobbly disc with a hole, so that loops of both orientations occur."""
    wobble = np.random.default_rng(2).normal(scale=0.02, size=(16, 2))
    return Mesh.from_loops([ring(10, 1.0) + wobble[:10], ring(6, 0.5) + wobble[10:]])


@dataclass(frozen=True)
class Springs(CageEnergy):
    """Σ (|b - a| - 1/3)² over the edges a → b, with what an energy of one's own has to define."""

    def value(self, vertices: np.ndarray, successor: np.ndarray) -> float:
        return float(((np.hypot(*(vertices[successor] - vertices).T) - REST) ** 2).sum())

    def gradient(self, vertices: np.ndarray, successor: np.ndarray) -> np.ndarray:
        edge = vertices[successor] - vertices
        pull = 2.0 * (1.0 - REST / np.hypot(*edge.T))[:, None] * edge
        gradient = -pull
        gradient[successor] += pull
        return gradient

    def hessian(self, vertices: np.ndarray, successor: np.ndarray) -> Blocks:
        edge = vertices[successor] - vertices
        length, vertex = np.hypot(*edge.T)[:, None, None], np.arange(len(edge))
        along = edge[:, :, None] * edge[:, None, :] / length**2
        block = 2.0 * ((1.0 - REST / length) * np.eye(2) + REST / length * along)
        one = Blocks.sum([(1.0, Blocks(vertex, vertex, block)), (1.0, Blocks(successor, successor, block))])
        return Blocks.sum([(1.0, one), (-1.0, Blocks(vertex, successor, block))])


REST = 1.0 / 3.0

ENERGIES: list[Energy] = [
    Springs(),
    Area(),
    NoEnergy(),
    StepDisplacement(),
    InitialDisplacement(),
    BoundaryARAP(),
    InteriorARAP(),
    ShapeKeeping(strength=0.7),
    WeightedSum(((2.0, Area()), (0.5, BoundaryARAP()))),
    ElementEnergy.per_turn(lambda now, rest: (now[1] - now[0]).cross(now[2] - now[1]) ** 2),
]
BY_NAME = pytest.mark.parametrize("energy", ENERGIES, ids=lambda energy: type(energy).__name__)


@pytest.fixture
def moved(plate: Mesh) -> np.ndarray:
    """The plate squeezed in one direction and stretched in the other, so that cells of all kinds are strained."""
    wobble = np.random.default_rng(3).normal(scale=0.04, size=plate.vertices.shape)
    return plate.vertices * [0.8, 1.3] + wobble


@BY_NAME
class TestEveryEnergy:
    def test_gradient_agrees_with_differences(self, energy: Energy, plate: Mesh, moved: np.ndarray) -> None:
        bound = energy.at(plate)
        expected = derivative(lambda x: bound.value(x, plate.successor), moved)
        assert bound.gradient(moved, plate.successor) == pytest.approx(expected, abs=1e-8)

    def test_hessian_agrees_with_differences(self, energy: Energy, plate: Mesh, moved: np.ndarray) -> None:
        bound, count = energy.at(plate), len(moved)
        expected = derivative(lambda x: bound.gradient(x, plate.successor), moved)
        hessian = bound.hessian(moved, plate.successor).dense(count).reshape(count, 2, count, 2)
        assert hessian == pytest.approx(expected, abs=1e-7)

    def test_projected_hessian_is_semi_definite_and_no_less(
        self, energy: Energy, plate: Mesh, moved: np.ndarray
    ) -> None:
        bound, count = energy.at(plate), len(moved)
        exact = bound.hessian(moved, plate.successor).dense(count)
        projected = bound.projected_hessian(moved, plate.successor).dense(count)
        assert np.linalg.eigvalsh(projected)[0] > -1e-12
        assert np.linalg.eigvalsh(projected - exact)[0] > -1e-12

    def test_three_vertices_are_enough(self, energy: Energy) -> None:
        """The cells of a triangle meet themselves: neighbours of neighbours are neighbours."""
        triangle = Mesh.from_loops([ring(3)])
        bound = energy.at(triangle)
        x = triangle.vertices * [0.9, 1.2] + [[0.1, 0.0], [0.0, 0.2], [0.05, 0.1]]
        gradient = derivative(lambda x: bound.value(x, triangle.successor), x)
        hessian = derivative(lambda x: bound.gradient(x, triangle.successor), x)
        assert bound.gradient(x, triangle.successor) == pytest.approx(gradient, abs=1e-8)
        assert bound.hessian(x, triangle.successor).dense(3) == pytest.approx(hessian.reshape(6, 6), abs=1e-7)


AT_REST = (NoEnergy(), StepDisplacement(), InitialDisplacement(), BoundaryARAP(), InteriorARAP())


@pytest.mark.parametrize("energy", AT_REST, ids=lambda energy: type(energy).__name__)
def test_the_coarse_mesh_is_at_rest(energy: Energy, plate: Mesh) -> None:
    bound = energy.at(plate)
    assert abs(bound.value(plate.vertices, plate.successor)) < 1e-28
    assert np.abs(bound.gradient(plate.vertices, plate.successor)).max() < 1e-14


def turned(vertices: np.ndarray, angle: float, scale: float = 1.0) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return scale * vertices @ np.array([[c, s], [-s, c]]) + [0.3, -2.0]


@pytest.mark.parametrize("angle", [0.4, 2.0, np.pi, 5.0])
def test_rigid_energies_do_not_see_rotations(plate: Mesh, angle: float) -> None:
    for energy in (BoundaryARAP(), InteriorARAP()):
        bound = energy.at(plate)
        assert bound.value(turned(plate.vertices, angle), plate.successor) < 1e-26
        assert bound.value(turned(plate.vertices, angle, 1.5), plate.successor) > 1e-3


def test_interior_rigidity_is_the_area_times_the_squared_strain(plate: Mesh) -> None:
    """Half as wide and twice as high: J - R = diag(-1/2, 1) everywhere, whatever the triangles are."""
    area = shapely.Polygon(plate.vertices[:10], [plate.vertices[10:]]).area
    value = InteriorARAP().at(plate).value(plate.vertices * [0.5, 2.0], plate.successor)
    assert value == pytest.approx(0.5 * area * 1.25, rel=1e-12)


def test_boundary_rigidity_of_a_scaled_cage_weighs_each_edge_by_its_length(plate: Mesh) -> None:
    lengths = plate.edge_lengths
    value = BoundaryARAP().at(plate).value(turned(plate.vertices, 0.7, 1.3), plate.successor)
    assert value == pytest.approx(0.5 * 0.3**2 * lengths.mean() * lengths.sum(), rel=1e-12)


def test_shape_keeping_sees_only_area_in_a_scaled_cage(plate: Mesh) -> None:
    scaled = turned(plate.vertices, 0.0, 0.7)
    value = ShapeKeeping().at(plate).value(scaled, plate.successor)
    assert value == pytest.approx(Area().value(scaled, plate.successor), rel=1e-14)


@pytest.mark.parametrize("corners", [8, 12, 16])
def test_shape_keeping_keeps_mirror_images(corners: int) -> None:
    """Left and right of the cage of a star, in a ring with the same mirror axis, differ by round-off alone."""
    fine, coarse = star(6, 120), Mesh.from_loops([ring(corners, 1.2, np.pi / corners)])
    cage = nested_cages(fine, [coarse], Settings(energy=ShapeKeeping())).levels[0].cage.vertices
    mirrored = cage * [-1.0, 1.0]
    assert np.hypot(*(cage[:, None] - mirrored[None]).T).min(axis=0).max() < 1e-8


def test_displacement_of_one_edge_length_weighs_half_the_boundary_times_it(plate: Mesh) -> None:
    length = plate.edge_lengths.mean()
    value = InitialDisplacement().at(plate).value(plate.vertices + np.array([length, 0.0]), plate.successor)
    assert value == pytest.approx(0.5 * plate.edge_lengths.sum() * length, rel=1e-14)


def test_only_the_step_displacement_follows_the_steps(plate: Mesh, moved: np.ndarray) -> None:
    for energy in (StepDisplacement(), WeightedSum(((2.0, StepDisplacement()),))):
        assert energy.at(plate).after(moved).value(moved, plate.successor) == 0.0
    for energy in (InitialDisplacement(), BoundaryARAP(), InteriorARAP()):
        bound = energy.at(plate)
        assert bound.after(moved).value(moved, plate.successor) == bound.value(moved, plate.successor) > 0.0


def test_a_sum_is_as_infinite_as_its_terms(plate: Mesh) -> None:
    energy = WeightedSum(((1.0, InitialDisplacement()), (1.0, Area()))).at(plate)
    assert energy.value(plate.vertices * [-1.0, 1.0], plate.successor) == np.inf
    assert Area().value(plate.vertices * [-1.0, 1.0], plate.successor) == np.inf


@pytest.mark.parametrize("energy", slow_after(4, ENERGIES[:8]), ids=lambda energy: type(energy).__name__)
def test_cages_of_every_energy_are_certified(energy: Energy) -> None:
    for coarse in (octagon_with_hole(), 10):
        level = nested_cages(annulus(24, 0.45), [coarse], Settings(energy=energy)).levels[0]
        assert_nested(level.cage, level.fine)
        assert (level.reinflation.fine_steps[-1] == level.fine.vertices).all()


def test_each_energy_gets_what_it_asks_for() -> None:
    """Of the cages of one fine mesh, that of the area is the tightest, that of each rest state the nearest to it."""
    fine, coarse = annulus(32, 0.4), octagon_with_hole(0.3)
    cages, chosen = {}, (Area(), InitialDisplacement(), BoundaryARAP(), InteriorARAP())
    for energy in chosen:
        cages[energy] = nested_cages(fine, [coarse], Settings(energy=energy)).levels[0].cage
    for energy in chosen:
        bound = energy.at(coarse)
        values = {other: bound.value(cage.vertices, coarse.successor) for other, cage in cages.items()}
        assert values[energy] <= 1.001 * min(values.values())


def test_the_way_home_can_have_an_energy_of_its_own() -> None:
    fine, coarse = annulus(24, 0.45), octagon_with_hole()
    contact = IPC(energy=StepDisplacement())
    tight = nested_cages(fine, [coarse], Settings(energy=Area(), contact=contact)).levels[0]
    loose = nested_cages(fine, [coarse], Settings(energy=NoEnergy(), contact=contact)).levels[0]
    assert tight.report.excess < loose.report.excess
    assert loose.report.iterations["tightening"] == 0


def test_area_agrees_with_shapely_far_from_the_origin(plate: Mesh) -> None:
    expected = shapely.Polygon(plate.vertices[:10], [plate.vertices[10:]]).area
    assert Area().value(plate.vertices, plate.successor) == pytest.approx(expected, rel=1e-14)
    assert Area().value(plate.vertices + 1e6, plate.successor) == pytest.approx(expected, rel=1e-8)


def test_blocks_add_up_and_are_symmetric() -> None:
    value = np.array([[[1.0, 2.0], [3.0, 4.0]], [[1.0, 0.0], [0.0, 1.0]], [[1.0, 0.0], [0.0, 1.0]]])
    matrix = Blocks(np.array([0, 1, 1]), np.array([1, 1, 1]), value).dense(2)
    assert matrix.tolist() == [[0, 0, 1, 2], [0, 0, 3, 4], [1, 3, 2, 0], [2, 4, 0, 2]]


def test_restoring_gradient_agrees_with_differences() -> None:
    random = np.random.default_rng(1)
    fine = random.normal(size=(5, 2))
    energy = Restoring(random.normal(size=(5, 2)), random.uniform(size=5))
    assert energy.gradient(fine) == pytest.approx(derivative(energy.value, fine), abs=1e-8)


@pytest.mark.parametrize(
    ("term", "sentence"),
    [
        *(((weight, NoEnergy()), "weights must be finite and at least 0, not") for weight in (-1.0, np.inf, np.nan)),
        *(((1.0, term), r"a term must be an energy such as Area\(\), not") for term in (Area, "area", None)),
    ],
)
def test_a_weighted_sum_takes_energies_with_weights_from_zero(term: tuple[float, Energy], sentence: str) -> None:
    with pytest.raises(NestedCagesError, match=f"WeightedSum: {sentence}"):
        WeightedSum(((1.0, Area()), term))
