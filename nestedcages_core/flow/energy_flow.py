"""Descent of the penetration energy by smoothed Gauss-Newton steps, until the fine mesh is certified inside."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import FloatArray, IntArray
from ..geometry.mesh import Mesh
from ..geometry.precision import PATIENCE
from ..lapack import dpbsv
from ..progress import Tick
from .base import Obstacle
from .containment import Containment
from .penetration import Penetration, PenetrationEnergy

SLOW_DECREASE = 0.75
"""Relative decrease of the energy below which the next step is smoothed over half the length."""

SLOW_STEPS_LEAVE = 0.5
"""The descent fails if `PATIENCE` steps leave more than this fraction of the energy."""

SHORTEST_EDGE = 0.02
"""Lower bound on edge lengths in L, as a fraction of the sample spacing."""

DAMPING = 1e-4
"""ε, as a fraction of the sample spacing: keeps the matrix definite where there is no penetration."""


class Descent(NamedTuple):
    """Outcome of one descent."""

    start: FloatArray
    """(n, 2) positions before the first step."""
    steps: list[FloatArray]
    """Positions (n, 2) after each accepted step."""
    obstacle: Obstacle | None
    """None if the last position is certified inside, else the obstacle."""
    iterations: int
    """Number of steps, rejected ones included."""


class EnergyFlow(NamedTuple):
    """Descent of one energy; lengths in the units of the mesh."""

    energy: PenetrationEnergy
    containment: Containment
    system: StepSystem
    smoothing: float
    """First smoothing length."""
    longest_step: float
    """Cap on the change of a coordinate per step."""

    def descend(self, start: FloatArray, limit: int, tick: Tick) -> Descent:
        """At most ``limit`` steps from (n, 2) positions until certified inside.

        tick: called with the fraction of the limit before every step.
        """
        vertices, penetration = start, self.energy.at(start)
        steps: list[FloatArray] = []
        energies = [penetration.energy]
        smoothing = self.smoothing
        while True:
            if penetration.overlap < 0.0 and self.containment.obstacle(vertices) is None:
                return Descent(start, steps, None, len(energies) - 1)
            hopeless = len(energies) > PATIENCE and energies[-1] > SLOW_STEPS_LEAVE * energies[-1 - PATIENCE]
            if len(energies) > limit or hopeless or penetration.energy == 0.0:
                break
            tick((len(energies) - 1) / limit)
            found = self._step(vertices, penetration, smoothing)
            if found is not None:
                vertices, penetration = found
                steps.append(vertices)
            energies.append(penetration.energy)
            if energies[-1] > (1.0 - SLOW_DECREASE) * energies[-2]:
                smoothing *= 0.5
        return Descent(start, steps, self.containment.obstacle(vertices), len(energies) - 1)

    def _step(
        self, vertices: FloatArray, penetration: Penetration, smoothing: float
    ) -> tuple[FloatArray, Penetration] | None:
        """Positions of lower energy along the Gauss-Newton direction, or None."""
        direction = self.system.direction(penetration, smoothing)
        longest = float(np.abs(direction).max())
        length = min(1.0, self.longest_step / longest) if longest > 0.0 else 1.0
        moved = vertices + length * direction
        after = self.energy.at(moved)
        return (moved, after) if after.energy < penetration.energy else None


class StepSystem:
    """Gauss-Newton directions for the vertices of one mesh.

        (Jᵀ W J + ℓ² L + ε I) δ = -Jᵀ W z

    L is the stiffness matrix of the loops (Sobolev smoothing over the length ℓ): neighbours move together and the mesh
    does not tangle. Each sample moves the two ends of one edge, so the matrix couples neighbours along loops only.
    Numbered from both ends of a loop, 0, 1, k-1, 2, k-2, …, neighbours are at most two apart, and a banded Cholesky
    factorisation takes linear time.
    """

    def __init__(self, mesh: Mesh, unit: float) -> None:
        """unit: largest boundary length of a sample."""
        self._successor = mesh.successor
        self._stiffness: FloatArray = 1.0 / np.maximum(mesh.edge_lengths, SHORTEST_EDGE * unit)
        self._damping = DAMPING * unit
        self._row = 2 * _folded_numbering(mesh)
        high = np.maximum(self._row, self._row[mesh.successor])
        low = np.minimum(self._row, self._row[mesh.successor])
        size = 2 * len(mesh.vertices)
        self._height = 2 + int((high - low).max())  # of the band: two coordinates a vertex
        self._below = [(high - low + r - c) * size + low + c for r, c in ((0, 0), (0, 1), (1, 0), (1, 1))]

    def direction(self, penetration: Penetration, smoothing: float) -> FloatArray:
        """(n, 2) step δ; smoothing: the length ℓ."""
        n = len(self._row)
        edge, (x, y) = penetration.edge, penetration.direction.T
        other = self._successor[edge]
        there = penetration.parameter
        here = 1.0 - there
        weight = penetration.weight
        diagonal = np.empty((3, n))
        coupling = np.empty((3, n))
        for k, product in enumerate((x * x, x * y, y * y)):
            product *= weight
            diagonal[k] = np.bincount(edge, here * here * product, n) + np.bincount(other, there * there * product, n)
            coupling[k] = np.bincount(edge, here * there * product, n)
        stiffness = smoothing * smoothing * self._stiffness
        both = stiffness + np.bincount(self._successor, stiffness, n) + self._damping
        diagonal[0] += both
        diagonal[2] += both
        coupling[0] -= stiffness
        coupling[2] -= stiffness

        matrix = np.zeros((self._height, 2 * n))
        matrix[0, self._row], matrix[1, self._row], matrix[0, self._row + 1] = diagonal
        flat = matrix.reshape(-1)
        for place, k in zip(self._below, (0, 1, 1, 2), strict=True):
            flat[place] += coupling[k]
        force = np.empty(2 * n)
        pull = -weight * penetration.depth
        for offset, component in ((0, x), (1, y)):
            product = pull * component
            force[self._row + offset] = np.bincount(edge, here * product, n) + np.bincount(other, there * product, n)
        _, solution, failure = dpbsv(matrix, force, lower=1)
        if failure:
            raise np.linalg.LinAlgError(f"minor {failure} of the matrix of a flow step is not positive")
        return np.stack([solution[self._row], solution[self._row + 1]], axis=1)


def _folded_numbering(mesh: Mesh) -> IntArray:
    """(n,) numbers of the vertices such that neighbours on a loop are at most two apart."""
    number = np.empty(len(mesh.vertices), np.int64)
    offset = 0
    for loop in mesh.loops:
        place = np.arange(len(loop))
        folded = np.where(2 * place <= len(loop), 2 * place - 1, 2 * (len(loop) - place))
        folded[0] = 0
        number[loop] = offset + folded
        offset += len(loop)
    return number
