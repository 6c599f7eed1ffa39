"""The default flow: from the fine mesh into the coarse one in few steps, by the cheapest stage that is enough.

Stages: inside (nothing to do); vertices (descent with samples at the vertices of both meshes); erosion (a tiny move
inwards, if the meshes only touch); boundary (descent with samples all along both); geodesic (limbs that the coarse mesh
cuts off are first drawn in along the inside of the fine mesh).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .._types import FloatArray
from ..mesh import Mesh
from .base import FlowResult, Obstacle, ProgressCallback, stuck
from .containment import Containment
from .energy_flow import EnergyFlow
from .erosion import erode
from .geodesic import Retraction, retract, solid_graph
from .matching import Matching, match_loops
from .penetration import PenetrationEnergy
from .samples import Spacing
from .smoothing import StepSystem

FINE_LIMIT, COARSE_LIMIT = 16, 64
"""Most samples on a fine and on a coarse edge."""

TOUCHING = 1e-9
"""Overlap up to which meshes are taken to touch only, in bounding-box diagonals: round-off of whatever made them."""

GRAPH_SPACING = 2.0
"""Spacing of the points that paths run over, in spacings of the samples."""

RETRACTIONS = ((True, 1.0), (False, 1.0), (False, 0.1), (False, 0.01))
"""Attempts of the geodesic stage: whether all pieces of the core are kept, and the share of the margin."""


@dataclass(frozen=True)
class TwoSidedFlow:
    """Descent of the penetration measured from both boundaries, loop by loop; lengths in diagonals of fine's box."""

    margin: float = 2e-3
    """Distance kept from the coarse mesh where there is room."""
    spacing: float = 1.0 / 300.0
    """Distance between samples along the boundaries."""
    smoothing: float = 0.01
    """Length over which a step is smoothed at first."""
    longest_step: float = 0.04
    """Cap on the motion of a vertex per step."""
    vertex_limit: int = 6
    """Most steps with samples at the vertices only."""
    limit: int = 20
    """Most steps of every other descent."""

    def run(self, fine: Mesh, coarse: Mesh, *, progress: ProgressCallback | None = None) -> FlowResult:
        """All steps from the fine mesh to a certified position strictly inside the coarse one.

        Raises: FlowError with the loop, the place and the cause, and the FlowResult so far as `partial`.
        """
        run = _Run(self, match_loops(fine, coarse))
        obstacle: Obstacle | None = None
        done = [fine.vertices]
        for number, attempt in enumerate(run.attempts()):
            if progress is not None:
                progress(number / (number + 2.0), f"Flow: {attempt.stage}")
            if attempt.obstacle is None:
                return FlowResult(np.array([fine.vertices, *attempt.steps]), run.iterations, attempt.stage)
            obstacle, stage = attempt.obstacle, attempt.stage
            done = [fine.vertices, *attempt.steps]
        assert obstacle is not None
        raise stuck(obstacle, done, run.iterations, stage)


@dataclass(frozen=True, eq=False)
class _Attempt:
    stage: str
    steps: list[FloatArray]
    """Positions after the fine mesh itself."""
    obstacle: Obstacle | None


class _Run:
    """The attempts of one run, each from the fine mesh itself unless it says otherwise."""

    def __init__(self, settings: TwoSidedFlow, matching: Matching) -> None:
        self.settings = settings
        self.matching = matching
        self.fine = matching.fine
        self.unit = matching.fine.diagonal
        self.containment = Containment(matching)
        self.iterations = 0

    def attempts(self) -> Iterator[_Attempt]:
        """One attempt after the other; the caller stops at the first without an obstacle."""
        start = self.fine.vertices
        if self.containment.boxes_nested(start):
            yield _Attempt("inside", [], self.containment.obstacle(start))
        self.system = StepSystem(self.fine, self.settings.spacing * self.unit)
        at_vertices = self.energy(np.inf)
        first = self.descend("vertices", at_vertices, [], self.settings.vertex_limit)
        yield first
        if at_vertices.at(start).overlap <= TOUCHING * self.unit:
            yield self.erosion()
        along_boundary = self.energy(self.settings.spacing * self.unit)
        yield self.descend("boundary", along_boundary, first.steps, self.settings.limit)
        yield from self.retractions()

    def erosion(self) -> _Attempt:
        """A tiny move inwards."""
        self.iterations += 1
        eroded = erode(self.fine, self.containment, self.settings.margin * self.unit)
        steps = [] if eroded is None else [eroded]
        return _Attempt("erosion", steps, Obstacle("") if eroded is None else None)

    def retractions(self) -> Iterator[_Attempt]:
        """Retraction of cut-off limbs, then descent from there."""
        settings = self.settings
        spacing = settings.spacing * self.unit
        for whole, share in RETRACTIONS:
            energy = self.energy(spacing, share)
            graph = solid_graph(self.matching, energy.margins, self.density(GRAPH_SPACING * spacing))
            found = retract(self.matching, graph, settings.longest_step * self.unit, whole=whole)
            if isinstance(found, Obstacle):
                yield _Attempt("geodesic", [], found)
                return
            self.iterations += len(found.steps)
            attempt = self.descend("geodesic", energy, found.steps, settings.limit)
            yield attempt if attempt.obstacle is None else _blame(attempt, found)

    def descend(self, stage: str, energy: PenetrationEnergy, before: list[FloatArray], limit: int) -> _Attempt:
        """Descent from the last of the steps before, or else from the fine mesh."""
        flow = EnergyFlow(
            energy,
            self.containment,
            self.system,
            self.settings.smoothing * self.unit,
            self.settings.longest_step * self.unit,
        )
        descent = flow.descend(before[-1] if before else self.fine.vertices, limit)
        self.iterations += descent.iterations
        return _Attempt(stage, before + descent.steps, descent.obstacle)

    def density(self, spacing: float) -> Spacing:
        return Spacing(spacing, self.settings.spacing * self.unit, FINE_LIMIT, COARSE_LIMIT)

    def energy(self, spacing: float, share: float = 1.0) -> PenetrationEnergy:
        return PenetrationEnergy(self.matching, share * self.settings.margin * self.unit, self.density(spacing))


def _blame(attempt: _Attempt, retraction: Retraction) -> _Attempt:
    """The attempt with the reason that the retraction has found, if any."""
    return _Attempt(attempt.stage, attempt.steps, retraction.pieces or attempt.obstacle)
