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


def counts(wanted: Sequence[Wanted], mesh: Mesh) -> tuple[list[int], list[str]]:
    """Vertices of each level around a mesh, and a note for each that was clamped to what the mesh has."""
    most, least = len(mesh.vertices), LEAST_PER_LOOP * len(mesh.loops)
    levels, notes = [], []
    for k, level in enumerate(wanted, start=1):
        count = max(round(level.number * most), least) if level.is_share else int(level.number)
        if count > most:
            notes.append(f"Level {k}: {count} vertices were asked for; the shape has {most}.")
        levels.append(min(count, most))
    return levels, notes
