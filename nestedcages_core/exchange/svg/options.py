"""What of a drawing is read, how finely, and how much of it at most."""

from __future__ import annotations

from dataclasses import dataclass, field

from ...errors import NestedCagesError
from ...parameters import check_positive
from ..limits import Limits

FAINTEST = 0.5 / 255.0
"""Opacity that pictures of 8 bits per channel round to nothing."""

MAX_ELEMENTS = 100_000
"""Elements that are drawn unless `limits` says otherwise, each copy by `use` counted."""


@dataclass(frozen=True)
class SvgOptions:
    """What of a drawing is read."""

    tolerance: float | None = None
    """Greatest distance between a curve and its chords; 1/2000 of the drawing's diagonal if None."""
    element: str | None = None
    """The id of one element to read alone."""
    layers: tuple[str, ...] = ()
    """Layers to read, by label or id; all if empty. Groups directly below the root count as layers."""
    strokes: bool = True
    """Whether strokes count as painted. Without them closed outlines count as filled where nothing is."""
    background: bool = True
    """Whether a shape that covers the whole page below all others counts."""
    crop: bool = True
    """Whether what lies outside the page, which no viewer shows, is cut off."""
    opacity: float = 0.0
    """Opacity from 0 to 1 above which paint counts."""
    limits: Limits = field(default_factory=lambda: Limits(elements=MAX_ELEMENTS))

    def __post_init__(self) -> None:
        if self.tolerance is not None:
            check_positive(self, "tolerance")
        if not 0.0 <= self.opacity <= 1.0:
            raise NestedCagesError(f"The opacity must be from 0 to 1, not {self.opacity!r}.")

    @property
    def faintest(self) -> float:
        """The opacity above which paint counts."""
        return max(self.opacity, FAINTEST)
