"""Shapes of letters, icons and maps that no method was tuned on: conclusions are confirmed on them.

Made by `held_out_shapes.py`; the file names source and licence of each.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache

import numpy as np

from data import HELD_OUT_SHAPES
from nestedcages_core import Mesh


@cache
def shapes() -> Sequence[dict[str, object]]:
    """The lines of the file, sources in turns."""
    lines = json.loads(HELD_OUT_SHAPES.read_text(encoding="utf-8"))
    np.random.default_rng(0).shuffle(lines)
    return tuple(lines)


def held_out(number: int) -> tuple[str, Mesh] | None:
    """(name, mesh) of a number; None past the last."""
    if number >= len(shapes()):
        return None
    line = shapes()[number]
    return f"{line['family']}: {line['name']}", Mesh.from_loops([np.array(loop) for loop in line["loops"]])


def sources() -> list[tuple[str, str, str, str]]:
    """Package, family, number of shapes, licence."""
    lines = [tuple(str(line[name]) for name in ("source", "family", "licence")) for line in shapes()]
    return [(source, family, str(lines.count(one)), licence)
            for one in sorted(set(lines)) for source, family, licence in [one]]  # fmt: skip
