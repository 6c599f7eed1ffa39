"""The shell command: certified cages around drawings, maps and pictures."""

from __future__ import annotations

from .run import main

__all__ = ["main"]
