"""The same starts for every contact: coarse meshes with the fine mesh inside, on random shapes and on glyphs."""

from __future__ import annotations

import itertools
from collections.abc import Callable

from comparison.bench import Bench
from comparison.cases import CHARACTERS, FONTS, Pair, glyph_pair, random_pair
from comparison.measure import Started
from nestedcages_core import Mesh, NestedCagesError, TwoSidedFlow
from nestedcages_core.level.units import SolverUnits
from nestedcages_core.tasks import drain

BLOCK = 40
"""Numbers that are tried at once."""

Start = tuple[Mesh, Started]
"""A fine mesh, and its coarse mesh with the steps of the flow into it."""


def start_in(fine: Mesh, coarse: Mesh) -> Start | None:
    """The flow into a coarse mesh; None where it fails, or where the fine mesh is inside already."""
    units = SolverUnits.of(fine)
    try:
        steps = drain(TwoSidedFlow().run(units.from_input(fine), units.from_input(coarse))).steps
    except NestedCagesError:
        return None
    return (fine, Started(coarse, steps)) if len(steps) > 1 else None


def random_start(seed: int) -> tuple[str, Start] | None:
    """For a seed of a random shape; None if it gives none."""
    return _started(random_pair(seed))


def glyph_start(place: int) -> tuple[str, Start] | None:
    """For the number of a glyph."""
    return _started(glyph_pair(place))


def _started(made: tuple[str, Pair] | None) -> tuple[str, Start] | None:
    start = start_in(*made[1]) if made else None
    return (made[0], start) if made and start else None


def starts(bench: Bench, random: int, glyphs: int, first: int = 0) -> dict[str, Start]:
    """So many starts of either kind; random ones from the seed ``first`` on."""
    return _first(bench, random_start, random, itertools.count(first)) | _first(
        bench, glyph_start, glyphs, iter(range(len(CHARACTERS) * len(FONTS)))
    )


def is_real(shape: str) -> bool:
    """Whether a start is a glyph."""
    return shape.startswith(FONTS)


def _first(
    bench: Bench, make: Callable[[int], tuple[str, Start] | None], count: int, numbers: itertools.count[int]
) -> dict[str, Start]:
    found: dict[str, Start] = {}
    while len(found) < count:
        block = list(itertools.islice(numbers, BLOCK))
        if not block:
            break
        tasks = {(make.__name__, number): (number,) for number in block}
        for made in bench.each("starts", make, tasks, lambda made: made[0] if made else "none").values():
            if made is not None and len(found) < count:
                found[made[0]] = made[1]
    return found
