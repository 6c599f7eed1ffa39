"""Options for reading a drawing: what to read, how finely, and limits."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import invalid_file
from ...parameters import check_positive
from ..limits import Limits

FAINTEST = 0.5 / 255.0
"""Opacity that rounds to 0 with 8 bits per channel."""

DRAWING_LIMITS = Limits(elements=100_000, points=1_000_000)
"""What is read of a drawing at most by default: elements that are drawn, each copy by `use` counted, and points of
their outlines, before and after curves become chords."""


@dataclass(frozen=True)
class SvgOptions:
    """Options for reading a drawing."""

    tolerance: float | None = None
    """Largest distance between a curve and the edges in its place; 1/2000 of the drawing's diagonal if None."""
    inside: bool = False
    """Whether these edges are inside of what is painted, for cages inside; by default they are outside."""
    element: str | None = None
    """The id of one element to read alone."""
    layers: tuple[str, ...] = ()
    """Layers to read, by label or id; all if empty. Groups directly below the root count as layers."""
    strokes: bool = True
    """Whether strokes count as painted. Without strokes, closed outlines count as filled if nothing is."""
    background: bool = True
    """Whether a shape that covers the whole page below all others counts."""
    crop: bool = True
    """Whether to cut off everything outside the page, which viewers do not show."""
    opacity: float = 0.0
    """Opacity from 0 to 1 above which paint counts."""
    specks: float = 0.0
    """Width in user units below which parts and spikes are left out, holes and gaps closed; by default none are."""
    limits: Limits = DRAWING_LIMITS

    def __post_init__(self) -> None:
        if self.tolerance is not None:
            check_positive(self, "tolerance")
        if not 0.0 <= self.opacity <= 1.0:
            raise invalid_file(f"The opacity must be from 0 to 1, not {self.opacity!r}.")

    @property
    def faintest(self) -> float:
        """The opacity above which paint counts."""
        return max(self.opacity, FAINTEST)
