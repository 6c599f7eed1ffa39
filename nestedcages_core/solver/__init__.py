"""Solvers: minimise an objective by steps that lower it."""

from __future__ import annotations

from .base import NewtonModel, Objective, Solver, SolverResult
from .newton import ProjectedNewton

__all__ = [  # noqa: RUF022 - in the order of explanation
    "Objective",  # interface: value, gradient, Newton direction and largest valid step
    "NewtonModel",  # the first three at one state
    "Solver",  # interface: minimise an objective
    "SolverResult",  # where that ended
    "ProjectedNewton",  # Newton steps with positive semi-definite Hessians and backtracking
]
