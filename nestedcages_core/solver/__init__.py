"""Solvers: which steps lower an objective."""

from __future__ import annotations

from .base import Model, Objective, Solution, Solver
from .gradient_descent import GradientDescent
from .newton import ProjectedNewton

__all__ = ["GradientDescent", "Model", "Objective", "ProjectedNewton", "Solution", "Solver"]
