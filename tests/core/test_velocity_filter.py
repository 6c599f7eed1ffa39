"""The velocity filter: nearest velocities against non-negative least squares, and cages that are certified."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import nnls

from nestedcages_core import (
    ArcLength,
    Area,
    Mesh,
    NoEnergy,
    ReinflationError,
    Settings,
    VelocityFilter,
    nested_cages,
    verify_motion,
)
from nestedcages_core.contact.pairs import Bodies, find_pairs
from nestedcages_core.contact.reinflation import reinflate
from nestedcages_core.energies import Energy
from nestedcages_core.published.sacht_2015.impact_zones import KEPT_PROXIMITY, ImpactZones
from nestedcages_core.tasks import drain
from shapes import annulus, assert_nested, letter_a, letter_a_coarse, ring, star

PROXIMITY = 1e-3


def least_change(rows: np.ndarray, least: np.ndarray) -> np.ndarray:
    """argmin |y| subject to rows y ≥ least, by non-negative least squares (Lawson & Hanson 1974, chapter 23)."""
    system = np.vstack([rows.T, least])
    right = np.append(np.zeros(rows.shape[1]), 1.0)
    residual = system @ nnls(system, right)[0] - right
    return -residual[:-1] / residual[-1]


def test_a_struck_edge_takes_the_nearest_velocity_that_does_not_penetrate() -> None:
    """One vertex of the fine mesh runs into the middle of a cage edge; its row is known by hand."""
    cage = Mesh.from_loops([np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])])
    fine = Mesh.from_loops([np.array([[-0.5, -0.5], [0.5, -0.5], [0.25, 0.98]])])
    bodies = Bodies.of(cage, fine)
    x = np.concatenate([cage.vertices, fine.vertices])
    wished = np.zeros_like(x)
    wished[6] = 0.0, 0.05
    wished[2:4, 0] = 0.01
    pairs = find_pairs(bodies, x, 3.0)
    velocity, _ = ImpactZones(bodies, PROXIMITY).nearest(pairs, x, wished)

    # the cage's upper edge runs from vertex 2 (1, 1) to 3 (-1, 1); at the impact, after 0.4 of the time, it has slid
    # by 0.004, so the vertex meets it at 0.377
    t = (1.004 - 0.25) / 2.0
    rows = np.zeros((1, 8))
    rows[0, 5], rows[0, 7] = 1.0 - t, t
    least = np.array([0.05 + min(PROXIMITY, KEPT_PROXIMITY * 0.02) - 0.02])
    expected = wished[:4].ravel() + least_change(rows, least)
    assert np.allclose(velocity[:4].ravel(), expected, atol=0.1 * PROXIMITY)
    assert np.array_equal(velocity[4:], wished[4:])


def test_without_impacts_every_wish_comes_true() -> None:
    cage, fine = annulus(12), Mesh.from_loops([ring(20, 0.9), ring(20, 0.6)])
    bodies = Bodies.of(cage, fine)
    x = np.concatenate([cage.vertices, fine.vertices])
    wished = 0.01 * np.random.default_rng(1).standard_normal(x.shape)
    velocity, systems = ImpactZones(bodies, PROXIMITY).nearest(find_pairs(bodies, x, 2.0), x, wished)
    assert np.array_equal(velocity, wished)
    assert systems == 0


@pytest.mark.slow
@pytest.mark.parametrize("energy", [NoEnergy(), Area()])
@pytest.mark.parametrize(
    ("fine", "coarse"),
    [(annulus(16), annulus(16)), (annulus(96), annulus(16)), (letter_a(), letter_a_coarse()), (star(), 24)],
    ids=["32", "192", "A", "star"],
)
def test_cages_and_animations_are_certified(fine: Mesh, coarse: Mesh | int, energy: Energy) -> None:
    settings = Settings(contact=VelocityFilter(energy=energy), decimation=ArcLength(), fallback=None)
    (level,) = nested_cages(fine, [coarse], settings).levels
    assert_nested(level.cage, fine)
    assert np.array_equal(level.reinflation.fine_steps[-1], fine.vertices)
    assert verify_motion(level.cage, fine, level.reinflation.cage_steps, level.reinflation.fine_steps)


@pytest.mark.slow
def test_gaps_narrower_than_the_proximity_are_passed() -> None:
    """A plate with a slit that is half as wide as the distance at which pairs are pushed apart."""
    gap = 0.5 * VelocityFilter().room
    right = [(1.0, 0.0), (1.0, 1.0), (gap / 2, 1.0), (gap / 2, 0.5)]
    fine = Mesh.from_loops([np.array([*right, (-gap / 2, 0.5), (-gap / 2, 1.0), (-1.0, 1.0), (-1.0, 0.0)])])
    coarse = fine.moved(fine.vertices * [0.98, 0.98] + [0.0, 0.01])
    settings = Settings(contact=VelocityFilter(energy=NoEnergy()), fallback=None)
    (level,) = nested_cages(fine, [coarse], settings).levels
    assert_nested(level.cage, fine)


def test_when_no_velocity_is_found_the_error_names_the_vertex(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a cage that is not allowed to move, the fine mesh stops in front of it."""
    monkeypatch.setattr(ImpactZones, "nearest", lambda self, pairs, x, wished: (wished, 0))
    fine, coarse = annulus(16), annulus(16)
    scale = fine.diagonal
    home, cage = fine.moved(fine.vertices / scale), coarse.moved(coarse.vertices / scale)
    steps = np.stack([home.vertices, home.vertices * np.repeat([0.93, 1.12], 16)[:, None]])
    with pytest.raises(ReinflationError, match="fine vertex") as caught:
        drain(reinflate(home, cage, steps, contacts=[VelocityFilter(energy=NoEnergy())], clearance=1e-5))
    way = caught.value.partial
    assert verify_motion(cage, home, way.cage_steps, way.fine_steps)
