"""Fewer loops: parts that lie close together share a loop of the cage."""

from __future__ import annotations

from .merging import Merging, advice, merged

__all__ = ["Merging", "advice", "merged"]
