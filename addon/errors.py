"""The error that users see."""

from __future__ import annotations


class UserError(Exception):
    """Invalid input, setting or state. The message names the object and the remedy; operators report it as it is."""


def counted(count: int, noun: str) -> str:
    """A number of things: "1 cage", "3 cages"."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
