"""Energies: values against shapely, derivatives against differences, and cages that have the least of each."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import Area, Blocks, BoundaryARAP, ElementEnergy, InitialDisplacement, InteriorARAP, Mesh
from support.judging import rejected
from support.marks import slow_after
from support.shapes import annulus, assert_nested, derivative, octagon_with_hole, ring, star, turned

REST = 1.0 / 3.0
SHIFT = np.array([0.3, -2.0])


@dataclass(frozen=True)
class Springs(core.CageEnergy):
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


ENERGIES: list[Any] = [
    Springs(), Area(), core.NoEnergy(), core.StepDisplacement(), InitialDisplacement(), BoundaryARAP(), InteriorARAP(),
    core.ShapeKeeping(strength=0.7), core.WeightedSum(((2.0, Area()), (0.5, BoundaryARAP()))),
    ElementEnergy.per_turn(lambda now, rest: (now[1] - now[0]).cross(now[2] - now[1]) ** 2),
    ElementEnergy.per_edge(lambda now, rest: ((now[1] - now[0]).length() / (rest[1] - rest[0]).length()) ** 3),
]  # fmt: skip
BY_NAME = pytest.mark.parametrize("energy", ENERGIES, ids=lambda energy: type(energy).__name__)


@pytest.fixture
def plate() -> Mesh:
    """A wobbly disc with a hole, so that loops of both orientations occur."""
    wobble = np.random.default_rng(2).normal(scale=0.02, size=(16, 2))
    return Mesh.from_loops([ring(10, 1.0) + wobble[:10], ring(6, 0.5) + wobble[10:]])


@pytest.fixture
def moved(plate: Mesh) -> np.ndarray:
    """The plate squeezed in one direction and stretched in the other, so that cells of all kinds are strained."""
    wobble = np.random.default_rng(3).normal(scale=0.04, size=plate.vertices.shape)
    return plate.vertices * [0.8, 1.3] + wobble


@pytest.fixture
def triangle() -> Mesh:
    """The cells of its vertices meet themselves: neighbours of neighbours are neighbours."""
    return Mesh.from_loops([ring(3)])


def assert_derivatives(energy: Any, x: np.ndarray, successor: np.ndarray) -> None:
    """Of a bound energy, by differences; its projected Hessian is semi-definite, and no less than the Hessian."""
    gradient = derivative(lambda at: energy.value(at, successor), x)
    assert energy.gradient(x, successor) == pytest.approx(gradient, abs=1e-8 * max(1.0, np.abs(gradient).max()))
    exact = energy.hessian(x, successor).dense(len(x))
    hessian = derivative(lambda at: energy.gradient(at, successor), x).reshape(exact.shape)
    size = max(1.0, np.abs(hessian).max())
    assert exact == pytest.approx(hessian, abs=1e-7 * size)
    projected = energy.projected_hessian(x, successor).dense(len(x))
    assert np.linalg.eigvalsh(projected)[0] > -1e-12 * size
    assert np.linalg.eigvalsh(projected - exact)[0] > -1e-12 * size


@BY_NAME
def test_derivatives_agree_with_differences(energy: Any, plate: Mesh, moved: np.ndarray, triangle: Mesh) -> None:
    assert_derivatives(energy.at(plate), moved, plate.successor)
    squeezed = triangle.vertices * [0.9, 1.2] + [[0.1, 0.0], [0.0, 0.2], [0.05, 0.1]]
    assert_derivatives(energy.at(triangle), squeezed, triangle.successor)


@BY_NAME
def test_our_own_energies_obey_what_they_must(energy: Any) -> None:
    core.check_energy(energy)


@dataclass(frozen=True)
class Wrong(Springs):
    """Springs, one of whose methods a function changes."""

    method: str
    change: Callable[[Any], Any]

    def changed(self, method: str, found: Any) -> Any:
        return self.change(found) if method == self.method else found

    def value(self, vertices: np.ndarray, successor: np.ndarray) -> float:
        return self.changed("value", super().value(vertices, successor))

    def gradient(self, vertices: np.ndarray, successor: np.ndarray) -> np.ndarray:
        return self.changed("gradient", super().gradient(vertices, successor))

    def hessian(self, vertices: np.ndarray, successor: np.ndarray) -> Blocks:
        return self.changed("hessian", super().hessian(vertices, successor))

    def projected_hessian(self, vertices: np.ndarray, successor: np.ndarray) -> Blocks:
        return self.changed("projected_hessian", super().projected_hessian(vertices, successor))


WRONG = [
    ("value", lambda value: np.nan, "the value nan"),
    ("value", lambda value: value + np.random.default_rng().normal(), "each time"),
    ("gradient", lambda gradient: gradient[:-1], "of the shape"),
    ("gradient", lambda gradient: -gradient, "not the derivative of its value"),
    ("hessian", lambda blocks: Blocks.sum([(2.0, blocks)]), "not the derivative of its gradient"),
    ("projected_hessian", lambda blocks: Blocks.sum([(-1.0, blocks)]), "positive semi-definite"),
    ("projected_hessian", lambda blocks: Blocks.sum([(0.5, blocks)]), "at least the Hessian"),
]


@pytest.mark.parametrize(("method", "change", "said"), WRONG, ids=[f"{row[0]}: {row[2]}" for row in WRONG])
def test_what_an_energy_does_wrong_is_named(method: str, change: Any, said: str) -> None:
    with rejected("method.wrong", name="Wrong") as caught:
        core.check_energy(Wrong(method, change))
    assert said in str(caught.value)


AT_REST = (core.NoEnergy(), core.StepDisplacement(), InitialDisplacement(), BoundaryARAP(), InteriorARAP())


@pytest.mark.parametrize("energy", AT_REST, ids=lambda energy: type(energy).__name__)
def test_the_coarse_mesh_is_at_rest(energy: Any, plate: Mesh) -> None:
    bound = energy.at(plate)
    assert abs(bound.value(plate.vertices, plate.successor)) < 1e-28
    assert np.abs(bound.gradient(plate.vertices, plate.successor)).max() < 1e-14


@pytest.mark.parametrize("angle", [0.4, 2.0, np.pi, 5.0])
def test_rigid_energies_do_not_see_rotations(plate: Mesh, angle: float) -> None:
    for energy in (BoundaryARAP(), InteriorARAP()):
        bound = energy.at(plate)
        assert bound.value(turned(plate.vertices, angle) + SHIFT, plate.successor) < 1e-26
        assert bound.value(1.5 * turned(plate.vertices, angle) + SHIFT, plate.successor) > 1e-3


def test_values_that_are_known(plate: Mesh) -> None:
    lengths, area = plate.edge_lengths, shapely.Polygon(plate.vertices[:10], [plate.vertices[10:]]).area
    known: list[tuple[Any, np.ndarray, float]] = [
        # half as wide and twice as high: J - R = diag(-1/2, 1) everywhere, whatever the triangles are
        (InteriorARAP(), plate.vertices * [0.5, 2.0], 0.5 * area * 1.25),
        # scaled, each edge weighs by its length
        (BoundaryARAP(), 1.3 * turned(plate.vertices, 0.7) + SHIFT, 0.5 * 0.3**2 * lengths.mean() * lengths.sum()),
        # scaled, the area alone is seen
        (core.ShapeKeeping(), 0.7 * plate.vertices + SHIFT, Area().value(0.7 * plate.vertices, plate.successor)),
        # moved by one mean edge length
        (InitialDisplacement(), plate.vertices + np.array([lengths.mean(), 0.0]), 0.5 * lengths.sum() * lengths.mean()),
        (Area(), plate.vertices, area),
    ]
    for energy, cage, value in known:
        assert energy.at(plate).value(cage, plate.successor) == pytest.approx(value, rel=1e-12)
    assert Area().value(plate.vertices + 1e6, plate.successor) == pytest.approx(area, rel=1e-8)


def test_only_the_step_displacement_follows_the_steps(plate: Mesh, moved: np.ndarray) -> None:
    for energy in (core.StepDisplacement(), core.WeightedSum(((2.0, core.StepDisplacement()),))):
        assert energy.at(plate).after(moved).value(moved, plate.successor) == 0.0
    for energy in (InitialDisplacement(), BoundaryARAP(), InteriorARAP()):
        bound = energy.at(plate)
        assert bound.after(moved).value(moved, plate.successor) == bound.value(moved, plate.successor) > 0.0


def test_a_sum_is_as_infinite_as_its_terms(plate: Mesh) -> None:
    energy = core.WeightedSum(((1.0, InitialDisplacement()), (1.0, Area()))).at(plate)
    assert energy.value(plate.vertices * [-1.0, 1.0], plate.successor) == np.inf
    assert Area().value(plate.vertices * [-1.0, 1.0], plate.successor) == np.inf


def test_blocks_add_up_and_are_symmetric() -> None:
    value = np.array([[[1.0, 2.0], [3.0, 4.0]], [[1.0, 0.0], [0.0, 1.0]], [[1.0, 0.0], [0.0, 1.0]]])
    matrix = Blocks(np.array([0, 1, 1]), np.array([1, 1, 1]), value).dense(2)
    assert matrix.tolist() == [[0, 0, 1, 2], [0, 0, 3, 4], [1, 3, 2, 0], [2, 4, 0, 2]]


@pytest.mark.parametrize("wrong", [(-1.0, Area()), (np.inf, Area()), (np.nan, Area()), (1.0, Area), (1.0, None)])
def test_a_weighted_sum_takes_energies_with_weights_from_zero(wrong: Any) -> None:
    with rejected("setting.invalid"):
        core.WeightedSum(((1.0, Area()), wrong))


@pytest.mark.parametrize("corners", [8, 12, 16])
def test_shape_keeping_keeps_mirror_images(corners: int) -> None:
    """Left and right of the cage of a star, in a ring with the same mirror axis, differ by round-off alone."""
    fine, coarse = star(6, 120), Mesh.from_loops([ring(corners, 1.2, np.pi / corners)])
    cage = core.nested_cages(fine, [coarse], core.Settings(energy=core.ShapeKeeping())).levels[0].cage.vertices
    mirrored = cage * [-1.0, 1.0]
    assert np.hypot(*(cage[:, None] - mirrored[None]).T).min(axis=0).max() < 1e-8


@pytest.mark.parametrize("energy", slow_after(4, ENERGIES[:8]), ids=lambda energy: type(energy).__name__)
def test_cages_of_every_energy_are_certified(energy: Any) -> None:
    for coarse in (octagon_with_hole(), 10):
        level = core.nested_cages(annulus(24, 0.45), [coarse], core.Settings(energy=energy)).levels[0]
        assert_nested(level.cage, level.fine)
        assert (level.reinflation.fine_steps[-1] == level.fine.vertices).all()


def test_each_energy_gets_what_it_asks_for() -> None:
    """Of the cages of one fine mesh, that of the area is the tightest, that of each rest state the nearest to it."""
    fine, coarse = annulus(32, 0.4), octagon_with_hole(0.3)
    cages, chosen = {}, (Area(), InitialDisplacement(), BoundaryARAP(), InteriorARAP())
    for energy in chosen:
        cages[energy] = core.nested_cages(fine, [coarse], core.Settings(energy=energy)).levels[0].cage
    for energy in chosen:
        bound = energy.at(coarse)
        values = {other: bound.value(cage.vertices, coarse.successor) for other, cage in cages.items()}
        assert values[energy] <= 1.001 * min(values.values())


def test_the_way_home_can_have_an_energy_of_its_own() -> None:
    fine, coarse = annulus(24, 0.45), octagon_with_hole()
    contact = core.IPC(energy=core.StepDisplacement())
    tight = core.nested_cages(fine, [coarse], core.Settings(energy=Area(), contact=contact)).levels[0]
    loose = core.nested_cages(fine, [coarse], core.Settings(energy=core.NoEnergy(), contact=contact)).levels[0]
    assert tight.report.excess < loose.report.excess
    assert loose.report.iterations["tightening"] == 0


FORMULAS: dict[str, Callable[[Any, Any], Any]] = {
    "+": lambda u, v: u + v + 1.5, "-": lambda u, v: 2.0 - (u - v) - 0.5, "-u": lambda u, v: -u * +v,
    "*": lambda u, v: 3.0 * u * v * u, "/": lambda u, v: u / v + 1.0 / v + v / 7.0,
    "u ** 3": lambda u, v: u**3 * v**-1.5, "u ** v": lambda u, v: u**v + 2.0**v,
    "square": lambda u, v: np.square(u) * np.reciprocal(v), "sqrt": lambda u, v: np.sqrt(u * v),
    "exp": lambda u, v: np.exp(u - v), "log": lambda u, v: np.log(u + 2.0 * v),
    "sin": lambda u, v: np.sin(u * v), "cos": lambda u, v: np.cos(u) * v, "arctan": lambda u, v: np.arctan(u / v),
    "arctan2": lambda u, v: np.arctan2(u - 1.4, v - 1.0) + np.arctan2(u, 2.0) + np.arctan2(-1.0, v),
    "hypot": lambda u, v: np.hypot(u, v) + np.hypot(u, 1.0), "abs": lambda u, v: np.abs(u - 1.5) * v,
    "max": lambda u, v: np.maximum(u, v) * np.maximum(u, 1.2),
    "min": lambda u, v: np.minimum(u, v) * np.minimum(1.2, v),
}  # fmt: skip


@pytest.mark.parametrize("formula", FORMULAS.values(), ids=FORMULAS.keys())
def test_formulas_have_the_derivatives_of_their_values(formula: Callable[[Any, Any], Any], triangle: Mesh) -> None:
    """Of coordinates, with functions of numpy."""
    energy = ElementEnergy.per_vertex(lambda now, rest: formula(now[0].x, now[0].y)).at(triangle)
    random = np.random.default_rng(5)
    for _ in range(8):
        x = random.uniform(0.6, 2.0, size=(3, 2))
        assert energy.value(x, triangle.successor) == pytest.approx(formula(*x.T).sum(), rel=1e-13)
        gradient = derivative(lambda at: energy.value(at, triangle.successor), x, 1e-5)
        assert energy.gradient(x, triangle.successor) == pytest.approx(gradient, rel=1e-6, abs=1e-8)
        hessian = derivative(lambda at: energy.gradient(at, triangle.successor), x, 1e-5)
        found = energy.hessian(x, triangle.successor).dense(3)
        assert found == pytest.approx(hessian.reshape(6, 6), rel=1e-5, abs=1e-7)


@pytest.mark.parametrize("power", [0, 1, 2, 3])
def test_small_powers_have_derivatives_at_zero(power: int, triangle: Mesh) -> None:
    energy = ElementEnergy.per_vertex(lambda now, rest: (now[0].x - rest[0].x) ** power).at(triangle)
    x, successor = triangle.vertices, triangle.successor
    assert energy.value(x, successor) == 3.0 * 0.0**power
    assert energy.gradient(x, successor).tolist() == [[float(power == 1), 0.0]] * 3
    assert energy.hessian(x, successor).dense(3).tolist() == np.diag([2.0 * (power == 2), 0.0] * 3).tolist()


def test_points_are_added_and_scaled_as_vectors(triangle: Mesh) -> None:
    energy = ElementEnergy.per_vertex(lambda now, rest: (2.0 * (now[0] + rest[0]) / 4.0 - rest[0] * 0.5).dot(now[0]))
    vertices, successor = np.array([[1.0, 2.0], [3.0, 5.0], [0.0, 4.0]]), triangle.successor
    assert energy.at(triangle).value(vertices, successor) == pytest.approx(0.5 * (vertices**2).sum())


WITHOUT_A_RULE: list[Callable[[Any, Any], Any]] = [
    lambda now, rest: np.tanh(now[0].x),
    lambda now, rest: now[0].x if now[0].x < 1.0 else now[0].y,
    lambda now, rest: rest[0].dot(rest[0]),
]


@pytest.mark.parametrize("formula", WITHOUT_A_RULE, ids=["no derivative rule", "a comparison", "constant"])
def test_formulas_without_derivatives_are_refused(formula: Callable[[Any, Any], Any], triangle: Mesh) -> None:
    with pytest.raises(TypeError):
        ElementEnergy.per_vertex(formula).at(triangle).gradient(triangle.vertices, triangle.successor)


def test_a_formula_without_a_value_is_infinite(plate: Mesh) -> None:
    inside = ElementEnergy.per_vertex(lambda now, rest: -np.log(2.0 - now[0].dot(now[0]))).at(plate)
    assert np.isfinite(inside.value(plate.vertices, plate.successor))
    assert inside.value(3.0 * plate.vertices, plate.successor) == np.inf


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("power", [1.0, 1.5], ids=["no slope", "no curvature"])
def test_a_formula_must_have_derivatives_at_the_coarse_mesh(power: float) -> None:
    """Powers of a length where the length is zero, as all are at the start."""
    energy = ElementEnergy.per_vertex(lambda now, rest: (now[0] - rest[0]).length() ** power)
    with rejected("solver.not_finite"):
        core.nested_cages(
            Mesh.from_loops([ring(30)]), [8], core.Settings(decimation=core.LineCycles(on_curve=False), energy=energy)
        )
