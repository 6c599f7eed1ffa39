"""The flow down the signed distance of the coarse mesh (Gurditta & Jacobson 2022, section 3.1), with exact signs."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ...flow.base import FlowResult, stuck
from ...flow.containment import Containment
from ...flow.loop_matching import match_loops
from ...geometry.arrays import FloatArray
from ...geometry.mesh import Mesh
from ...geometry.signed_distance import SignedDistance
from ...parameters import check_count, check_part, check_positive
from ...progress import Tick, no_tick
from .quadrature import QuadraticFallOff, Quadrature, at_step, vertex_samples


@dataclass(frozen=True)
class SignedDistanceFlow:
    """Algorithm 1: steps of fixed length along the averaged gradient of Algorithm 2, until the fine mesh is inside."""

    step: float = 5e-3
    """Length of a step, in bounding-box diagonals of the fine mesh."""
    limit: int = 200
    """Maximum number of steps."""
    quadrature: Quadrature = field(default_factory=QuadraticFallOff)
    """Sample points and weights of the gradient around a vertex; `RandomSamples()` for new ones at every step."""

    def __post_init__(self) -> None:
        check_positive(self, "step")
        check_count(self, "limit")
        check_part(self, "quadrature", "rule", "Midpoint()")

    def run(self, fine: Mesh, coarse: Mesh, *, tick: Tick = no_tick) -> FlowResult:
        """All steps from the fine mesh to a certified position strictly inside the coarse one.

        Raises: FlowError with the loop, the place and the cause, and the FlowResult so far as `partial`.
        """
        containment = Containment(match_loops(fine, coarse))
        distance = SignedDistance.of(coarse)
        length = self.step * fine.diagonal
        steps = [fine.vertices]
        while (obstacle := containment.obstacle(steps[-1])) is not None:
            if len(steps) > self.limit:
                raise stuck(FlowResult(np.array(steps), self.limit, "signed distance", obstacle))
            tick((len(steps) - 1) / self.limit)
            quadrature = at_step(self.quadrature, len(steps))
            gradient = averaged_gradient(fine.moved(steps[-1]), distance, quadrature)
            steps.append(steps[-1] - length * gradient)
        return FlowResult(np.array(steps), len(steps) - 1, "signed distance")


def averaged_gradient(mesh: Mesh, distance: SignedDistance, quadrature: Quadrature) -> FloatArray:
    """(n, 2) weighted mean of the gradient of the signed distance over both edges of each vertex (Algorithm 2)."""
    points, weights = vertex_samples(mesh, quadrature)
    gradient = distance.at(points.reshape(-1, 2)).gradient.reshape(points.shape)
    return np.asarray((weights[..., None] * gradient).sum(axis=1), np.float64)
