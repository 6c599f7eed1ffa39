"""Quadratic programs against independent solvers, and the systems inside them against full matrices."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.sparse import coo_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from nestedcages_core import NestedCagesError
from nestedcages_core.energies import Blocks
from nestedcages_core.geometry.loops import Loops
from nestedcages_core.solver.banded import WIDEST_BAND, BandedSystem, BandOrder, Rows, factorised
from nestedcages_core.solver.negative_curvature import negative_curvature
from nestedcages_core.solver.quadratic_program import InteriorPoint, QuadraticProgram

EXACT = InteriorPoint(iterations=80, complementarity=1e-10, primal=1e-10, dual=1e-10)


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
            for vertex, weight in zip(group.vertex[:, k], group.weight[:, k], strict=True):
                line[vertex] += weight * group.direction[:, k]
            lines.append(line.ravel())
    return np.array(lines).reshape(-1, 2 * m)


def random_program(seed: int, m: int = 7, counts: tuple[int, int, int] = (6, 9, 5)) -> QuadraticProgram:
    """A strictly convex program over a ring of m vertices with a few far couplings."""
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
        rng.uniform(0.0, 0.2, sum(counts)),
        rng.uniform(0.1, 1.0, m),
        upright(m),
    )


def upright(m: int) -> np.ndarray:
    """Axes along the coordinates."""
    return np.broadcast_to(np.eye(2), (m, 2, 2))


def objective(program: QuadraticProgram):
    W, G = program.hessian.dense(len(program.radius)), program.gradient.ravel()
    return lambda d: G @ d + 0.5 * d @ W @ d, lambda d: G + W @ d


@pytest.mark.parametrize("seed", range(6))
def test_solution_is_that_of_an_independent_solver(seed: int) -> None:
    program = random_program(seed)
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


def test_the_bounds_end_the_descent_of_an_indefinite_program() -> None:
    ring = np.arange(4)
    saddle = np.broadcast_to(np.diag([1.0, -1.0]), (4, 2, 2))
    hessian = Blocks(ring, ring, saddle)
    program = QuadraticProgram(np.ones((4, 2)), hessian, [], np.zeros(0), np.full(4, 0.1), upright(4))
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


@pytest.mark.parametrize("counts", [(6, 9, 5), (0, 12, 0), (4, 0, 0), (0, 0, 0)])
def test_band_holds_the_matrices(counts: tuple[int, int, int]) -> None:
    program = random_program(2, m=12, counts=counts)
    m, rng = 12, np.random.default_rng(0)
    order = BandOrder.of(m, program.hessian.row, program.hessian.column).including(program.hessian, program.rows)
    axes = turned_axes(m, rng.uniform(0.0, 6.0, m))
    system = BandedSystem(order, program.hessian, program.rows, axes)
    unknown = (2 * order.position[:, None] + np.arange(2)).ravel()  # place of every unknown in the band
    turn = np.zeros((2 * m, 2 * m))  # from the vertices' coordinates to those along their axes, in the band's order
    for vertex, place in enumerate(order.position):
        turn[2 * place : 2 * place + 2, 2 * vertex : 2 * vertex + 2] = axes[vertex]
    A = np.concatenate([full_rows(program.rows, m) @ turn.T, np.eye(2 * m), -np.eye(2 * m)])
    d, z = rng.normal(size=2 * m), rng.normal(size=len(A))
    np.testing.assert_allclose(system.along_axes(d.reshape(m, 2)), turn @ d, atol=1e-13)
    np.testing.assert_allclose(system.of_vertices(d).ravel(), turn.T @ d, atol=1e-13)
    np.testing.assert_array_equal(system.per_unknown(np.arange(m))[unknown], np.repeat(np.arange(m), 2))
    np.testing.assert_allclose(system.constraints(d), A @ d, atol=1e-13)
    np.testing.assert_allclose(system.transposed(z), A.T @ z, atol=1e-13)
    h = rng.uniform(0.1, 2.0, len(A))
    system.set_matrix(h)
    assert system.factorise(0.7)
    M = turn @ program.hessian.dense(m) @ turn.T + A.T @ (h[:, None] * A) + 0.7 * np.eye(2 * m)
    np.testing.assert_allclose(system.solve(d), np.linalg.solve(M, d), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("sizes", [[40], [3], [5, 3, 4], [16, 7]])
def test_the_order_of_rings_is_a_narrow_band(sizes: list[int]) -> None:
    numbers = np.random.default_rng(0).permutation(sum(sizes))
    row, column = numbers, numbers[Loops.of(np.zeros((sum(sizes), 2)), sizes).successor]
    assert BandOrder.of(sum(sizes), row, column).bandwidth == 2


@pytest.mark.parametrize("seed", range(5))
def test_the_order_is_that_of_scipy(seed: int) -> None:
    random = np.random.default_rng(seed)
    m = int(random.integers(1, 60))
    row, column = random.integers(m, size=(2, random.integers(2 * m)))  # with loners, loops and pairs given twice
    graph = coo_array((np.ones(2 * len(row)), (np.r_[row, column], np.r_[column, row])), (m, m)).tocsr()
    sought = reverse_cuthill_mckee(graph, symmetric_mode=True)
    np.testing.assert_array_equal(BandOrder.of(m, row, column).position[sought], np.arange(m))


def test_a_matrix_that_is_not_positive_definite_is_refused() -> None:
    ring = np.arange(3)
    hessian = Blocks(ring, ring, np.broadcast_to(-np.eye(2), (3, 2, 2)))
    system = BandedSystem(BandOrder.of(3, ring, ring), hessian, [], upright(3))
    system.set_matrix(np.full(12, 0.1))
    assert not system.factorise(0.0)
    assert system.factorise(5.0)


def test_the_softest_motion_keeps_what_is_active_and_has_negative_curvature() -> None:
    m = 6
    ring = np.arange(m)
    saddle = np.broadcast_to(np.diag([1.0, -0.5]), (m, 2, 2))
    couplings = np.broadcast_to(0.05 * np.eye(2), (m, 2, 2))
    hessian = Blocks.sum([(1.0, Blocks(ring, ring, saddle)), (1.0, Blocks(ring, np.roll(ring, -1), couplings))])
    upwards = np.broadcast_to(np.array([[0.0], [1.0]]), (2, m))
    held = Rows(ring[None], np.ones((1, m)), upwards)
    program = QuadraticProgram(np.zeros((m, 2)), hessian, [held], np.zeros(m), np.ones(m), upright(m))
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


def test_matrices_that_no_damping_makes_definite_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """As some libraries answer entries that are no numbers."""
    program = random_program(1)
    monkeypatch.setattr(BandedSystem, "factorise", lambda self, shift: False)
    with pytest.raises(NestedCagesError, match="derivatives that are not finite"):
        InteriorPoint().solve(program)
    with pytest.raises(NestedCagesError, match="derivatives that are not finite"):
        negative_curvature(program, BandOrder.of(7, np.arange(7), np.arange(7)), np.zeros(20, bool))


@pytest.mark.parametrize(
    ("size", "height"),
    [(160, 1), (160, 2), (160, 5), (160, WIDEST_BAND), (160, WIDEST_BAND + 1), (160, 150), (67, 66), (128, 100)],
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
