"""The contact of Li et al. 2020: its kernels against IPC Toolkit, the same authors' library, and what it returns."""

from __future__ import annotations

import numpy as np
import pytest
from test_ccd import pairs_of

from benchmarks.li_2020 import OriginalIPC
from benchmarks.li_2020.barrier import SquaredBarrier
from benchmarks.li_2020.stiffness import StiffnessBounds
from benchmarks.published import ElTopo
from nestedcages_core import (
    Area,
    Mesh,
    NoEnergy,
    ReinflationError,
    Settings,
    StepDisplacement,
    nested_cages,
    verify_motion,
)
from nestedcages_core.contact.ccd import impacts
from nestedcages_core.contact.pairs import Bodies, find_pairs
from nestedcages_core.contact.reinflation import reinflate
from nestedcages_core.tasks import drain
from nestedcages_core.tightening import Tightening
from support.marks import slow_after
from support.shapes import annulus, assert_nested, letter_a, letter_a_coarse, ring

STATES = 400
CORNERS, POINTS = 6, 10  # of the cage and of the fine mesh
D_HAT = 0.2
EQUAL = 1e-12  # relative to the largest entry
ROUNDING = 16 * np.finfo(float).eps  # of positions of size 1, and of what is computed from them


def states(seed: int) -> tuple[Bodies, list[np.ndarray]]:
    """A cage around a fine mesh, many times disturbed at random: up to contact, and beyond the barrier's range."""
    cage, fine = Mesh.from_loops([ring(CORNERS, 1.2)]), Mesh.from_loops([ring(POINTS, 1.0)])
    random = np.random.default_rng(seed)
    x = np.concatenate([cage.vertices, fine.vertices])
    sizes = 10.0 ** random.uniform(-4.0, -1.0, STATES)
    return Bodies.of(cage, fine), [x + size * random.normal(size=x.shape) for size in sizes]


@pytest.fixture(scope="module")
def toolkit():
    ipctk = pytest.importorskip("ipctk")
    ipctk.set_num_threads(1)
    return ipctk


def scene(ipctk, bodies: Bodies):
    """The same two meshes in IPC Toolkit; there too the fine one does not collide with itself."""
    m, n = bodies.m, bodies.n
    edges = np.stack([np.arange(m + n), bodies.successor], axis=1)
    mesh = ipctk.CollisionMesh(np.zeros((m + n, 2)), edges)
    mesh.can_collide = ipctk.make_static_obstacle_filter(m)
    return mesh


def equal(ours: np.ndarray, theirs: np.ndarray, smallest: float) -> bool:
    """Whether two arrays agree to 1e-12, or to what the rounding of positions leaves of the smallest distance."""
    tolerance = max(EQUAL, ROUNDING / smallest)
    return bool(np.abs(ours - theirs).max() <= tolerance * np.abs(theirs).max())


@pytest.mark.slow
def test_potential_gradient_and_hessian_are_those_of_the_toolkit(toolkit) -> None:
    bodies, positions = states(0)
    mesh, potential = scene(toolkit, bodies), toolkit.BarrierPotential(D_HAT, 1.0)
    active = 0
    for x in positions:
        collisions = toolkit.NormalCollisions()
        collisions.build(mesh, x, D_HAT)
        ours = SquaredBarrier.at(x, find_pairs(bodies, x, D_HAT), D_HAT)
        if len(ours.pairs) == 0:
            assert len(collisions) == 0
            continue
        active += 1
        smallest = float(ours.measured.distance.min())
        assert equal(np.array(ours.value), np.array(potential(collisions, mesh, x)), smallest)
        assert equal(ours.gradient().ravel(), potential.gradient(collisions, mesh, x), smallest)
        for projected, method in ((False, "NONE"), (True, "CLAMP")):
            theirs = potential.hessian(collisions, mesh, x, getattr(toolkit.PSDProjectionMethod, method))
            assert equal(ours.hessian(projected=projected).toarray(), theirs.toarray(), smallest)
    assert active > 0.9 * STATES


