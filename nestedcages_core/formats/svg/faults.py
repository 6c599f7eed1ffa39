"""What a drawing has wrong, as sentences that name it."""

from __future__ import annotations

from collections import Counter

MAX_NAMED = 6
"""Largest number of attributes that notes name."""

MAX_SHOWN = 30
"""Maximum length of a value in a message."""


class Faults:
    """Attributes that cannot be read, and what is done instead, as browsers do; each sentence once."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()

    def add(self, sentence: str) -> None:
        self.counts[sentence] += 1

    def notes(self) -> list[str]:
        """The first sentences, and how many others there are."""
        named = [f"{text} ({count} times)." if count > 1 else f"{text}." for text, count in self.counts.items()]
        more = len(named) - MAX_NAMED
        return [*named[:MAX_NAMED], *([f"{more} more attributes cannot be read."] if more > 0 else [])]


def quoted(text: str) -> str:
    """A value, shortened for messages."""
    return f"'{text}'" if len(text) <= MAX_SHOWN else f"'{text[:MAX_SHOWN]}…'"
