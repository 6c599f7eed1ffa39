"""A table in Markdown, with a sentence on what was run and one on what was found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field


@dataclass
class Table:
    """Rows of cells under a head; the first cell of a row names it."""

    head: Sequence[str]
    rows: list[Sequence[str]] = field(default_factory=list)
    before: str = ""
    """What was run."""
    after: str = ""
    """What was found."""
    good: bool = True
    """Whether every cage that was made is certified."""

    def __str__(self) -> str:
        rule = "|---|" + "---:|" * (len(self.head) - 1)
        lines = [f"| {' | '.join(cells)} |" for cells in (self.head, *self.rows)]
        return "\n\n".join(part for part in (self.before, "\n".join([lines[0], rule, *lines[1:]]), self.after) if part)


def per_cent(fraction: float, digits: int = 2) -> str:
    """A fraction as a percentage without its sign."""
    return f"{100.0 * fraction:.{digits}f}"
