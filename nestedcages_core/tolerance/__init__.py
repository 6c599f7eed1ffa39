"""Levels by a distance or an excess instead of a vertex count: a search above the builder."""

from __future__ import annotations

from .minimal_nested import fewest_links
from .within import Within, fewest

__all__ = ["Within", "fewest", "fewest_links"]
