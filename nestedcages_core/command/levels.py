"""Vertex counts as people ask for them: numbers, or parts of a shape's own."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass

from ..decimation.base import LEAST_PER_LOOP
from ..geometry.mesh import Mesh


@dataclass(frozen=True)
class Wanted:
    """The vertices of one level."""

    number: float
    is_share: bool = False
    """Whether `number` is a share of the shape's own vertices instead."""

    @classmethod
    def parsed(cls, text: str) -> Wanted:
        """Of `64` or `20%`. Raises ArgumentTypeError."""
        is_share = text.strip().endswith("%")
        try:
            value = float(text.strip().rstrip("%"))
        except ValueError:
            value = float("nan")
        if is_share and 0.0 < value <= 100.0:
            return cls(value / 100.0, True)
        if not is_share and value >= 1 and value % 1 == 0:
            return cls(value)
        raise argparse.ArgumentTypeError(
            f"a whole number of at least 1, or a percentage above 0 and up to 100 is needed, not {text!r}"
        )


def counts(wanted: Sequence[Wanted], mesh: Mesh) -> list[int]:
    """Vertices of each level around a mesh; a share leaves every loop its least. What is too many is clamped later."""
    least = LEAST_PER_LOOP * len(mesh.loops)
    return [
        max(round(each.number * len(mesh.vertices)), least) if each.is_share else int(each.number) for each in wanted
    ]
