"""The mesh M = (V, E) of the paper, validated once, at the door."""

from __future__ import annotations

from .mesh import Mesh

__all__ = ["Mesh"]
