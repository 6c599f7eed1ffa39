"""The flow as the paper's program runs it (Gurditta & Jacobson 2022, section 3.1, Algorithms 1 and 2).

Ray parity decides what is inside, and hence the sign of the gradient. The text weighs a sample of Algorithm 2 at t by
(1 - t)², so that both edges count alike whatever their lengths. The program divides this by the length of the edge, so
that the shorter edge decides. In an integral along the edges, longer edges would weigh more.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..flow.base import FlowResult, Obstacle, stuck
from ..flow.containment import obstacle
from ..flow.matching import match_loops
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..geometry.predicates import winding_number
from ..parameters import check_count, check_flag, check_positive
from ..progress import Tick, no_tick
from .ray_parity import contained_by_parity, inside_by_parity

PAPER_DIAGONAL = float(np.sqrt(8.0))
"""Bounding-box diagonal of the annulus of the paper's Table 1."""

PROGRAM_STEP = 0.01
"""h of the program, whatever the size of the meshes."""


@dataclass(frozen=True)
class PaperFlow:
    """F ← F - h ∇̄ until the fine mesh is inside, with ∇̄ the gradient averaged over both edges and normalised."""

    step: float = PROGRAM_STEP / PAPER_DIAGONAL
    """h: in units of the input if `absolute`, else in bounding-box diagonals of the fine mesh; by default that of the
    program on the annulus of Table 1."""
    limit: int = 100
    """Maximum number of steps, that of the program. The program goes on with a mesh that is still outside, from an
    infinite energy; here that is an error."""
    samples: int = 4
    """Samples per edge, at t = 0, 1/samples, … from the vertex on, weighted (1 - t)²."""
    over_length: bool = True
    """Divide the weights by the length of the edge, as the program does; False: Algorithm 2 as the text has it."""
    exact_parity: bool = False
    """Repair: exact winding numbers and crossings instead of parity, which fails for rays through a vertex."""
    absolute: bool = False
    """Whether the step is a length in units of the input, as in the program."""

    def __post_init__(self) -> None:
        check_positive(self, "step")
        check_count(self, "limit", "samples")
        check_flag(self, "exact_parity", "over_length", "absolute")

    def scaled(self, factor: float) -> PaperFlow:
        """The same flow for meshes scaled by a factor."""
        return replace(self, step=self.step * factor) if self.absolute else self

    def run(self, fine: Mesh, coarse: Mesh, *, tick: Tick = no_tick) -> FlowResult:
        """All steps of the fine mesh, until the method's own test finds it inside.

        Raises: FlowError after ``limit`` steps with the cause, and the FlowResult so far as `partial`.
        """
        match_loops(fine, coarse)
        length = self.step * (1.0 if self.absolute else fine.diagonal)
        steps = [fine.vertices]
        while not self._inside(steps[-1], fine, coarse):
            if len(steps) > self.limit:
                blocked = obstacle(fine, coarse, steps[-1]) or Obstacle("A ray through a vertex deceives the parity")
                raise stuck(FlowResult(np.array(steps), self.limit, "paper", blocked))
            tick((len(steps) - 1) / self.limit)
            gradient = self._averaged_gradient(fine.moved(steps[-1]), coarse)
            outside = self._sign(steps[-1], coarse)
            steps.append(steps[-1] - length * outside[:, None] * gradient)
        return FlowResult(np.array(steps), len(steps) - 1, "paper")

    def _inside(self, vertices: FloatArray, fine: Mesh, coarse: Mesh) -> bool:
        if self.exact_parity:
            return obstacle(fine, coarse, vertices) is None
        return contained_by_parity(coarse.vertices, coarse.successor, vertices, fine.successor)

    def _sign(self, vertices: FloatArray, coarse: Mesh) -> FloatArray:
        """(n,) 1 outside the coarse mesh, -1 inside."""
        if self.exact_parity:
            return np.where(winding_number(vertices, coarse.vertices, coarse.edge_ends) == 0, 1.0, -1.0)
        return np.where(inside_by_parity(vertices, coarse.vertices, coarse.edge_ends), -1.0, 1.0)

    def _averaged_gradient(self, mesh: Mesh, coarse: Mesh) -> FloatArray:
        """(n, 2) mean direction from the closest points on the coarse mesh, of unit length (Algorithm 2)."""
        total = np.zeros_like(mesh.vertices)
        lengths = mesh.edge_lengths
        for t in np.arange(self.samples) / self.samples:
            pull = np.zeros_like(total)
            for neighbour, length in ((mesh.successor, lengths), (mesh.predecessor, lengths[mesh.predecessor])):
                unit = _away((1.0 - t) * mesh.vertices + t * mesh.vertices[neighbour], coarse)
                pull += unit / length[:, None] if self.over_length else unit
            total += (1.0 - t) ** 2 * pull
        return _unit_vectors(total)


def _away(points: FloatArray, coarse: Mesh) -> FloatArray:
    """(P, 2) unit vectors from the closest points on a mesh, 0 on it.

    In the order of operations of the program, since next to the coarse mesh they point where round-off says.
    """
    starts = coarse.vertices
    edge, to = coarse.vertices[coarse.successor] - starts, points[:, None] - starts
    inverse = 1.0 / (edge[:, 0] * edge[:, 0] + edge[:, 1] * edge[:, 1])
    t = edge[:, 0] * inverse * to[..., 0] + edge[:, 1] * inverse * to[..., 1]
    closest = np.where((t > 1.0)[..., None], coarse.vertices[coarse.successor], starts + t[..., None] * edge)
    closest = np.where((t < 0.0)[..., None], starts, closest)
    away = points[:, None] - closest
    nearest = (away[..., 0] * away[..., 0] + away[..., 1] * away[..., 1]).argmin(axis=1)
    return _unit_vectors(away[np.arange(len(points)), nearest])


def _unit_vectors(vectors: FloatArray) -> FloatArray:
    """(P, 2) of unit length; 0 stays 0."""
    squared = vectors[:, 0] * vectors[:, 0] + vectors[:, 1] * vectors[:, 1]
    return np.asarray(vectors / np.sqrt(np.where(squared > 0.0, squared, 1.0))[:, None], np.float64)
