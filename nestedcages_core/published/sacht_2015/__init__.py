"""Nested Cages (Sacht, Vouga & Jacobson 2015) in the plane, section 5: expansion with a velocity filter."""

from __future__ import annotations

from .velocity_filter import VelocityFilter

__all__ = [
    "VelocityFilter",  # prescribed fine velocities, cage velocities filtered by impact zones
]
