"""How a part hangs on another one, and what a user has chosen about it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from ...errors import invalid_setting

DOUBTFUL_MARGIN, DOUBTFUL_SCORE = 0.85, 0.3
"""A link is marked as doubtful if another parent is less than this part less likely, or if its own probability is below
that. On the characters that weights are fitted to, 10 % of links then are marked, and 69 of the 114 wrong ones
(`benchmarks/cast`)."""


class Hold(Enum):
    """What holds a part."""

    ROOT = "root"
    """Nothing: the others hang on it."""
    JOINT = "joint"
    """It turns around a joint on its parent."""
    RIDES = "rides"
    """It moves with what it lies on."""


@dataclass(frozen=True)
class Link:
    """How a part hangs on its parent."""

    hold: Hold
    parent: int | None
    """Number of the part that carries this one; None for the root."""
    joint: tuple[float, float]
    """Where it turns; for a rider, the middle of what it shares with its parent."""
    radius: float = 0.0
    """Of the largest disc in both parts around the joint; 0 where they do not overlap."""
    gap: float = 0.0
    """Distance to the parent in the drawing; infinite where the part touches nothing near and was hung on the nearest
    one."""
    score: float = 1.0
    """Probability of the parent among all parts, by the weights of `scores`."""
    margin: float = 1.0
    """How much less likely the next parent is, as a fraction of this one's probability."""
    is_chosen: bool = False
    """Whether a user chose the parent."""

    @property
    def is_doubtful(self) -> bool:
        """Whether a user should look at it."""
        if self.is_chosen or self.parent is None:
            return False
        return self.gap == float("inf") or self.margin < DOUBTFUL_MARGIN or self.score < DOUBTFUL_SCORE


@dataclass(frozen=True)
class PartChoice:
    """What a user decides about a part; None leaves it to the draft."""

    parent: str | None = None
    """Name of the part to hang on; an empty text makes it the root."""
    joint: tuple[float, float] | None = None
    """Where it turns."""
    hold: Hold | None = None
    """Whether it turns or rides."""
    bones: int | None = None
    """Number of bones along the part: it bends if there are two or more."""
    chain: tuple[tuple[float, float], ...] | None = None
    """Where these are: their heads, and the tail of the last."""

    def __post_init__(self) -> None:
        if self.bones is not None and self.bones < 1:
            raise invalid_setting(f"A part has at least one bone, not {self.bones}.")
        if self.chain is not None and len(self.chain) != (self.bones or 1) + 1:
            raise invalid_setting(f"{self.bones or 1} bones have one place more, not {len(self.chain)}.")
        if self.parent == "" and self.hold not in (None, Hold.ROOT):
            raise invalid_setting("A root hangs on nothing; leave its hold to the draft.")


def hangs_on(found: Mapping[int, Link], part: int | None, other: int) -> bool:
    """Whether a part hangs on another one, however indirectly."""
    while part is not None:
        if part == other:
            return True
        part = found[part].parent
    return False


def depth_of(found: Mapping[int, Link], part: int) -> int:
    """How many parts a part hangs on, one on the other."""
    parent = found[part].parent
    return 0 if parent is None else 1 + depth_of(found, parent)
