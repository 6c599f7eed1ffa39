"""Nested Cages (Sacht, Vouga & Jacobson 2015) in the plane, section 5: expansion, its filter as published and ours."""

from __future__ import annotations

from .el_topo import ElTopo
from .velocity_filter import VelocityFilter

__all__ = [
    "ElTopo",  # as published: impulses one after the other, then inelastic impact zones
    "VelocityFilter",  # simplified: one quadratic program over all impacts
]
