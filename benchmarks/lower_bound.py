"""How far cages are at most above the optimum, by a lower bound on all polygons of as many vertices (docs/method.md).

    python benchmarks/lower_bound.py                    # 60 outlines of 60 to 1,000 vertices; about ten minutes
    python benchmarks/lower_bound.py --random 0 --page  # only held-out ones, for docs/method.md
    python benchmarks/lower_bound.py --attack 60        # small shapes, where the bound must not exceed the best known

Outer loops of held-out and random shapes get cages of 8 to 32 vertices; x is the area of the cage over the bound. The
attack asks for a bound above the best cage that trying all lines finds (optimum.py): exit status 1 if it gets one.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from itertools import count as numbers
from itertools import islice, pairwise, takewhile

import numpy as np

import clone
from bound import Bound, lower_bound
from comparison.held_out import held_out
from nestedcages_core import Mesh, nested_cages
from optimum import COUNTS, optimum, shape
from page import measured
from random_shapes import random_shape

FEWEST, MOST = 60, 1000
"""Vertices of outlines."""
COUNTS_OF_CAGES = (8, 16, 24, 32)
"""Vertices of cages, by turns."""
GROUPS = (60, 150, 300, 1000)
"""Bounds of the vertices of groups in the table."""
REACH = -0.02
"""Target of the attack: a bound this much above the cage would be accepted."""
ROUNDING = 1e-9
"""Relative excess of a bound over a cage that is no fault."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--held-out", type=int, default=30, help="held-out outlines (%(default)s)")
    parser.add_argument("--random", type=int, default=30, help="random outlines (%(default)s)")
    parser.add_argument("--seconds", type=float, default=30.0, help="CPU time of a bound (%(default)s)")
    parser.add_argument("--target", type=float, default=0.01, help="x at which the search ends (%(default)s)")
    parser.add_argument("--attack", type=int, metavar="N", help="only so many small shapes, from seed")
    parser.add_argument("--seed", type=int, default=0, help="the first seed of random shapes (%(default)s)")
    parser.add_argument("--page", action="store_true", help="put the table into docs/method.md")
    options = parser.parse_args()
    if options.attack:
        return attack(options.attack, options.seed)
    lines, rows = [], []
    for place, (name, fine) in enumerate(outlines(options.held_out, options.random, options.seed)):
        most = COUNTS_OF_CAGES[place % len(COUNTS_OF_CAGES)]
        cage = nested_cages(fine, [most]).levels[0].cage.area
        found = lower_bound(fine, most, cage, target=options.target, seconds=options.seconds)
        rows.append((len(fine.vertices), cage / fine.area - 1.0, cage / found.area - 1.0, found))
        lines.append(line(name, most, *rows[-1]))
        print(lines[-1], flush=True)
    table = summary(rows)
    print(table)
    if options.page:
        command = "python " + " ".join(["benchmarks/lower_bound.py", *sys.argv[1:]])
        measured(clone.ROOT / "docs" / "method.md", "bound", command, "\n".join(lines), table)
    return 0


def outlines(held_out_count: int, random_count: int, seed: int) -> Iterator[tuple[str, Mesh]]:
    """Outer loops of the right size of held-out and of random shapes."""
    held = takewhile(bool, map(held_out, numbers()))
    drawn = (found for number in numbers(seed) if (found := random_shape(number)))
    for source, share in ((held, held_out_count), (drawn, random_count)):
        yield from islice(filter(None, map(outer, source)), share)


def outer(drawn: tuple[str, Mesh]) -> tuple[str, Mesh] | None:
    """The largest loop of a shape, if it has the right number of vertices."""
    name, mesh = drawn
    loops = [mesh.vertices[loop] for loop in mesh.loops]
    largest = max(loops, key=lambda loop: abs(area(loop)))
    return (name, Mesh.from_loops([largest])) if FEWEST <= len(largest) <= MOST else None


def area(points: np.ndarray) -> float:
    """Signed area of a loop (k, 2)."""
    after = np.roll(points, -1, axis=0)
    return 0.5 * float((points[:, 0] * after[:, 1] - points[:, 1] * after[:, 0]).sum())


def line(name: str, most: int, vertices: int, excess: float, above: float, found: Bound) -> str:
    """What was found of one cage."""
    return (
        f"{name[:24]:24}{vertices:6d}{most:4d}  excess {100 * excess:9.3f} %  x {100 * above:7.3f} %"
        f"{found.rounds:4d} rounds{found.seconds:7.2f} s"
    )


def summary(rows: list[tuple[int, float, float, Bound]]) -> str:
    """A table by the number of vertices, in Markdown."""
    lines = ["| vertices | cages | x, median | at most 1 % | at most 2 % | largest | s, median |", "| --- " * 7 + "|"]
    for low, high in (*pairwise(GROUPS), (FEWEST, MOST)):
        mine = [row for row in rows if low <= row[0] < high or (high == MOST and row[0] == MOST)]
        if not mine:
            continue
        name = "all" if (low, high) == (FEWEST, MOST) else f"{low} to {high}"
        above, seconds = np.array([100.0 * row[2] for row in mine]), [row[3].seconds for row in mine]
        lines.append(
            f"| {name} | {len(mine)} | {np.median(above):.2f} % | {(above <= 1.0001).sum()} | "
            f"{(above <= 2.0).sum()} | {above.max():.1f} % | {np.median(seconds):.1f} |"
        )
    return "\n".join(lines)


def attack(shapes: int, seed: int) -> int:
    """Small shapes: the bound against the best cage of all."""
    faults, cages, apart = 0, 0, []
    for number in range(seed, seed + shapes):
        fine = Mesh.from_loops([shape(number)])
        for most in (count for count in COUNTS if count < len(fine.vertices)):
            ours = nested_cages(fine, [most]).levels[0].cage
            best = optimum(fine, most)
            area = min(ours.area, best.area if best is not None else np.inf)
            found = lower_bound(fine, most, area, target=REACH, seconds=2.0)
            cages, faults = cages + 1, faults + (found.area > area * (1.0 + ROUNDING))
            apart.append(area / found.area - 1.0)
            if found.area > area * (1.0 + ROUNDING):
                print(f"seed {number}, {most} vertices: bound {found.area:.9g} above a cage of {area:.9g}", flush=True)
    print(f"{faults} of {cages} bounds above the best known cage; best known / bound - 1: median "
          f"{100 * np.median(apart):.3f} %, largest {100 * max(apart):.2f} %")  # fmt: skip
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main())
