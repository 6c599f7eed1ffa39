"""Incremental Potential Contact (Li et al. 2020) in the plane as published.

One range for all pairs, adaptive stiffness, full projected Newton.
"""

from __future__ import annotations

from .contact import OriginalIPC

__all__ = [
    "OriginalIPC",  # the contact, with the fine mesh as a moving boundary
]
