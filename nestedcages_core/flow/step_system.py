"""Gauss-Newton directions of the flow.

    (Jᵀ W J + ℓ² L + ε I) δ = -Jᵀ W z

L is the stiffness matrix of the loops (Sobolev smoothing over the length ℓ): neighbours move together and the mesh does
not tangle. Each sample moves the two ends of one edge, so the matrix couples neighbours along loops only.
"""

from __future__ import annotations

import numpy as np

from ..energies import Blocks
from ..energies.base import assembled_gradient, assembled_hessian
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..solver.banded import BandOrder, banded_solver
from .penetration import Penetration

SHORTEST_EDGE = 0.02
"""Lower bound on edge lengths in L, as a fraction of the sample spacing."""

DAMPING = 1e-4
"""ε, as a fraction of the sample spacing: keeps the matrix definite where there is no penetration."""


class StepSystem:
    """The directions for the vertices of one mesh."""

    def __init__(self, mesh: Mesh, unit: float) -> None:
        """unit: largest boundary length of a sample."""
        vertex = np.arange(len(mesh.vertices))
        self._edges = np.stack([vertex, mesh.successor], axis=1)
        stiffness = 1.0 / np.maximum(mesh.edge_lengths, SHORTEST_EDGE * unit)
        difference = np.kron([[1.0, -1.0], [-1.0, 1.0]], np.eye(2))
        self._smooth = assembled_hessian(self._edges, stiffness[:, None, None] * difference)
        self._damping = Blocks(vertex, vertex, np.broadcast_to(DAMPING * unit * np.eye(2), (len(vertex), 2, 2)))
        self._order = BandOrder.along(mesh.loop_order)

    def direction(self, penetration: Penetration, smoothing: float) -> FloatArray:
        """(n, 2) step δ; smoothing: the length ℓ."""
        corners, weight, there = self._edges[penetration.edge], penetration.weight, penetration.parameter
        shares = np.stack([1.0 - there, there], axis=1)
        moved = shares[:, :, None] * penetration.direction[:, None]
        jacobian = moved.reshape(-1, 4)
        pulling = assembled_hessian(corners, weight[:, None, None] * jacobian[:, :, None] * jacobian[:, None])
        matrix = Blocks.sum([(1.0, pulling), (smoothing * smoothing, self._smooth), (1.0, self._damping)])
        solve = banded_solver(matrix, self._order)
        if solve is None:
            raise np.linalg.LinAlgError("The matrix of a step of the flow is not positive definite.")
        force = -(weight * penetration.depth)[:, None, None] * moved
        return solve(assembled_gradient(corners, force, len(self._edges)))
