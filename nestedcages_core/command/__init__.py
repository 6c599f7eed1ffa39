"""The command for shells: a drawing, a map or a picture goes in, certified cages come out."""

from __future__ import annotations

from .run import main

__all__ = ["main"]
