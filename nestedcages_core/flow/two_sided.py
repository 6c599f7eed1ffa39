"""The default flow: from the fine mesh into the coarse one in few steps, by the cheapest method that succeeds.

In this order: inside (nothing to do); vertices (descent with samples at the vertices of both meshes); erosion (a tiny
move inwards where the meshes only touch); boundary (descent with samples along both boundaries); geodesic (limbs that
the coarse mesh cuts off are first drawn in along the inside of the fine mesh).
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias

import numpy as np

from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..parameters import check_count, check_flag, check_positive
from ..tasks import Stage, mapped
from .base import FlowResult, Obstacle, stuck
from .containment import Containment
from .energy_flow import Descent, EnergyFlow
from .erosion import erode
from .loop_matching import Matching, match_loops
from .penetration import Penetration, PenetrationEnergy
from .samples import Spacing
from .smoothing import StepSystem

logger = logging.getLogger(__name__)

FINE_LIMIT, COARSE_LIMIT = 16, 64
"""Maximum number of samples on a fine and on a coarse edge."""

MAX_CONTACT_OVERLAP = 1e-9
"""Overlap up to which meshes count as touching, in extents of the fine mesh: round-off of the decimation."""

GRAPH_SPACING = 2.0
"""Spacing of the points of geodesic paths, in spacings of the samples."""

NARROW_MARGIN = 0.1
"""Fraction of the margin in the last method tried."""


@dataclass(frozen=True)
class TwoSidedFlow:
    """Descent of the penetration measured from both boundaries, loop by loop; lengths in extents of the fine mesh."""

    margin: float = 3e-3
    """Distance to the coarse mesh where there is space."""
    spacing: float = 1.0 / 300.0
    """Distance between samples along the boundaries."""
    smoothing: float = 0.01
    """Initial smoothing length of a step."""
    longest_step: float = 0.04
    """Maximum motion of a coordinate per step."""
    vertex_limit: int = 6
    """Maximum number of steps with samples at the vertices only (docs/ablation.md: flow: steps with samples at
    vertices)."""
    limit: int = 20
    """Maximum number of steps of every other descent."""
    detours: bool = True
    """Whether to try the geodesic stage, which takes many steps; without it, coarse meshes that cut off limbs are an
    error."""

    def __post_init__(self) -> None:
        check_positive(self, "margin", "spacing", "smoothing", "longest_step")
        check_count(self, "vertex_limit", "limit")
        check_flag(self, "detours")

    @property
    def quick(self) -> TwoSidedFlow:
        """The same with half of the steps and without its slow last stages, for use where hulls compete."""
        return replace(self, limit=self.limit // 2, detours=False)

    def run(self, fine: Mesh, coarse: Mesh) -> Stage[float, FlowResult]:
        """All steps from the fine mesh to a certified position strictly inside the coarse one.

        A generator: yields the fraction done and returns the result.

        Raises: FlowError with the loop, the place and the cause, and the FlowResult so far as `partial`.
        """
        run = _Run(self, match_loops(fine, coarse))
        result = None
        for tried, method in enumerate(run.methods()):
            found = yield from mapped(method, partial(_fraction, tried))
            if found is None:
                continue
            result = found
            logger.debug("flow by %s: %d steps, %d iterations so far: %s", result.stage, len(result.steps) - 1,
                         result.iterations, result.reason or "inside")  # fmt: skip
            if result.obstacle is None:
                return result
        assert result is not None
        raise stuck(result)


def _fraction(tried: int, done: float) -> float:
    """Fraction of the flow that is done, if every further method takes half of the rest."""
    return 1.0 - 0.5**tried * (1.0 - 0.5 * done)


Method: TypeAlias = Stage[float, FlowResult | None]
"""One method of the flow; its result is None where it does not apply."""


class _Run:
    """The methods on one pair of meshes."""

    def __init__(self, settings: TwoSidedFlow, matching: Matching) -> None:
        self.settings = settings
        self.matching = matching
        self.fine = matching.fine
        self.unit = matching.fine.extent
        self.containment = Containment(matching)
        self.iterations = 0
        self.system: StepSystem
        self.only_touching = self.in_pieces = False

    def methods(self) -> Iterator[Method]:
        """The methods to try until one has no obstacle; the last result explains a failure best."""
        yield self.inside()
        self.system = StepSystem(self.fine, self.settings.spacing * self.unit)
        yield self.vertices()
        yield self.erosion()
        yield self.boundary()
        if not self.settings.detours:
            return
        for whole in (True, False):
            yield self.geodesic(1.0, whole)
        for whole in (True, False):
            yield self.geodesic(NARROW_MARGIN, whole)

    def inside(self) -> Method:
        """No steps, if the fine mesh is already inside."""
        home = self.fine.vertices
        if not self.containment.boxes_nested(home):
            return None
        yield 0.0
        return self.result("inside", [], self.containment.obstacle(home))

    def vertices(self) -> Method:
        """Descent with samples at the vertices only."""
        energy = self.energy(np.inf)
        home = energy.at(self.fine.vertices)
        self.only_touching = home.overlap <= MAX_CONTACT_OVERLAP * self.unit
        self.first = yield from self.descend(energy, self.fine.vertices, self.settings.vertex_limit, home)
        return self.result("vertices", self.first.steps, self.first.obstacle)

    def erosion(self) -> Method:
        """A small inward offset, where that is enough."""
        if not self.only_touching:
            return None
        yield 0.0
        eroded = erode(self.fine, self.containment, self.settings.margin * self.unit)
        self.iterations += 1
        return None if eroded is None else self.result("erosion", [eroded], None)

    def boundary(self) -> Method:
        """Descent with samples along the boundaries, from where that at the vertices ended."""
        energy = self.energy(self.settings.spacing)
        second = yield from self.descend(energy, self.first.end, self.settings.limit)
        return self.result("boundary", self.first.steps + second.steps, second.obstacle)

    def geodesic(self, share: float, whole: bool) -> Method:
        """Retraction of the limbs that are cut off, then descent from there.

        share: fraction of the margin; whole: with all pieces of the overlap, else with the largest only, if there are
        several.
        """
        from .geodesic import retract, solid_graph  # the last stage, which few flows reach

        settings = self.settings
        if whole:
            self.sampled = self.energy(settings.spacing, share)
            spacing = self.density(GRAPH_SPACING * settings.spacing)
            self.graph = solid_graph(self.matching, self.sampled.margins, spacing)
        elif not self.in_pieces:
            return None
        yield 0.0
        retraction = retract(self.matching, self.graph, settings.longest_step * self.unit, whole=whole)
        self.in_pieces = not isinstance(retraction, Obstacle) and retraction.pieces is not None
        if isinstance(retraction, Obstacle):
            return self.result("geodesic", [], retraction)
        self.iterations += len(retraction.steps)
        start = retraction.steps[-1] if retraction.steps else self.fine.vertices
        descent = yield from self.descend(self.sampled, start, settings.limit)
        obstacle = None if descent.obstacle is None else retraction.pieces or descent.obstacle
        return self.result("geodesic", retraction.steps + descent.steps, obstacle)

    def descend(
        self, energy: PenetrationEnergy, start: FloatArray, limit: int, at_start: Penetration | None = None
    ) -> Stage[float, Descent]:
        """Descent of an energy from (n, 2) positions; at_start: its penetration there, if it is known."""
        smoothing, longest = self.settings.smoothing * self.unit, self.settings.longest_step * self.unit
        flow = EnergyFlow(energy, self.containment, self.system, smoothing, longest)
        descent = yield from flow.descend(start, limit, at_start)
        self.iterations += descent.iterations
        return descent

    def result(self, stage: str, steps: list[FloatArray], obstacle: Obstacle | None) -> FlowResult:
        """The result of one method, whose steps follow the fine mesh itself."""
        return FlowResult(np.array([self.fine.vertices, *steps]), self.iterations, stage, obstacle)

    def density(self, spacing: float) -> Spacing:
        """Sample density for a spacing in extents."""
        return Spacing(spacing * self.unit, self.settings.spacing * self.unit, FINE_LIMIT, COARSE_LIMIT)

    def energy(self, spacing: float, share: float = 1.0) -> PenetrationEnergy:
        """Penetration energy for a spacing in extents and a share of the margin."""
        return PenetrationEnergy(self.matching, share * self.settings.margin * self.unit, self.density(spacing))
