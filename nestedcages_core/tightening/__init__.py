"""Tightening: the fine mesh is home, and the cage goes to a local optimum of its energy at the wanted clearance."""

from __future__ import annotations

from .tightening import Tightening, TighteningOutcome

__all__ = ["Tightening", "TighteningOutcome"]
