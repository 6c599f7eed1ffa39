"""Sacht et al. 2015 as published: the flow, impulses, inelastic impact zones, and the cages that come of them."""

from __future__ import annotations

import numpy as np
import pytest
from test_ccd import pairs_of

from benchmarks.published.sacht_2015 import ElTopo, SachtFlow
from benchmarks.published.sacht_2015.impulses import SEPARATION_RATE, Impulses, InelasticZones, meeting
from nestedcages_core import FlowError, Mesh, NoEnergy, Settings, nested_cages
from nestedcages_core.contact.ccd import impacts
from nestedcages_core.contact.pairs import Bodies, Pairs, find_pairs
from nestedcages_core.tasks import drain
from nestedcages_core.tightening import Tightening
from support.shapes import letter_a, letter_a_coarse

PROXIMITY = 1e-3
SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


def below_the_upper_edge(*points: tuple[float, float]) -> tuple[Pairs, np.ndarray]:
    """All pairs of a square cage, vertices 0 to 3, with a fine mesh whose first vertices (from 4 on) are given."""
    cage = Mesh.from_loops([SQUARE])
    fine = Mesh.from_loops([np.array([*points, (-0.5, -0.5), (0.5, -0.5)])])
    bodies = Bodies.of(cage, fine)
    x = np.concatenate([cage.vertices, fine.vertices])
    return find_pairs(bodies, x, 4.0), x


def test_the_flow_steps_a_thousandth_of_the_longest_side() -> None:
    fine, coarse = letter_a(), letter_a_coarse()
    with pytest.raises(FlowError) as stopped:
        drain(SachtFlow(limit=1).run(fine, coarse))
    before, after = stopped.value.partial.steps[:2]
    side = float(np.ptp(np.concatenate([fine.vertices, coarse.vertices]), axis=0).max())
    assert np.hypot(*(after - before).T).max() == pytest.approx(1e-3 * side, rel=0.2)
    assert np.hypot(*(after - before).T).max() <= 1e-3 * side * (1.0 + 1e-12)


def test_a_collision_loses_its_relative_normal_velocity() -> None:
    """One vertex runs into the edge from vertex 2 (1, 1) to 3 (-1, 1), at 0.375 of its length."""
    pairs, x = below_the_upper_edge((0.25, 0.98))
    point = int(np.flatnonzero((x == (0.25, 0.98)).all(axis=1))[0])
    wished = np.zeros_like(x)
    wished[point] = 0.0, 0.05
    velocity, done = Impulses(pairs, 4, PROXIMITY).collisions(x, wished, 1.0)
    t = 0.375
    assert done
    assert np.array_equal(velocity[4:], wished[4:])  # infinite mass
    assert (1.0 - t) * velocity[2, 1] + t * velocity[3, 1] == pytest.approx(0.05)
    assert velocity[2, 1] / velocity[3, 1] == pytest.approx((1.0 - t) / t)  # the impulse is shared by leverage
    assert not velocity[:2].any()
    hits, _ = impacts(pairs, x, velocity, pairs.measure(x).distance, 1e-6)
    assert len(hits) == 0


def test_pairs_that_are_too_close_separate_slowly() -> None:
    gap = 0.4 * PROXIMITY
    pairs, x = below_the_upper_edge((0.25, 1.0 - gap))
    velocity = Impulses(pairs, 4, PROXIMITY).apart(x, np.zeros_like(x), 1.0)
    t = 0.375
    separation = (1.0 - t) * velocity[2, 1] + t * velocity[3, 1]
    assert separation == pytest.approx(SEPARATION_RATE * (PROXIMITY - gap))
    assert not Impulses(pairs, 4, 0.5 * gap).apart(x, np.zeros_like(x), 1.0).any()


def test_the_scalar_time_of_impact_finds_what_the_arrays_find() -> None:
    count = 500
    x, v = np.random.default_rng(0).normal(size=(2, 3 * count, 2))
    pairs = pairs_of(count)
    distance = pairs.measure(x).distance
    hit = set(impacts(pairs, x, v, distance, 1e-6 / 0.05)[0].tolist())
    for k in range(count):
        corners = [tuple(row) for row in (*x[3 * k : 3 * k + 3].tolist(), *v[3 * k : 3 * k + 3].tolist())]
        met = meeting(*corners, float(distance[k]))
        assert (met is not None) == (k in hit)
        if met is not None:
            (n_x, n_y), t = met
            assert np.hypot(n_x, n_y) == pytest.approx(1.0)
            assert 0.0 <= t <= 1.0


def test_a_zone_is_projected_onto_all_its_collisions_at_once() -> None:
    """Two vertices push one edge at two speeds: its line is known by hand, and no impulse alone gives it."""
    points = ((0.5, 0.99), (-0.5, 0.99))
    pairs, x = below_the_upper_edge(*points)
    wished = np.zeros_like(x)
    place = [int(np.flatnonzero((x == point).all(axis=1))[0]) for point in points]
    wished[place[0]], wished[place[1]] = (0.0, 0.02), (0.0, 0.04)
    velocity, systems = InelasticZones(pairs, 4).nearest(x, wished, 1.0)
    assert velocity is not None
    assert systems >= 1
    assert np.array_equal(velocity[4:], wished[4:])
    hits, _ = impacts(pairs, x, velocity, pairs.measure(x).distance, 1e-6)
    assert len(hits) == 0
    # β = 0.8 of the way to the line through both speeds, geometrically closer with every projection
    assert velocity[2, 1] < velocity[3, 1]


def test_a_zone_with_more_collisions_than_unknowns_fails() -> None:
    points = ((0.5, 0.99), (0.0, 0.99), (-0.5, 0.99))
    pairs, x = below_the_upper_edge(*points)
    wished = np.zeros_like(x)
    for point, speed in zip(points, (0.05, 0.02, 0.05), strict=True):
        wished[(x == point).all(axis=1)] = 0.0, speed
    velocity, _ = InelasticZones(pairs, 4).nearest(x, wished, 1.0)
    assert velocity is None


def test_the_final_pass_tightens() -> None:
    loose = Settings(contact=ElTopo(final_energy=NoEnergy()), fallback=None, tightening=Tightening(iterations=0))
    tight = Settings(contact=ElTopo(), fallback=None, tightening=Tightening(iterations=0))
    fine, coarse = letter_a(), letter_a_coarse()
    areas = [nested_cages(fine, [coarse], settings).levels[0].cage.area for settings in (loose, tight)]
    assert areas[1] < 0.97 * areas[0]
