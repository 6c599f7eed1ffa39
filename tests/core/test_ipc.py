"""Incremental Potential Contact: its energy's derivatives, its local ranges, and fine meshes that come home."""

from __future__ import annotations

import numpy as np
import pytest

from nestedcages_core import IPC, Area, Mesh, ProjectedNewton, ReinflationError
from nestedcages_core.contact.barrier import BarrierRanges, facing_gaps
from nestedcages_core.contact.incremental_potential import IncrementalPotential, PotentialWeights
from nestedcages_core.contact.pairs import Bodies, CandidateList, find_pairs
from nestedcages_core.contact.reinflation import Reinflation, reinflate
from nestedcages_core.energies.restoring import Restoring
from nestedcages_core.solver.newton import STALLED_AFTER, NewtonModel
from nestedcages_core.tasks import drain
from support.shapes import assert_free_of_crossings, derivative, ring


def annulus(count: int) -> Mesh:
    """A diagonal of 1, so that lengths are in the units of the solvers."""
    scale = 1.0 / np.sqrt(8.0)
    return Mesh.from_loops([ring(count, scale), ring(count, 0.5 * scale)])


def home_again(fine: Mesh, coarse: Mesh, start: np.ndarray) -> Reinflation:
    steps = np.stack([fine.vertices, start])
    return drain(reinflate(fine, coarse, steps, contacts=[IPC()], clearance=1e-5))


@pytest.fixture
def squeezed() -> tuple[Bodies, np.ndarray, IncrementalPotential]:
    """A shrunk annulus in a coarse one, with barriers of all three families at work."""
    fine, coarse = annulus(40), annulus(8)
    start = fine.vertices * np.where(np.arange(80) < 40, 0.85, 1.15)[:, None]
    bodies = Bodies.of(coarse, fine)
    x = np.concatenate([coarse.vertices, start])
    x += 0.004 * np.random.default_rng(3).normal(size=x.shape)
    ranges = BarrierRanges.local(bodies, x[:16], x[16:], 0.2)
    potential = IncrementalPotential(
        bodies,
        Area(),
        Restoring(fine.vertices, bodies.fine_weight),
        PotentialWeights(500.0, 1.0, 1.0),
        ranges,
        CandidateList(bodies),
    )
    return bodies, x, potential


def test_all_families_of_pairs_are_found(squeezed: tuple[Bodies, np.ndarray, IncrementalPotential]) -> None:
    bodies, x, _ = squeezed
    pairs = find_pairs(bodies, x, 0.3)
    for family in (pairs.fine_cage, pairs.cage_fine, pairs.cage_cage):
        assert family.stop > family.start
    own = pairs.cage_cage
    assert (pairs.point[own] != pairs.start[own]).all()
    assert (pairs.point[own] != pairs.end[own]).all()


def test_gradient_of_the_potential_agrees_with_differences(
    squeezed: tuple[Bodies, np.ndarray, IncrementalPotential],
) -> None:
    _, x, potential = squeezed
    gradient = potential.newton(x).gradient
    assert gradient == pytest.approx(derivative(potential.value, x, 1e-7), abs=1e-5 * np.abs(gradient).max())


def test_newton_directions_descend(squeezed: tuple[Bodies, np.ndarray, IncrementalPotential]) -> None:
    _, x, potential = squeezed
    for _ in range(5):
        model = potential.newton(x)
        assert model.value == pytest.approx(potential.value(x), rel=1e-12)
        assert float((model.gradient * model.direction).sum()) < 0.0
        step = potential.largest_step(x, model.direction)
        x = x + 0.5 * step * model.direction
        assert np.isfinite(potential.value(x))


def test_sparse_and_banded_systems_agree(
    squeezed: tuple[Bodies, np.ndarray, IncrementalPotential], monkeypatch: pytest.MonkeyPatch
) -> None:
    _, x, potential = squeezed
    banded = potential.newton(x).direction
    monkeypatch.setattr("nestedcages_core.solver.banded.WIDEST_BAND", 0)
    assert potential.newton(x).direction == pytest.approx(banded, abs=1e-9 * np.abs(banded).max())


def test_gaps_are_seen_across_the_outside_only() -> None:
    """A U: its slot is a gap, the thickness of its legs is not."""
    u = Mesh.from_loops([np.array([[0, 0], [3, 0], [3, 4], [2, 4], [2, 1], [1.4, 1], [1.4, 4], [0, 4]], float)])
    gap = facing_gaps(u.vertices, u.successor, u.predecessor, 2.0)
    inner = [3, 4, 5, 6]
    assert gap[inner] == pytest.approx(0.6)
    outer = [0, 1, 2, 7]
    assert (gap[outer] == np.inf).all()


@pytest.mark.parametrize("count", [16, 60, 256])
def test_an_annulus_comes_home_to_the_last_bit(count: int) -> None:
    fine, coarse = annulus(count), annulus(16)
    start = fine.vertices * np.repeat([0.93, 1.12], count)[:, None]
    way = home_again(fine, coarse, start)
    assert (way.fine_steps[-1] == fine.vertices).all()
    assert (way.cage_steps[0] == coarse.vertices).all()
    assert way.tightening_start == len(way.fine_steps) - 1
    assert_free_of_crossings(coarse, fine, way.cage_steps, way.fine_steps)


def test_a_slit_much_thinner_than_the_range_does_not_lock() -> None:
    width = 1e-3
    fine = Mesh.from_loops(
        [np.array([[0, 0], [1, 0], [1, 0.5], [0.5 + width, 0.5], [0.5, 0.1], [0.5 - width, 0.5], [0, 0.5]], float)]
    )
    coarse = Mesh.from_loops([np.array([[0.01, 0.01], [0.99, 0.01], [0.99, 0.49], [0.5, 0.05], [0.01, 0.49]], float)])
    start = fine.vertices.copy()
    start[:] = [[0.03, 0.02], [0.97, 0.02], [0.97, 0.46], [0.55, 0.065], [0.5, 0.04], [0.45, 0.065], [0.03, 0.46]]
    way = home_again(fine, coarse, start)
    assert (way.fine_steps[-1] == fine.vertices).all()
    assert_free_of_crossings(coarse, fine, way.cage_steps, way.fine_steps)


def test_a_cage_that_cannot_give_way_is_an_error_with_the_steps_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "nestedcages_core.contact.incremental_potential.IncrementalPotential.finished", lambda *_: False
    )
    fine, coarse = annulus(16), annulus(16)
    start = fine.vertices * np.repeat([0.93, 1.12], 16)[:, None]
    with pytest.raises(ReinflationError, match="holds up fine vertex") as caught:
        home_again(fine, coarse, start)
    assert isinstance(caught.value.partial, Reinflation)
    assert len(caught.value.partial.fine_steps) > 1


class Walled:
    """|x|² with walls that let no step go farther than a millionth."""

    def value(self, x: np.ndarray) -> float:
        return float((x * x).sum())

    def slope(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        return self.value(x), 2.0 * x

    def newton(self, x: np.ndarray) -> NewtonModel:
        return NewtonModel(self.value(x), 2.0 * x, -x)

    def largest_step(self, x: np.ndarray, direction: np.ndarray) -> float:
        return 1e-6

    def finished(self, x: np.ndarray) -> bool:
        return False


def test_steps_that_walls_cut_short_come_to_an_end() -> None:
    solution = drain(ProjectedNewton().minimise(Walled(), np.ones((3, 2))))
    assert not solution.converged
    assert solution.iterations == STALLED_AFTER
