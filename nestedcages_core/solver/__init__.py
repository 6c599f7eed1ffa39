"""Solvers: which steps lower an objective."""

from __future__ import annotations

from .base import NewtonModel, Objective, Solver, SolverResult
from .newton import ProjectedNewton

__all__ = ["NewtonModel", "Objective", "ProjectedNewton", "Solver", "SolverResult"]
