"""Barrier, distance and collision detection against IPC Toolkit, an independent implementation; skipped without it."""

from __future__ import annotations

import numpy as np
import pytest
from test_ccd import collinear_motions, pairs_of

from benchmarks.li_2020.barrier import distance_hessian
from nestedcages_core.contact.barrier import barrier
from nestedcages_core.contact.ccd import SAFETY, impacts
from nestedcages_core.geometry.distance import distance_gradient, point_edge
from support.marks import slow_after

ipctk = pytest.importorskip("ipctk")


def test_barrier_and_its_derivatives() -> None:
    random = np.random.default_rng(0)
    d_hat = random.uniform(1e-3, 1.0, 300)
    distance = d_hat * random.uniform(1e-6, 1.2, 300)
    terms = barrier(distance, d_hat)
    theirs = ipctk.ClampedLogBarrier()
    for name, method in (("value", theirs), ("first", theirs.first_derivative), ("second", theirs.second_derivative)):
        expected = [method(float(d), float(limit)) for d, limit in zip(distance, d_hat, strict=True)]
        np.testing.assert_allclose(getattr(terms, name), expected, rtol=1e-10, atol=1e-15)


def test_distances_and_their_derivatives() -> None:
    """IPC Toolkit squares the distance: ∂(d²) = 2 d ∂d and ∂²(d²) = 2 (∂d ∂dᵀ + d ∂²d)."""
    p, a, b = np.random.default_rng(1).normal(size=(3, 200, 2))
    pair = point_edge(p, a, b)
    gradient, hessian = distance_gradient(pair), distance_hessian(pair, a, b)
    for k in range(len(p)):
        d, slope = pair.distance[k], gradient[k]
        assert d**2 == pytest.approx(ipctk.point_edge_distance(p[k], a[k], b[k]))
        theirs = ipctk.point_edge_distance_gradient(p[k], a[k], b[k])
        np.testing.assert_allclose(2.0 * d * slope, theirs, rtol=1e-9, atol=1e-12)
        theirs = ipctk.point_edge_distance_hessian(p[k], a[k], b[k])
        np.testing.assert_allclose(2.0 * (np.outer(slope, slope) + d * hessian[k]), theirs, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("motion", slow_after(1, ["random", "collinear"]))
def test_no_step_goes_beyond_an_impact(motion: str) -> None:
    count = 600 if motion == "random" else 30  # the interval search of IPC Toolkit takes long on a line
    random = np.random.default_rng(2)
    x, v = random.normal(size=(2, 3 * count, 2))
    if motion == "collinear":
        x, v, _ = collinear_motions(count)
    pairs = pairs_of(count)
    found = np.full(count, np.inf)
    hit, time = impacts(pairs, x, v, pairs.measure(x).distance)
    found[hit] = time
    ccd = ipctk.TightInclusionCCD(tolerance=1e-9)
    theirs = [ccd.point_edge_ccd(*x[3 * k : 3 * k + 3], *(x + v)[3 * k : 3 * k + 3]) for k in range(count)]
    met = np.array([hit for hit, _ in theirs])
    when = np.array([time for _, time in theirs])
    assert met.sum() > 10
    assert (SAFETY * found[met] <= when[met]).all()  # the steps that are taken end before their impacts
    assert np.count_nonzero(np.isfinite(found) & ~met) <= 0.35 * met.sum()  # near misses of an end count, by design
