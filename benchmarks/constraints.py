"""Constraints alone and in pairs on random shapes, around them and inside: how many are kept, and which errors say no.

    python benchmarks/constraints.py --cases 30
    python benchmarks/constraints.py --cases 30 --inside --only axes

A cage that is returned but misses a constraint, or is not nested, counts as WRONG; so does an error without a code of
its own. Needs shapely.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import combinations

import numpy as np

import clone  # noqa: F401
from nestedcages_core import (
    AxisAligned,
    Box,
    LeastAngle,
    LeastEdge,
    LoopClearance,
    Mesh,
    NestedCagesError,
    Outside,
    inner_cages,
    nested_cages,
    verify,
)
from nestedcages_core.constraints import Constraint
from random_shapes import random_shape

FEWEST, MOST, MOST_LOOPS = 30, 300, 3
"""Vertices and loops of the shapes."""

LEAST_COUNT, PER_LOOP, LARGEST_PART = 16, 6, 0.6
"""Vertices of the cages: at least so many, and so many per loop, if that is at most this part of the shape's own."""


def obstacle(fine: Mesh) -> Outside:
    """An octagon right of the rightmost vertex."""
    angle = 2.0 * np.pi * np.arange(8) / 8
    at = fine.vertices[int(np.argmax(fine.vertices[:, 0]))] + [0.028 * fine.diagonal, 0.0]
    ring = at + 0.02 * fine.diagonal * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    return Outside(Mesh.from_loops([ring]), 0.002 * fine.diagonal)


def box(fine: Mesh) -> Box:
    """0.6 % of the diagonal around the shape."""
    low, high = (bound(fine.vertices, axis=0) for bound in (np.min, np.max))
    return Box(tuple(low - 0.006 * fine.diagonal), tuple(high + 0.006 * fine.diagonal))


MAKERS: dict[str, Callable[[Mesh, int], Constraint]] = {
    "box": lambda fine, _: box(fine),
    "loops": lambda fine, _: LoopClearance(outer=0.001 * fine.diagonal, holes=0.003 * fine.diagonal),
    "axes": lambda *_: AxisAligned(),
    "transit": lambda *_: AxisAligned((0.0, 45.0, 90.0, 135.0)),
    "edge": lambda fine, count: LeastEdge(0.25 * float(fine.edge_lengths.sum()) / count),
    "angle": lambda *_: LeastAngle(30.0),
    "obstacle": lambda fine, _: obstacle(fine),
}
APART = {"axes", "transit"}
"""Constraints that no cage keeps both."""


def shapes(number: int, seed: int) -> Iterator[tuple[Mesh, int]]:
    """Shapes and the numbers of vertices of their cages."""
    done = 0
    while done < number:
        seed += 1
        drawn = random_shape(seed)
        if drawn is None or not FEWEST <= len(drawn[1].vertices) <= MOST or len(drawn[1].loops) > MOST_LOOPS:
            continue
        count = max(LEAST_COUNT, PER_LOOP * len(drawn[1].loops))
        if count <= LARGEST_PART * len(drawn[1].vertices):
            done += 1
            yield drawn[1], count


def outcome(fine: Mesh, count: int, constraints: list[Constraint], inside: bool) -> str:
    """Whether a cage keeps constraints, or the code of the error."""
    try:
        cage = (inner_cages if inside else nested_cages)(fine, count, constraints=constraints)[0].cage
    except NestedCagesError as error:
        return error.code or "WRONG"
    outer, inner = (fine, cage) if inside else (cage, fine)
    nested = verify(outer, inner, same_loops=False)  # few vertices: parts may share loops
    return "kept" if nested and all(each.fault(cage, fine) is None for each in constraints) else "WRONG"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=10, help="random shapes (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the seed before the first (%(default)s)")
    parser.add_argument("--inside", action="store_true", help="cages inside the shapes")
    parser.add_argument("--only", choices=MAKERS, help="only this one, alone and in pairs")
    options = parser.parse_args()
    several = [*((name,) for name in MAKERS), *(pair for pair in combinations(MAKERS, 2) if set(pair) != APART)]
    wrong = 0
    for names in several:
        if options.only and options.only not in names:
            continue
        found = Counter(
            outcome(fine, count, [MAKERS[name](fine, count) for name in names], options.inside)
            for fine, count in shapes(options.cases, options.seed)
        )
        wrong += found["WRONG"]
        others = ", ".join(f"{code} {number}" for code, number in found.most_common() if code != "kept")
        print(f"{' + '.join(names):20} kept {found['kept']:3d} of {options.cases}  {others}", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
