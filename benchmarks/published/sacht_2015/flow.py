"""The flow of Sacht et al. (2015, section 4.1): down the signed distance, with the gradient at midpoints of edges.

The program keeps the edge lengths of the fine mesh as weights; here the weights are those of the moving mesh.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nestedcages_core import FlowResult, Mesh, Midpoint
from nestedcages_core.flow.base import stuck
from nestedcages_core.flow.containment import Containment
from nestedcages_core.flow.loop_matching import match_loops
from nestedcages_core.geometry.signed_distance import SignedDistance
from nestedcages_core.geometry.vectors import bounds
from nestedcages_core.parameters import check_count, check_positive
from nestedcages_core.published.gurditta_jacobson_2022.signed_distance_flow import averaged_gradient
from nestedcages_core.tasks import Stage


@dataclass(frozen=True)
class SachtFlow:
    """Steps of fixed length along the averaged gradient, until the fine mesh is inside."""

    step: float = 1e-3
    """Length of a step, in longest sides of the box around both meshes."""
    limit: int = 1000
    """Maximum number of steps."""

    def __post_init__(self) -> None:
        check_positive(self, "step")
        check_count(self, "limit")

    def run(self, fine: Mesh, coarse: Mesh) -> Stage[float, FlowResult]:
        """All steps from the fine mesh to a certified position strictly inside the coarse one. Raises: FlowError."""
        containment, distance = Containment(match_loops(fine, coarse)), SignedDistance.of(coarse)
        low, high = bounds(np.concatenate([fine.vertices, coarse.vertices]))
        length = self.step * float((high - low).max())
        steps = [fine.vertices]
        while (obstacle := containment.obstacle(steps[-1])) is not None:
            if len(steps) > self.limit:
                raise stuck(FlowResult(np.array(steps), self.limit, "signed distance", obstacle))
            yield (len(steps) - 1) / self.limit
            steps.append(steps[-1] - length * averaged_gradient(fine.moved(steps[-1]), distance, Midpoint()))
        return FlowResult(np.array(steps), len(steps) - 1, "signed distance")
