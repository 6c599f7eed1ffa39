"""Quadratic programs and Newton steps against scipy, equalities against full matrices, factorisations against numpy."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.sparse import coo_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from nestedcages_core import Mesh, Mirror
from nestedcages_core.energies import Blocks
from nestedcages_core.geometry.group import Orbits
from nestedcages_core.solver.banded import BandOrder, Rows, factorised
from nestedcages_core.solver.elimination import Elimination
from nestedcages_core.solver.negative_curvature import negative_curvature
from nestedcages_core.solver.newton import NewtonModel, ProjectedNewton
from nestedcages_core.solver.quadratic_program import InteriorPoint, QuadraticProgram
from support.judging import rejected
from support.marks import slow_after

EXACT = InteriorPoint(iterations=80, complementarity=1e-10, primal=1e-10, dual=1e-10)


# Programs against independent solvers


def random_rows(rng: np.random.Generator, m: int, counts: tuple[int, int, int]) -> list[Rows]:
    """Groups of rows over one, two and three vertices."""
    groups = []
    for width, count in zip((1, 2, 3), counts, strict=True):
        vertex = np.array([rng.permutation(m)[:width] for _ in range(count)], np.int64).reshape(count, width).T
        angle = rng.uniform(0.0, 2.0 * np.pi, count)
        groups.append(Rows(vertex, rng.normal(size=(width, count)), np.stack([np.cos(angle), np.sin(angle)])))
    return groups


def full_rows(groups: list[Rows], m: int) -> np.ndarray:
    """The matrix J, entry by entry."""
    lines = []
    for group in groups:
        for k in range(group.count):
            line = np.zeros((m, 2))
            for j, vertex in enumerate(group.vertex[:, k].tolist()):
                direction = group.direction if group.direction.ndim == 2 else group.direction[j]
                line[vertex] += group.weight[j, k] * direction[:, k]
            lines.append(line.ravel())
    return np.array(lines).reshape(-1, 2 * m)


def random_program(
    seed: int, m: int = 7, counts: tuple[int, int, int] = (6, 9, 5), lacking: float = 0.0
) -> QuadraticProgram:
    """A strictly convex program over a ring of m vertices with a few far couplings; lacking: of each row at rest."""
    rng = np.random.default_rng(seed)
    ring = np.arange(m)
    diagonal = rng.normal(size=(m, 2, 2))
    diagonal = diagonal @ diagonal.transpose(0, 2, 1) + 6.0 * np.eye(2)
    hessian = Blocks(
        np.concatenate([ring, ring]),
        np.concatenate([ring, np.roll(ring, -1)]),
        np.concatenate([diagonal, rng.normal(size=(m, 2, 2))]),
    )
    return QuadraticProgram(
        rng.normal(size=(m, 2)),
        hessian,
        random_rows(rng, m, counts),
        rng.uniform(0.0, 0.2, sum(counts)) - lacking,
        rng.uniform(0.1, 1.0, m),
        turned_axes(m, np.zeros(m)),
    )


def objective(program: QuadraticProgram):
    W, G = program.hessian.dense(len(program.radius)), program.gradient.ravel()
    return lambda d: G @ d + 0.5 * d @ W @ d, lambda d: G + W @ d


@pytest.mark.parametrize(("seed", "lacking"), [*((seed, 0.0) for seed in range(6)), (101, 0.19)])
def test_solution_is_that_of_an_independent_solver(seed: int, lacking: float) -> None:
    program = random_program(seed, lacking=lacking)
    m = len(program.radius)
    J, box = full_rows(program.rows, m), np.repeat(program.radius, 2)
    value, gradient = objective(program)
    reference = minimize(
        value,
        np.zeros(2 * m),
        jac=gradient,
        method="SLSQP",
        bounds=list(zip(-box, box, strict=True)),
        constraints=[{"type": "ineq", "fun": lambda d: program.offset + J @ d, "jac": lambda d: J}],
        options={"ftol": 1e-14, "maxiter": 500},
    )
    solution = EXACT.solve(program)
    assert solution.converged
    np.testing.assert_allclose(solution.step.ravel(), reference.x, atol=1e-6)
    assert -solution.decrease == pytest.approx(reference.fun, rel=1e-8)


@pytest.mark.parametrize("seed", range(3))
def test_soft_rows_give_way_by_their_softness(seed: int) -> None:
    program = random_program(seed)
    m, K = len(program.radius), len(program.offset)
    J, box = full_rows(program.rows, m), np.repeat(program.radius, 2)
    softness = np.random.default_rng(seed).uniform(0.01, 0.5, K)
    offset = program.offset - 0.3  # not all can be met
    value, gradient = objective(program)

    def penalised(d: np.ndarray) -> float:
        return value(d) + 0.5 * float((np.minimum(offset + J @ d, 0.0) ** 2 / softness).sum())

    def slope(d: np.ndarray) -> np.ndarray:
        return gradient(d) + J.T @ (np.minimum(offset + J @ d, 0.0) / softness)

    bounds = list(zip(-box, box, strict=True))
    options = {"ftol": 1e-15}
    reference = minimize(penalised, np.zeros(2 * m), jac=slope, method="L-BFGS-B", bounds=bounds, options=options)
    solution = EXACT.solve(replace(program, offset=offset, softness=softness))
    assert solution.converged
    np.testing.assert_allclose(solution.step.ravel(), reference.x, atol=1e-5)
    missed = np.maximum(-(offset + J @ solution.step.ravel()), 0.0)
    np.testing.assert_allclose(solution.multipliers * softness, missed, atol=1e-7)


@pytest.mark.parametrize(("m", "far"), slow_after(3, [(40, 0), (40, 60), (120, 0), (120, 400)]))
def test_larger_programs_meet_the_conditions_of_an_optimum(m: int, far: int) -> None:
    """With couplings of neighbours, which make a narrow band, and of vertices far from each other, which make none."""
    program = random_program(m, m, (m, 2 * m, m // 2) if far else (m, 0, 0))
    random = np.random.default_rng(far)
    row = random.integers(0, m, far)
    coupled = Blocks(row, (row + random.integers(1, m, far)) % m, 0.3 * random.normal(size=(far, 2, 2)))
    lift = Blocks(np.arange(m), np.arange(m), np.tile(20.0 * np.eye(2), (m, 1, 1)))
    program = replace(program, hessian=Blocks.sum([(1.0, program.hessian), (1.0, coupled), (1.0, lift)]))
    solution = EXACT.solve(replace(program, gradient=30.0 * program.gradient))
    assert solution.converged
    J, W, d = full_rows(program.rows, m), program.hessian.dense(m), solution.step.ravel()
    z, box = solution.multipliers, np.repeat(program.radius, 2)
    slack = program.offset + J @ d
    assert slack.min() > -1e-7
    assert z.min() > -1e-7
    assert np.abs(z * slack).max() < 1e-6
    slope = 30.0 * program.gradient.ravel() + W @ d - J.T @ z
    assert np.abs(d).max() < 1.0
    free = np.abs(d) < box - 1e-6
    assert free.any()
    assert np.abs(slope[free]).max() < 1e-6
    assert (slope * d)[~free].max(initial=-1.0) < 1e-6  # at its bound, a motion would go on


def test_the_bounds_end_the_descent_of_an_indefinite_program() -> None:
    hessian = Blocks(np.arange(4), np.arange(4), np.broadcast_to(np.diag([1.0, -1.0]), (4, 2, 2)))
    program = QuadraticProgram(np.ones((4, 2)), hessian, [], np.zeros(0), np.full(4, 0.1), turned_axes(4, np.zeros(4)))
    solution = EXACT.solve(program)
    assert solution.converged
    np.testing.assert_allclose(np.abs(solution.step[:, 1]), 0.1, atol=1e-6)


def test_nothing_to_gain_takes_no_step() -> None:
    program = random_program(5)
    still = replace(program, gradient=np.zeros_like(program.gradient), scale=1.0)
    assert np.abs(EXACT.solve(still).step).max() < 1e-7


def turned_axes(m: int, angles: np.ndarray) -> np.ndarray:
    """(m, 2, 2) axes turned by the angles."""
    c, s = np.cos(angles), np.sin(angles)
    return np.stack([np.stack([c, s], axis=1), np.stack([-s, c], axis=1)], axis=1).reshape(m, 2, 2)


def test_motions_are_bounded_along_the_axes_of_each_vertex() -> None:
    program = random_program(8)
    m = len(program.radius)
    axes = turned_axes(m, np.linspace(0.0, 2.0, m))
    far = replace(program, gradient=100.0 * program.gradient, axes=axes)
    along = np.einsum("mac,mc->ma", axes, EXACT.solve(far).step)
    assert np.all(np.abs(along) <= program.radius[:, None] * (1.0 + 1e-9))
    assert np.abs(along / program.radius[:, None]).max() > 0.999


def test_derivatives_that_are_no_numbers_are_refused() -> None:
    program = random_program(1)
    value = program.hessian.value.copy()
    value[2, 0, 0] = np.nan
    broken = replace(program, hessian=program.hessian._replace(value=value))
    for solve in (InteriorPoint().solve, lambda given: negative_curvature(given, ORDER, np.zeros(20, bool))):
        with rejected("solver.not_finite"):
            solve(broken)


ORDER = BandOrder.of(7, np.arange(7), np.roll(np.arange(7), -1))


def test_the_softest_motion_keeps_what_is_active_and_has_negative_curvature() -> None:
    m = 6
    ring = np.arange(m)
    saddle = np.broadcast_to(np.diag([1.0, -0.5]), (m, 2, 2))
    couplings = np.broadcast_to(0.05 * np.eye(2), (m, 2, 2))
    hessian = Blocks.sum([(1.0, Blocks(ring, ring, saddle)), (1.0, Blocks(ring, np.roll(ring, -1), couplings))])
    upwards = np.broadcast_to(np.array([[0.0], [1.0]]), (2, m))
    held = Rows(ring[None], np.ones((1, m)), upwards)
    program = QuadraticProgram(np.zeros((m, 2)), hessian, [held], np.zeros(m), np.ones(m), turned_axes(m, np.zeros(m)))
    order = BandOrder.of(m, ring, np.roll(ring, -1))
    some = ring < 4
    softest = negative_curvature(program, order, some)
    assert softest is not None
    d = softest.direction.ravel()
    assert np.abs(softest.direction[some, 1]).max() < 1e-4
    assert np.hypot(*softest.direction.T).max() == pytest.approx(1.0)
    assert d @ hessian.dense(m) @ d == pytest.approx(softest.curvature, rel=1e-3)
    assert softest.curvature < -0.3
    assert negative_curvature(program, order, np.ones(m, bool)) is None


# Matrices


@pytest.mark.parametrize("sizes", [[40], [3], [5, 3, 4], [16, 7]])
def test_the_order_of_rings_is_a_narrow_band(sizes: list[int]) -> None:
    numbers = np.random.default_rng(0).permutation(sum(sizes))
    rings = np.split(numbers, np.cumsum(sizes)[:-1])
    row, column = np.concatenate(rings), np.concatenate([np.roll(one, -1) for one in rings])
    assert BandOrder.of(sum(sizes), row, column).bandwidth == 2


@pytest.mark.parametrize("seed", range(5))
def test_the_order_is_that_of_scipy(seed: int) -> None:
    random = np.random.default_rng(seed)
    m = int(random.integers(1, 60))
    row, column = random.integers(m, size=(2, random.integers(2 * m)))  # with loners, loops and pairs given twice
    graph = coo_array((np.ones(2 * len(row)), (np.r_[row, column], np.r_[column, row])), (m, m)).tocsr()
    sought = reverse_cuthill_mckee(graph, symmetric_mode=True)
    np.testing.assert_array_equal(BandOrder.of(m, row, column).position[sought], np.arange(m))


@pytest.mark.parametrize(
    ("size", "height"), [(160, 1), (160, 2), (160, 5), (160, 64), (160, 65), (160, 150), (67, 66), (128, 100)]
)
def test_symmetric_systems_of_any_width(size: int, height: int) -> None:
    """Solved where all eigenvalues are positive, refused where one is not."""
    rng = np.random.default_rng(height)
    band = rng.normal(size=(size, height))
    band[np.add.outer(np.arange(size), np.arange(height)) >= size] = 0.0
    full = np.zeros((size, size))
    for below in range(height):
        column = np.arange(size - below)
        full[column + below, column] = full[column, column + below] = band[: size - below, below]
    lowest = float(np.linalg.eigvalsh(full)[0])
    right = rng.normal(size=size)

    def shifted(by: float) -> np.ndarray:
        moved = band.copy()
        moved[:, 0] += by
        return moved

    solve = factorised(shifted(1.0 - lowest))
    assert solve is not None
    assert solve(right) == pytest.approx(np.linalg.solve(full + (1.0 - lowest) * np.eye(size), right), abs=1e-9)
    assert factorised(shifted(-0.01 - lowest)) is None
    assert factorised(np.zeros((size, height))) is None
    damaged = shifted(1.0 - lowest)
    damaged[size // 2, height // 2] = np.nan
    assert factorised(damaged) is None


# Equalities are eliminated


HOUSE = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (0.0, 1.5), (-1.0, 1.0)]
STAIRS = [(0.0, 0.0), (1.0, 0.0), (3.0, 0.0), (3.0, 1.0), (2.0, 2.0), (2.0, 3.0), (0.0, 3.0)]
CROSS = [(-1, -3), (1, -3), (1, -1), (3, -1), (3, 1), (2, 1), (1, 2), (1, 3), (0, 3), (-1, 3), (-1, 2), (-2, 1)]
CROSS += [(-3, 1), (-3, -1), (-1, -1)]
FREE = (1, 3, 6)
"""Edges without a fixed direction, in one case."""

NAMES = ("images", "lines", "some lines", "both")


def tangents_of(mesh: Mesh) -> np.ndarray:
    """(m, 2) unit tangents of the edges."""
    edge = mesh.edge_ends - mesh.vertices
    return edge / np.hypot(*edge.T)[:, None]


def orbits_of(mesh: Mesh) -> Orbits:
    """Those of the mirror at the y axis."""
    orbits = Orbits.of(mesh.vertices, mesh.successor, Mirror(), 1e-9)
    assert orbits is not None
    return orbits


def elimination_of(name: str) -> tuple[Mesh, Elimination]:
    """A mesh and its unknowns: of its images, of its fixed edges, of some fixed edges, of both."""
    mesh = Mesh.from_loops([{"images": HOUSE, "both": CROSS}.get(name, STAIRS)])
    fixed = np.ones(len(mesh.vertices), bool)
    if name == "some lines":
        fixed[list(FREE)] = False
    images = Elimination.of_images(orbits_of(mesh), mesh.successor) if name in ("images", "both") else None
    if name == "images":
        assert images is not None
        return mesh, images
    return mesh, Elimination.of_lines(tangents_of(mesh), fixed, mesh.successor, images)


def dense(elimination: Elimination) -> np.ndarray:
    """S, by the motions of single unknowns."""
    unknowns = np.eye(2 * len(elimination.first[0])).reshape(-1, len(elimination.first[0]), 2)
    return np.stack([elimination.motion(one).ravel() for one in unknowns], axis=1)


def equalities(name: str, mesh: Mesh) -> np.ndarray:
    """(E, 2m) what motions keep: n · (D_b - D_a) = 0 of fixed edges a-b; D of an image is the image of D."""
    m, rows = len(mesh.vertices), []
    if name in ("images", "both"):
        orbits = orbits_of(mesh)
        for vertex, image in enumerate(orbits.partner.tolist()):
            for axis, sign in enumerate((-1.0, 1.0)):
                row = np.zeros((m, 2))
                row[vertex, axis] += sign
                row[image, axis] -= 1.0
                rows.append(row)
    if name != "images":
        for vertex in range(m):
            if name != "some lines" or vertex not in FREE:
                row = np.zeros((m, 2))
                (x, y), end = tangents_of(mesh)[vertex], mesh.successor[vertex]
                row[end], row[vertex] = (-y, x), (y, -x)
                rows.append(row)
    return np.array(rows).reshape(-1, 2 * m)


@pytest.mark.parametrize("name", NAMES)
def test_motions_are_all_that_keep_the_equalities(name: str) -> None:
    mesh, elimination = elimination_of(name)
    motions, equal = dense(elimination), equalities(name, mesh)
    assert np.allclose(equal @ motions, 0.0, atol=1e-12)
    assert np.linalg.matrix_rank(motions) == 2 * len(mesh.vertices) - np.linalg.matrix_rank(equal)
    motion = elimination.motion(np.random.default_rng(1).normal(size=(len(elimination.first[0]), 2)))
    assert np.allclose(elimination.scaled(motion, np.full(len(motion), 0.5)), 0.5 * motion, atol=1e-14)
    assert np.allclose(elimination.longest(motion), motion, atol=1e-14)
    reduced = elimination.scaled(motion, np.where(np.arange(len(motion)) == 2, 0.25, 1.0))
    assert np.allclose(equal @ reduced.ravel(), 0.0, atol=1e-12)
    assert np.allclose(reduced[2], 0.25 * motion[2])


@pytest.mark.parametrize("name", NAMES)
def test_a_program_is_that_of_the_whole_in_fewer_unknowns(name: str) -> None:
    """Energy and rows along motions S d, by finite differences of the quadratic model, which are exact."""
    mesh, elimination = elimination_of(name)
    rng, m = np.random.default_rng(0), len(mesh.vertices)
    blocks = Blocks(np.arange(m), mesh.successor, rng.normal(size=(m, 2, 2)))
    blocks = Blocks.sum([(1.0, blocks), (9.0, Blocks(np.arange(m), np.arange(m), np.tile(np.eye(2), (m, 1, 1))))])
    rows = Rows(np.stack([np.arange(m), mesh.successor]), rng.normal(size=(2, m)), rng.normal(size=(2, m)))
    axes = np.tile(np.eye(2), (m, 1, 1))
    program = QuadraticProgram(rng.normal(size=(m, 2)), blocks, [rows], np.full(m, 0.1), np.full(m, 0.5), axes)
    reduced, motions = elimination.program(program), dense(elimination)
    whole, unknowns = blocks.dense(m), motions.shape[1]

    def model(d: np.ndarray) -> float:
        step = motions @ d
        return float(program.gradient.ravel() @ step + 0.5 * step @ whole @ step)

    steps = 0.5 * np.eye(unknowns)
    slope = np.array([model(step) - model(-step) for step in steps])
    curvature = [[model(a + b) - model(a - b) - model(b - a) + model(-a - b) for b in steps] for a in steps]
    assert np.allclose(slope, reduced.gradient.ravel())
    assert np.allclose(np.array(curvature), reduced.hessian.dense(unknowns // 2))
    by_rows = full_rows([rows], m)
    assert np.allclose(by_rows @ motions, full_rows(reduced.rows, unknowns // 2))
    step = elimination.solve(InteriorPoint(), program, 0.0).step
    assert np.allclose(equalities(name, mesh) @ step.ravel(), 0.0, atol=1e-12)
    assert (np.full(m, 0.1) + by_rows @ step.ravel() > -1e-6).all()
    assert np.hypot(*step.T).max() <= 0.5 * np.sqrt(2.0) + 1e-6


# Newton


class Valley:
    """A curved valley of the coordinates in turn, (1 - a)² + 9 (b - a²)² summed, and steps of at most `reach`."""

    def __init__(self, reach: float) -> None:
        self.reach = reach

    def value(self, x: np.ndarray) -> float:
        return float(((1.0 - x[:, 0]) ** 2 + 9.0 * (x[:, 1] - x[:, 0] ** 2) ** 2).sum())

    def slope(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        a, b = x.T
        bend = 18.0 * (b - a**2)
        return self.value(x), np.stack([-2.0 * (1.0 - a) - 2.0 * a * bend, bend], axis=1)

    def newton(self, x: np.ndarray) -> NewtonModel:
        value, slope = self.slope(x)
        a, b = x.T
        hessian = np.empty((len(x), 2, 2))
        hessian[:, 0, 0], hessian[:, 1, 1] = np.maximum(2.0 - 36.0 * (b - a**2) + 72.0 * a**2, 40.0 * a**2 + 1.0), 18.0
        hessian[:, 0, 1] = hessian[:, 1, 0] = -36.0 * a
        values, vectors = np.linalg.eigh(hessian)
        hessian = (vectors * np.maximum(values, 0.1)[:, None, :]) @ vectors.transpose(0, 2, 1)
        return NewtonModel(value, slope, -np.linalg.solve(hessian, slope[..., None])[..., 0])

    def largest_step(self, x: np.ndarray, direction: np.ndarray) -> float:
        return self.reach

    def finished(self, x: np.ndarray) -> bool:
        return False


def test_newton_steps_end_where_those_of_scipy_do() -> None:
    start = np.array([[-1.2, 1.0], [0.5, 2.0], [2.0, -1.0]])
    valley = Valley(1.0)
    found = ProjectedNewton(max_iterations=200, tolerance=1e-10).minimise(valley, start, lambda x: None)
    assert found.converged
    expected = minimize(lambda x: valley.value(x.reshape(-1, 2)), start.ravel(), method="BFGS", options={"gtol": 1e-9})
    assert found.x.ravel() == pytest.approx(expected.x, abs=1e-5)
    assert found.x == pytest.approx(np.ones((3, 2)), abs=1e-5)


def test_steps_that_walls_cut_short_come_to_an_end() -> None:
    solution = ProjectedNewton(max_iterations=500).minimise(Valley(1e-6), np.full((3, 2), -1.0), lambda x: None)
    assert not solution.converged
    assert solution.iterations < 50
