"""Quadrature along the edges of a mesh: where a field is sampled, and the weight of each sample at a vertex.

A rule describes an edge seen from one of its ends: ``parameters`` run from 0 at the vertex to 1 at the other end.
The gradient of the flow at a vertex is the weighted mean of the field over both incident edges, by length.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol

import numpy as np
import scipy

from ...geometry.arrays import FloatArray
from ...geometry.mesh import Mesh
from ...parameters import check_count

__all__ = [
    "EvenSamples",
    "GaussLegendre",
    "Midpoint",
    "QuadraticFallOff",
    "Quadrature",
    "RandomSamples",
    "at_step",
    "vertex_samples",
]


class EdgeRule(NamedTuple):
    """Sample points of a rule on an edge, seen from one end of it."""

    parameters: FloatArray
    """(Q,) positions in [0, 1], 0 at the vertex."""
    weights: FloatArray
    """(Q,) weights ≥ 0 that sum to one."""


class Quadrature(Protocol):
    """A choice of sample points along an edge."""

    @property
    def rule(self) -> EdgeRule:
        """Positions and weights as seen from one end of the edge."""


@dataclass(frozen=True)
class QuadraticFallOff:
    """Even samples from the vertex on, with weights (1 - t)² that fall off from it, integrated along both edges.

    Samples and fall-off are those of Gurditta & Jacobson 2022, Algorithm 2. There both edges count alike, whatever
    their lengths: that is ``PaperFlow(over_length=False)``.
    """

    samples: int = 4
    """Samples per edge, at t = 0, 1/samples, …"""

    def __post_init__(self) -> None:
        check_count(self, "samples")

    @property
    def rule(self) -> EdgeRule:
        """(Q,) t = k / Q and (1 - t)², normalised."""
        parameters = np.arange(self.samples) / self.samples
        return _unit_rule(parameters, (1.0 - parameters) ** 2)


@dataclass(frozen=True)
class Midpoint:
    """One sample in the middle of each edge (the barycentre rule of Sacht et al. 2015, section 4)."""

    @property
    def rule(self) -> EdgeRule:
        """(1,) t = 1/2."""
        return EdgeRule(np.array([0.5]), np.array([1.0]))


@dataclass(frozen=True)
class GaussLegendre:
    """Gauss points weighted by the hat function 1 - t of the vertex; exact for fields of degree 2 · points - 2."""

    points: int = 2

    def __post_init__(self) -> None:
        check_count(self, "points")

    @property
    def rule(self) -> EdgeRule:
        """(Q,) Gauss-Legendre points on [0, 1] and weights w (1 - t), normalised."""
        nodes, weights = scipy.special.roots_legendre(self.points)
        parameters = 0.5 * (nodes + 1.0)
        return _unit_rule(parameters, weights * (1.0 - parameters))


@dataclass(frozen=True)
class EvenSamples:
    """Even samples, each in the middle of its share of the edge, weighted by the vertex's hat function 1 - t."""

    samples: int = 4

    def __post_init__(self) -> None:
        check_count(self, "samples")

    @property
    def rule(self) -> EdgeRule:
        """(Q,) t = (k + 1/2) / Q and 1 - t, normalised."""
        parameters = (np.arange(self.samples) + 0.5) / self.samples
        return _unit_rule(parameters, 1.0 - parameters)


@dataclass(frozen=True)
class RandomSamples:
    """A random sample in each of equal parts of an edge, new ones at every step of the flow; repeatable.

    Further work of Gurditta & Jacobson 2022 (section 5). Weighted by the vertex's hat function 1 - t.
    """

    samples: int = 4
    seed: int = 0
    step: int = 0
    """Step of the flow; see `at_step`."""

    def __post_init__(self) -> None:
        check_count(self, "samples")
        check_count(self, "seed", "step", least=0)

    @property
    def rule(self) -> EdgeRule:
        """(Q,) t in the k-th of Q parts and 1 - t, normalised."""
        random = np.random.default_rng((self.seed, self.step))
        parameters = (np.arange(self.samples) + random.random(self.samples)) / self.samples
        return _unit_rule(parameters, 1.0 - parameters)


def at_step(quadrature: Quadrature, step: int) -> Quadrature:
    """The quadrature of a step of the flow: only `RandomSamples` differs from step to step."""
    return replace(quadrature, step=step) if isinstance(quadrature, RandomSamples) else quadrature


class VertexSamples(NamedTuple):
    """Sample points around every vertex of a mesh with n vertices; each vertex has 2Q of them."""

    points: FloatArray
    """(n, 2Q, 2) positions on the two incident edges."""
    weights: FloatArray
    """(n, 2Q) shares of the samples in the mean at the vertex; they sum to one."""


def vertex_samples(mesh: Mesh, quadrature: Quadrature) -> VertexSamples:
    """Sample points and weights of a rule on both edges around each of the n vertices."""
    parameters, weights = quadrature.rule
    at = mesh.vertices[:, None]
    forth = mesh.vertices[mesh.successor][:, None] - at
    back = mesh.vertices[mesh.predecessor][:, None] - at
    points = np.concatenate([at + parameters[:, None] * forth, at + parameters[:, None] * back], axis=1)
    length_forth, length_back = mesh.edge_lengths, mesh.edge_lengths[mesh.predecessor]
    both = length_forth + length_back
    share = np.divide(length_forth, both, out=np.full_like(both, 0.5), where=both > 0.0)
    return VertexSamples(points, np.concatenate([share[:, None] * weights, (1.0 - share)[:, None] * weights], axis=1))


def _unit_rule(parameters: FloatArray, weights: FloatArray) -> EdgeRule:
    return EdgeRule(parameters, weights / weights.sum())
