"""Levels by a distance or an excess instead of a vertex count: a search above the builder."""

from __future__ import annotations

from ..geometry.mesh import Mesh
from .within import Within

__all__ = ["Within", "fewest_links"]


def fewest_links(fine: Mesh, loop: int, distance: float, strictly: float) -> int:
    """See `minimal_nested.fewest_links`, which is imported only when it is used."""
    from . import minimal_nested

    return minimal_nested.fewest_links(fine, loop, distance, strictly)
