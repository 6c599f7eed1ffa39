"""Quadrature: rules against integrals, samples against shapely, and the paper's flow with each of them."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import shapely

from nestedcages_core import (
    EvenSamples,
    GaussLegendre,
    Mesh,
    Midpoint,
    QuadraticFallOff,
    RandomSamples,
    Settings,
    SignedDistanceFlow,
    nested_cages,
)
from nestedcages_core.published.gurditta_jacobson_2022.quadrature import Quadrature, at_step, vertex_samples
from nestedcages_core.tasks import drain
from support.marks import slow_after
from support.shapes import annulus, assert_nested, octagon_with_hole, polygon, square_with_hole, star

GAUSS = tuple(GaussLegendre(points) for points in (1, 2, 3))
RULES = (QuadraticFallOff(), QuadraticFallOff(7), Midpoint(), *GAUSS, EvenSamples(), EvenSamples(1), RandomSamples())
BY_NAME = pytest.mark.parametrize("rule", RULES, ids=repr)


@BY_NAME
def test_weights_share_out_one(rule: Quadrature) -> None:
    parameters, weights = rule.rule
    assert parameters.shape == weights.shape
    assert (parameters >= 0.0).all()
    assert (parameters < 1.0).all()
    assert (weights > 0.0).all()
    assert weights.sum() == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize("points", [1, 2, 3])
def test_gauss_points_integrate_polynomials_against_the_hat_function(points: int) -> None:
    """2 ∫ (1 - t) t^k = 2 / ((k + 1) (k + 2)), for all k that n points are good for; not for the next one."""
    parameters, weights = GaussLegendre(points).rule
    exact = [float(Fraction(2, (k + 1) * (k + 2))) for k in range(2 * points)]
    values = [float(weights @ parameters**k) for k in range(2 * points)]
    assert values[:-1] == pytest.approx(exact[:-1], abs=1e-14)
    assert abs(values[-1] - exact[-1]) > 1e-4


def test_random_samples_are_new_at_every_step_and_the_same_in_every_run() -> None:
    rules = [at_step(RandomSamples(8), step).rule.parameters for step in (0, 1, 2)]
    assert np.floor(8.0 * np.stack(rules)).tolist() == [list(range(8))] * 3
    assert len({float(rule[0]) for rule in rules}) == 3
    assert np.array_equal(rules[1], at_step(RandomSamples(8), 1).rule.parameters)
    assert at_step(Midpoint(), 3) == Midpoint()

    def steps(rule: Quadrature) -> np.ndarray:
        flow = SignedDistanceFlow(quadrature=rule)
        return drain(flow.run(octagon_with_hole(), square_with_hole())).steps

    assert np.array_equal(steps(RandomSamples()), steps(RandomSamples()))
    assert not np.array_equal(steps(RandomSamples())[2], steps(RandomSamples(seed=1))[2])


@BY_NAME
def test_samples_lie_on_the_edges_of_their_vertex(rule: Quadrature) -> None:
    mesh = star(5, 40)
    points, weights = vertex_samples(mesh, rule)
    assert weights.sum(axis=1) == pytest.approx(1.0, abs=1e-14)
    for v in range(len(mesh.vertices)):
        both = shapely.LineString(mesh.vertices[[mesh.predecessor[v], v, mesh.successor[v]]])
        assert max(both.distance(shapely.Point(point)) for point in points[v]) < 1e-14


@BY_NAME
def test_longer_edges_weigh_more(rule: Quadrature) -> None:
    box = Mesh.from_loops([[(0, 0), (3, 0), (3, 1), (0, 1)]])
    _, weights = vertex_samples(box, rule)
    share = weights[0].reshape(2, -1).sum(axis=1)
    assert share == pytest.approx([0.75, 0.25])


@pytest.mark.parametrize("rule", slow_after(0, RULES, thorough_after=3), ids=repr)
def test_the_flow_of_the_paper_gets_inside_with_every_rule(rule: Quadrature) -> None:
    settings = Settings(flow=SignedDistanceFlow(quadrature=rule), fallback=None)
    for fine, coarse in ((annulus(48), annulus(12)), (octagon_with_hole(), square_with_hole())):
        level = nested_cages(fine, [coarse], settings).levels[0]
        assert_nested(level.cage, level.fine)
        assert len(level.flow.steps) > 1
        assert polygon(coarse).covers(polygon(fine.moved(level.flow.steps[-1])))
