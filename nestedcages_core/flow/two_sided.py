"""The default flow: from the fine mesh into the coarse one in few steps, by the cheapest stage that is enough.

Stages: inside (nothing to do); vertices (descent with samples at the vertices of both meshes); erosion (a tiny move
inwards, if the meshes only touch); boundary (descent with samples all along both); geodesic (limbs that the coarse mesh
cuts off are first drawn in along the inside of the fine mesh); correspondence (fine is laid along the coarse mesh).
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from .base import FlowResult, Obstacle, ProgressCallback, stuck
from .containment import Containment
from .correspondence import lay_along
from .energy_flow import Descent, EnergyFlow
from .erosion import erode
from .geodesic import retract, solid_graph
from .loop_matching import Matching, match_loops
from .penetration import PenetrationEnergy
from .samples import Spacing
from .smoothing import StepSystem

logger = logging.getLogger(__name__)

FINE_LIMIT, COARSE_LIMIT = 16, 64
"""Most samples on a fine and on a coarse edge."""

TOUCHING = 1e-9
"""Overlap up to which meshes are taken to touch only, in extents of the fine mesh: round-off of whatever made them."""

GRAPH_SPACING = 2.0
"""Spacing of the points that paths run over, in spacings of the samples."""

NARROW = 0.1
"""Share of the margin in the last attempt."""


@dataclass(frozen=True)
class TwoSidedFlow:
    """Descent of the penetration measured from both boundaries, loop by loop; lengths in extents of the fine mesh."""

    margin: float = 3e-3
    """Distance kept from the coarse mesh where there is room."""
    spacing: float = 1.0 / 300.0
    """Distance between samples along the boundaries."""
    smoothing: float = 0.01
    """Length over which a step is smoothed at first."""
    longest_step: float = 0.04
    """Cap on the motion of a coordinate per step."""
    vertex_limit: int = 6
    """Most steps with samples at the vertices only."""
    limit: int = 20
    """Most steps of every other descent."""

    def run(self, fine: Mesh, coarse: Mesh, *, progress: ProgressCallback | None = None) -> FlowResult:
        """All steps from the fine mesh to a certified position strictly inside the coarse one.

        Raises: FlowError with the loop, the place and the cause, and the FlowResult so far as `partial`.
        """
        run = _Run(self, match_loops(fine, coarse))
        for tried, result in enumerate(run.attempts()):
            cause = "inside" if result.obstacle is None else result.obstacle.cause
            logger.debug("flow by %s: %d steps, %d iterations so far: %s", result.stage, len(result.steps) - 1,
                         result.iterations, cause)  # fmt: skip
            if result.obstacle is None:
                return result
            if progress is not None:
                progress(1.0 - 0.5 ** (tried + 1), f"Flow by {result.stage}: {result.obstacle.cause}")
        raise stuck(result)


class _Run:
    """The attempts of one run."""

    def __init__(self, settings: TwoSidedFlow, matching: Matching) -> None:
        self.settings = settings
        self.matching = matching
        self.fine = matching.fine
        self.unit = matching.fine.extent
        self.containment = Containment(matching)
        self.iterations = 0

    def attempts(self) -> Iterator[FlowResult]:
        """At least one attempt, until one has no obstacle; the last one says best what is wrong."""
        home, settings = self.fine.vertices, self.settings
        if self.containment.boxes_nested(home):
            yield self.result("inside", [], self.containment.obstacle(home))
        self.system = StepSystem(self.fine, settings.spacing * self.unit)
        at_vertices = self.energy(np.inf)
        first = self.descend(at_vertices, home, settings.vertex_limit)
        yield self.result("vertices", first.steps, first.obstacle)
        if at_vertices.at(home).overlap <= TOUCHING * self.unit:
            yield from self.erosion()
        second = self.descend(self.energy(settings.spacing), first.end, settings.limit)
        yield self.result("boundary", first.steps + second.steps, second.obstacle)
        yield from self.retraction(1.0)
        yield from self.correspondence()
        yield from self.retraction(NARROW)

    def erosion(self) -> Iterator[FlowResult]:
        """A tiny move inwards, if that is enough."""
        eroded = erode(self.fine, self.containment, self.settings.margin * self.unit)
        self.iterations += 1
        if eroded is not None:
            yield self.result("erosion", [eroded], None)

    def retraction(self, share: float) -> Iterator[FlowResult]:
        """Retraction of cut-off limbs, then descent from there: with all pieces, then with the largest only.

        share: of the margin.
        """
        settings = self.settings
        energy = self.energy(settings.spacing, share)
        graph = solid_graph(self.matching, energy.margins, self.density(GRAPH_SPACING * settings.spacing))
        for whole in (True, False):
            way = retract(self.matching, graph, settings.longest_step * self.unit, whole=whole)
            if isinstance(way, Obstacle):
                yield self.result("geodesic", [], way)
                return
            self.iterations += len(way.steps)
            descent = self.descend(energy, way.steps[-1] if way.steps else self.fine.vertices, settings.limit)
            obstacle = None if descent.obstacle is None else way.pieces or descent.obstacle
            yield self.result("geodesic", way.steps + descent.steps, obstacle)
            if way.pieces is None:
                return

    def correspondence(self) -> Iterator[FlowResult]:
        """Straight to positions along the inside of the coarse mesh, if there are such."""
        laid = lay_along(self.matching, self.settings.margin * self.unit)
        if laid is None or self.containment.obstacle(laid) is not None:
            return
        way = laid - self.fine.vertices
        count = int(np.ceil(np.abs(way).max() / (self.settings.longest_step * self.unit)))
        self.iterations += count
        steps = [self.fine.vertices + (k / count) * way for k in range(1, count)]
        yield self.result("correspondence", [*steps, laid], None)

    def descend(self, energy: PenetrationEnergy, start: FloatArray, limit: int) -> Descent:
        """Descent of an energy from (n, 2) positions."""
        smoothing, longest = self.settings.smoothing * self.unit, self.settings.longest_step * self.unit
        descent = EnergyFlow(energy, self.containment, self.system, smoothing, longest).descend(start, limit)
        self.iterations += descent.iterations
        return descent

    def result(self, stage: str, steps: list[FloatArray], obstacle: Obstacle | None) -> FlowResult:
        """The result of one attempt, whose steps follow the fine mesh itself."""
        return FlowResult(np.array([self.fine.vertices, *steps]), self.iterations, stage, obstacle)

    def density(self, spacing: float) -> Spacing:
        """Sample density for a spacing in extents."""
        return Spacing(spacing * self.unit, self.settings.spacing * self.unit, FINE_LIMIT, COARSE_LIMIT)

    def energy(self, spacing: float, share: float = 1.0) -> PenetrationEnergy:
        """Penetration energy for a spacing in extents and a share of the margin."""
        return PenetrationEnergy(self.matching, share * self.settings.margin * self.unit, self.density(spacing))
