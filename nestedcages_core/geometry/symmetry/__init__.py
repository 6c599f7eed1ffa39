"""Cages with an exact symmetry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .maps import Mirror, Rotation

if TYPE_CHECKING:
    from .detection import Found as Found

__all__ = ["Found", "Mirror", "Rotation"]


def __getattr__(name: str) -> Any:
    """What few runs need is imported when it is asked for."""
    if name != "Found":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from .detection import Found

    return Found
