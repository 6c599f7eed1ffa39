"""Parts of the flow: energy against differences, steps against a dense solver, containment, margins, last resorts."""

from __future__ import annotations

import numpy as np
import pytest
import scipy

from nestedcages_core import Mesh, TwoSidedFlow, nested_cages, verify_motion
from nestedcages_core.flow.containment import Containment
from nestedcages_core.flow.energy_flow import StepSystem
from nestedcages_core.flow.loop_matching import ALL_BOXES_LIMIT, _assignment, _box_difference, _closest, match_loops
from nestedcages_core.flow.penetration import Penetration, PenetrationEnergy, Spacing, local_margins
from nestedcages_core.flow.shrinking import thickness
from nestedcages_core.level.steps import shrunk
from nestedcages_core.tasks import drain
from support.marks import slow_after
from support.shapes import annulus, comb, disc, islands, letter_a, letter_a_coarse, ring, star


def penetration_energy(fine: Mesh, coarse: Mesh, spacing: float) -> PenetrationEnergy:
    return PenetrationEnergy(match_loops(fine, coarse), 0.05, Spacing(spacing, 0.05))


def gradient(found: Penetration, mesh: Mesh) -> np.ndarray:
    result = np.zeros_like(mesh.vertices)
    force = (found.weight * found.depth)[:, None] * found.direction
    np.add.at(result, found.edge, (1.0 - found.parameter)[:, None] * force)
    np.add.at(result, mesh.successor[found.edge], found.parameter[:, None] * force)
    return result


@pytest.mark.parametrize("spacing", [np.inf, 0.05])
def test_penetration_acts_as_the_derivative_of_its_energy(spacing: float) -> None:
    fine, coarse = letter_a(2), letter_a_coarse()
    energy = penetration_energy(fine, coarse, spacing)
    rng = np.random.default_rng(5)
    vertices = fine.vertices + rng.normal(scale=0.03, size=fine.vertices.shape)
    direction = rng.normal(size=vertices.shape)
    step = 1e-7
    difference = (energy.at(vertices + step * direction).energy - energy.at(vertices - step * direction).energy) / (
        2 * step
    )
    assert energy.at(vertices).energy > 0.0
    assert np.isclose((gradient(energy.at(vertices), fine) * direction).sum(), difference, rtol=1e-4)


@pytest.mark.parametrize("share", [1.0, 0.15])
@pytest.mark.parametrize("spacing", slow_after(1, [0.05, 0.005]))
def test_penetration_skips_nothing_that_matters(spacing: float, share: float) -> None:
    """Distances that are known well enough are not measured again; the energy is the same as of a new start.

    All vertices move, or some, and one of them far and back.
    """
    fine, coarse = letter_a(2), letter_a_coarse()
    used = penetration_energy(fine, coarse, spacing)
    rng = np.random.default_rng(6)
    vertices = fine.vertices
    for k in range(12):
        moving = rng.uniform(size=(len(vertices), 1)) < share
        vertices = vertices + moving * rng.normal(scale=0.1 * 0.5**k, size=vertices.shape)
        vertices[7] += (-1) ** k * np.array([0.3, 0.2])
        found, fresh = used.at(vertices), penetration_energy(fine, coarse, spacing).at(vertices)
        assert found.energy == fresh.energy
        assert np.array_equal(found.depth, fresh.depth)


@pytest.mark.parametrize("sizes", [(3,), (4, 5), (7, 3, 12)])
def test_step_system_solves_the_dense_system(sizes: tuple[int, ...]) -> None:
    mesh = Mesh.from_loops([disc(size, 0.4, float(k), 0.0) for k, size in enumerate(sizes)])
    n, unit, smoothing = len(mesh.vertices), 0.05, 0.3
    rng = np.random.default_rng(2)
    count = 9
    angle = rng.uniform(0.0, 7.0, count)
    found = Penetration(
        energy=1.0,
        overlap=1.0,
        edge=rng.integers(0, n, count),
        parameter=rng.uniform(size=count),
        weight=rng.uniform(0.1, 1.0, count),
        direction=np.stack([np.cos(angle), np.sin(angle)], axis=1),
        depth=rng.uniform(size=count),
    )
    jacobian = np.zeros((count, n, 2))
    for row in range(count):
        jacobian[row, found.edge[row]] += (1.0 - found.parameter[row]) * found.direction[row]
        jacobian[row, mesh.successor[found.edge[row]]] += found.parameter[row] * found.direction[row]
    flat = jacobian.reshape(count, -1)
    stiffness = np.zeros((n, n))
    for v, w in enumerate(mesh.successor):
        stiffness[np.ix_([v, w], [v, w])] += np.array([[1.0, -1.0], [-1.0, 1.0]]) / mesh.edge_lengths[v]
    matrix = flat.T @ (found.weight[:, None] * flat) + smoothing**2 * np.kron(stiffness, np.eye(2))
    matrix += 1e-4 * unit * np.eye(2 * n)
    wanted = np.linalg.solve(matrix, -flat.T @ (found.weight * found.depth)).reshape(-1, 2)
    assert np.allclose(StepSystem(mesh, unit).direction(found, smoothing), wanted, rtol=1e-9, atol=1e-12)


