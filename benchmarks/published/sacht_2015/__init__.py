"""Nested Cages (Sacht, Vouga & Jacobson 2015) in the plane: its flow, and expansion with the filter as published."""

from .el_topo import ElTopo
from .flow import SachtFlow

__all__ = [
    "ElTopo",  # as published: impulses one after the other, then inelastic impact zones
    "SachtFlow",  # down the signed distance
]