def test_times_of_impact_are_those_of_the_toolkit(toolkit) -> None:
    x, v = np.random.default_rng(3).normal(size=(2, 3 * STATES, 2))
    pairs = pairs_of(STATES)
    hit, time = impacts(pairs, x, v, pairs.measure(x).distance, 1e-12)
    ours = np.full(STATES, np.inf)
    ours[hit] = time
    corners = [(x[3 * k : 3 * k + 3], (x + v)[3 * k : 3 * k + 3]) for k in range(STATES)]
    theirs = [toolkit.inexact_point_edge_ccd_2D(*before, *after, 1.0) for before, after in corners]
    met = np.array([hit for hit, _ in theirs])
    assert met.sum() > STATES // 10
    assert np.array_equal(met, np.isfinite(ours))
    assert np.abs(ours[met] - np.array([time for _, time in theirs])[met]).max() <= EQUAL


def test_least_stiffness_is_the_toolkit_s(toolkit) -> None:
    random = np.random.default_rng(4)
    energy, contact = random.normal(size=(2, 20, 2))
    for d_hat in (1e-3, 1e-2):
        bounds = StiffnessBounds.of(d_hat, OriginalIPC().stiffness)
        first, largest = toolkit.initial_barrier_stiffness(
            1.0, toolkit.ClampedLogBarrier(), d_hat, 1.0, energy.ravel(), contact.ravel()
        )
        assert bounds.largest == pytest.approx(largest, rel=EQUAL)
        assert bounds.first(energy, contact) == pytest.approx(first, rel=EQUAL)


def test_stiffness_grows_while_close_pairs_come_closer() -> None:
    bounds = StiffnessBounds(1.0, 3.0)
    assert bounds.raised(1.0, {5: 1e-10}, {5: 0.9e-10}) == 2.0
    assert bounds.raised(2.0, {5: 1e-10}, {5: 0.9e-10}) == 3.0
    assert bounds.raised(1.0, {5: 1e-10}, {5: 1.1e-10}) == 1.0
    assert bounds.raised(1.0, {5: 1e-10}, {6: 0.9e-10}) == 1.0


@pytest.mark.parametrize(
    "contact", [OriginalIPC(Area()), OriginalIPC(StepDisplacement()), ElTopo(NoEnergy()), ElTopo(Area())]
)
@pytest.mark.parametrize(
    ("fine", "coarse"),
    slow_after(1, [(annulus(96), annulus(16)), (letter_a(), letter_a_coarse())], thorough_after=1),
    ids=["192", "A"],
)
def test_cages_and_animations_are_certified(fine: Mesh, coarse: Mesh, contact: OriginalIPC | ElTopo) -> None:
    """By each contact of another publication."""
    settings = Settings(contact=contact, fallback=None, tightening=Tightening(iterations=0))
    (level,) = nested_cages(fine, [coarse], settings).levels
    assert_nested(level.cage, fine)
    assert np.array_equal(level.reinflation.fine_steps[-1], fine.vertices)
    assert verify_motion(level.cage, fine, level.reinflation.cage_steps, level.reinflation.fine_steps)


def test_what_cannot_arrive_is_named() -> None:
    fine, coarse = annulus(16), annulus(16)
    home, cage = (mesh.moved(mesh.vertices / fine.diagonal) for mesh in (fine, coarse))
    steps = np.stack([home.vertices, home.vertices * np.repeat([0.93, 1.12], 16)[:, None]])
    with pytest.raises(ReinflationError, match="holds up fine vertex") as caught:
        drain(reinflate(home, cage, steps, contacts=[OriginalIPC(iterations=1)], clearance=1e-5))
    way = caught.value.partial
    assert verify_motion(cage, home, way.cage_steps, way.fine_steps)
