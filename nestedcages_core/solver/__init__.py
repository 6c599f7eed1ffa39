"""Solvers: which steps lower an objective."""

from __future__ import annotations

from .base import Model, Objective, Solution, Solver
from .newton import ProjectedNewton

__all__ = ["Model", "Objective", "ProjectedNewton", "Solution", "Solver"]