def test_margins_leave_half_of_a_slit() -> None:
    mesh = comb(1, 0.04, per_unit=1)
    margins = local_margins(mesh, 0.05)
    walls = np.abs(mesh.vertices[:, 0] - mesh.vertices[mesh.successor, 0]) < 1e-12
    walls &= np.abs(mesh.vertices[:, 0] - 0.5) < 0.1
    assert walls.sum() == 2
    assert np.allclose(margins[walls], 0.01)
    assert np.isclose(margins[0], 0.025)  # the slit ends 0.1 above the bottom


def test_containment_knows_every_side() -> None:
    fine = annulus(32)
    coarse = Mesh.from_loops([ring(16, 1.2), ring(16, 0.4)])
    containment = Containment(match_loops(fine, coarse))
    assert containment.obstacle(fine.vertices) is None
    for factor, words in (
        (1.19, "crosses"),
        (3.0, "lies outside loop 0"),
        (0.79, "crosses"),
        (0.5, "lies inside hole loop 1"),
    ):
        obstacle = containment.obstacle(factor * fine.vertices)
        assert obstacle is not None
        assert words in obstacle.cause
    # the fine hole beside the coarse one
    beside = fine.vertices.copy()
    beside[fine.loops[1]] = disc(32, 0.05, 0.8, 0.0)[::-1]
    obstacle = containment.obstacle(beside)
    assert obstacle is not None
    assert "Hole 1 of the coarse mesh lies inside the fine mesh" in obstacle.cause
    # mirrored, the loops run around the coarse hole the wrong way
    assert containment.obstacle(fine.vertices * (1.0, -1.0)) is not None
    # a vertex on the coarse boundary is not inside
    touching = fine.vertices.copy()
    touching[0] = coarse.vertices[0]
    assert containment.obstacle(touching) is not None


@pytest.mark.parametrize("near", [0.0, 0.5, 5.0])
def test_loops_are_assigned_as_the_solver_does(near: float) -> None:
    """Cheap ones on a diagonal, ties among small whole numbers, and more rows than columns."""
    random = np.random.default_rng(4)
    for rows, columns in ((1, 1), (2, 2), (5, 5), (7, 4)):
        for _ in range(40):
            cost = random.integers(0, 9, (rows, columns)) + near * (1.0 - np.eye(rows, columns))
            found = _assignment(cost)
            np.testing.assert_array_equal(found, scipy.optimize.linear_sum_assignment(cost))
    for spread in (3.0, 0.2):  # each box next to its own, or next to others' too
        of = np.argsort(random.uniform(size=ALL_BOXES_LIMIT + 9))
        boxes = random.uniform(0.0, spread, (len(of), 2))[:, [0, 1, 0, 1]] + [0.0, 0.0, 0.1, 0.1]
        moved = boxes[of] + random.uniform(-0.01, 0.01, boxes.shape)
        exact = scipy.optimize.linear_sum_assignment(_box_difference(boxes, moved))
        np.testing.assert_array_equal(_closest(boxes, moved), exact)


@pytest.mark.parametrize("fine", [star(), annulus(80), islands(), comb(4, 0.05), letter_a()])
def test_the_flow_goes_on_inside_the_coarse_mesh(fine: Mesh) -> None:
    """Each further step is simple, nested by the motion from the certified one, and the whole is visibly smaller."""
    level = nested_cages(fine, [max(24, 4 * len(fine.loops))], stored=np.float32).levels[0]
    further = shrunk(level)
    way = further.flow.steps[len(level.flow.steps) - 1 :]
    assert len(way) >= 3
    back = further.reinflation
    assert verify_motion(level.cage, fine, back.cage_steps, back.fine_steps)
    np.testing.assert_array_equal(back.moving_steps[: len(way)], way[::-1])
    assert all(np.array_equal(steps, steps.astype(np.float32)) for steps in (way[1:], back.cage_steps))
    areas = [Mesh(step, fine.edges).area for step in way]
    assert (np.diff(areas) < 0.0).all()
    assert areas[-1] < 0.9 * fine.area


def test_thickness_is_that_of_limbs_and_walls() -> None:
    """A wall of 0.5 between circles, and a strip of 0.1: apart from its ends as thick as it is."""
    assert thickness(annulus(80)) == pytest.approx(0.5, abs=0.01)
    strip = Mesh.from_loops([[(x, 0.0) for x in np.linspace(0, 2, 41)] + [(x, 0.1) for x in np.linspace(2, 0, 41)]])
    assert thickness(strip) == pytest.approx(0.1, abs=0.01)


def test_a_coarse_mesh_around_everything_needs_no_flow_whichever_holes_are_matched() -> None:
    """Two rings in one cage, which has a hole between them; by their boxes both holes suit either of the rings."""
    rings = [radius * np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]) for radius in (1.25, 1.0)]
    fine = Mesh.from_loops([rings[0], rings[1][::-1], 0.75 * rings[0], 0.875 * rings[1][::-1]])
    between = np.array([(31.0, 31.0), (31.0, 31.5), (31.5, 31.0)]) / 64.0
    coarse = Mesh.from_loops([1.5 * rings[1], 0.8125 * rings[1][::-1], between])
    assert Containment(match_loops(fine, coarse)).obstacle(fine.vertices) is not None
    assert drain(TwoSidedFlow().run(fine, coarse)).stage == "inside"
