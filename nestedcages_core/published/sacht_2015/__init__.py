"""Nested Cages (Sacht, Vouga & Jacobson 2015): the velocity filter and its impact zones in the plane."""

from __future__ import annotations

from .velocity_filter import VelocityFilter

__all__ = ["VelocityFilter"]
