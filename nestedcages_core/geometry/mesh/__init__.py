"""The mesh M = (V, E) of the paper, validated once, at the door."""

from __future__ import annotations

from .mesh import Mesh
from .nesting import Nesting

__all__ = ["Mesh", "Nesting"]
