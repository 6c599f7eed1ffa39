"""Levels as people ask for them: numbers of vertices, parts of a shape's own, distances and excesses."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass

from ..decimation.base import LEAST_PER_LOOP
from ..geometry.mesh import Mesh
from ..hierarchy import Within

UNITS = ("px", "u")
"""What marks a distance: pixels or units of the input, which mean the same."""

RULE = (
    "a whole number of at least 1, a percentage such as 8%, a distance such as 2px, or an excess such as +25% is needed"
)


@dataclass(frozen=True)
class Wanted:
    """The vertices of one level."""

    number: float = 0.0
    is_share: bool = False
    """Whether `number` is a share of the shape's own vertices instead."""
    within: Within | None = None
    """What the cage may take, instead of a number."""

    @classmethod
    def parsed(cls, text: str) -> Wanted:
        """Of `64`, `20%`, `2px` or `+25%`. Raises ArgumentTypeError."""
        written = text.strip().lower().replace(" ", "")
        unit = next((unit for unit in UNITS if written.endswith(unit)), None)
        is_excess, is_share = written.startswith("+"), written.endswith("%")
        try:
            value = float(written.removesuffix(unit or "").rstrip("%"))
        except ValueError:
            value = float("nan")
        if unit is not None and not is_excess and 0.0 < value < float("inf"):
            return cls(within=Within(distance=value))
        if unit is None and is_excess and is_share and 0.0 < value < float("inf"):
            return cls(within=Within(excess=value / 100.0))
        if unit is None and not is_excess and is_share and 0.0 < value <= 100.0:
            return cls(value / 100.0, True)
        if unit is None and not is_excess and not is_share and value >= 1 and value % 1 == 0:
            return cls(value)
        raise argparse.ArgumentTypeError(f"{RULE}, not {text!r}")


def wanted_levels(wanted: Sequence[Wanted], mesh: Mesh) -> list[int | Mesh | Within]:
    """Each level around a mesh; a share leaves every loop its least. What is too many is clamped later."""
    least = LEAST_PER_LOOP * len(mesh.loops)
    return [
        each.within or (max(round(each.number * len(mesh.vertices)), least) if each.is_share else int(each.number))
        for each in wanted
    ]
