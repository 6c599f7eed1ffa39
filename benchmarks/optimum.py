"""How far cages of small shapes are from the best there are, found by trying all lines.

    python benchmarks/optimum.py
    python benchmarks/optimum.py --shapes 100 --seed 500 --write best.json

Random shapes of 6 to 14 vertices get cages of 4 to 6. Each edge of a tightest cage touches the shape: so all lines at
its convex vertices, a degree apart, and along its edges are tried in all cycles of so many, by dynamic programming
through each of them. That shares no code with the search it judges. The best simple ones are tightened, since the best
lines lie between those that are tried. The optimum is the least of all, ours included. With `--write`, shapes and best
known cages go into a file for others. Exit status 1 if half of the cages are looser than the optimum by more than 1 %.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from shapely.geometry import LinearRing

import clone  # noqa: F401
from nestedcages_core import Mesh, NestedCagesError, Settings, nested_cages

STEP = np.radians(1.0)
"""Angle between lines about a vertex."""

TOUCHING = 1e-9
"""Height over a line, in a shape of size 1, up to which it is touched."""

FINALISTS, ALIKE = 8, 0.02
"""Cycles that are tightened, and the distance of their vertices below which two are one, in sizes of the shape."""

ALLOWED = 1.01
"""Multiple of the optimum's excess that counts as reaching it."""

FEWEST, MOST, COUNTS = 6, 14, (4, 5, 6)
"""Vertices of shapes, and of cages."""


def shape(seed: int) -> np.ndarray:
    """A random polygon (n, 2): smooth, spiky or convex, seen from its centre."""
    random = np.random.default_rng(seed)
    count = int(random.integers(FEWEST, MOST + 1))
    angle = np.sort(random.uniform(0.0, 2.0 * np.pi, count)) if seed % 2 else 2.0 * np.pi * np.arange(count) / count
    radius = random.uniform((0.2, 0.5, 0.9)[seed % 3], 1.0, count)
    return radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])


def lines(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The vertex (K,) and the direction (K, 2) of all lines that touch a polygon (n, 2), in its order."""
    vertices, directions = [], []
    for k, here in enumerate(points):
        before, after = here - points[k - 1], points[(k + 1) % len(points)] - here
        first = np.arctan2(before[1], before[0])
        turn = np.mod(np.arctan2(after[1], after[0]) - first + np.pi, 2.0 * np.pi) - np.pi
        if turn > 0.0:
            angle = first + np.linspace(0.0, turn, max(2, int(turn / STEP) + 1))
            vertices.append(np.full(len(angle), k))
            directions.append(np.column_stack([np.cos(angle), np.sin(angle)]))
    return np.concatenate(vertices), np.concatenate(directions)


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def free(points: np.ndarray, contacts: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """(2, K) how far each line runs before it enters the polygon, forwards and backwards."""
    away = points[None] - contacts[:, None]
    height, along = cross(directions[:, None], away), (directions[:, None] * away).sum(axis=2)
    other, along_other = np.roll(height, -1, axis=1), np.roll(along, -1, axis=1)
    enters = (np.minimum(height, other) < -TOUCHING) & (np.maximum(height, other) > TOUCHING)
    with np.errstate(divide="ignore", invalid="ignore"):
        place = np.where(enters, along + height / (height - other) * (along_other - along), np.nan)
    # through a vertex: where the outline goes on to the other side, or comes from a side and runs along the line
    on = np.abs(height) <= TOUCHING
    sides = np.sign(np.where(on, 0.0, height))
    before, after = np.roll(sides, 1, axis=1), np.roll(sides, -1, axis=1)
    inside = on & ((before < 0.0) | (after < 0.0)) & ((before > 0.0) | (after > 0.0)) & (np.abs(along) > TOUCHING)
    place = np.concatenate((place, np.where(inside, along, np.nan)), axis=1)
    ahead, behind = np.where(place > 0.0, place, np.inf), np.where(place < 0.0, -place, np.inf)
    return np.stack((ahead.min(axis=1), behind.min(axis=1)))


def cycles(points: np.ndarray, count: int) -> Iterator[np.ndarray]:
    """Cages (count, 2) of least area through each line, by area."""
    touched, directions = lines(points)
    contacts = points[touched]
    ahead, behind = free(points, contacts, directions)
    apart = contacts[None] - contacts[:, None]
    sine = cross(directions[:, None], directions[None])
    with np.errstate(divide="ignore", invalid="ignore"):
        forth = cross(apart, directions[None]) / sine
        back = cross(directions[:, None], apart) / sine
    meet = (np.abs(sine) > TOUCHING) & (forth >= -TOUCHING) & (back >= -TOUCHING)
    meet &= (forth <= ahead[:, None] + TOUCHING) & (back <= behind[None] + TOUCHING)
    vertex = contacts[:, None] + np.where(meet, forth, 0.0)[..., None] * directions[:, None]
    area = np.where(meet, 0.5 * (cross(contacts[:, None], vertex) + cross(vertex, contacts[None])), np.inf)
    # what lies between two contacts and the outline is not negative: the path runs around it
    swept = np.concatenate(([0.0], 0.5 * np.cumsum(cross(points, np.roll(points, -1, axis=0)))))
    wraps = np.tril(np.full(area.shape, swept[-1]))
    area[area < swept[touched][None] - swept[touched][:, None] + wraps - TOUCHING] = np.inf
    onward = np.where(np.triu(np.ones(area.shape, bool), 1), area, np.inf)
    found: list[tuple[float, list[int]]] = []
    for start in range(len(contacts) - count + 1):
        least, paths = onward[start], []
        for _ in range(count - 2):
            sums = least[start:, None] + onward[start:]
            paths.append(start + sums.argmin(axis=0))
            least = sums.min(axis=0)
        total = least + area[:, start]
        end = int(total.argmin())
        if np.isfinite(total[end]):
            cycle = [end]
            for path in reversed(paths):
                cycle.append(int(path[cycle[-1]]))
            found.append((float(total[end]), [start, *cycle[::-1]]))
    yielded: list[np.ndarray] = []
    for _, cycle in sorted(found):
        ring = vertex[cycle, np.roll(cycle, -1)]
        edges = np.hypot(*(np.roll(ring, -1, axis=0) - ring).T)
        new = all(np.abs(np.roll(ring, k, axis=0) - other).max() > ALIKE for other in yielded for k in range(count))
        if new and edges.min() > ALIKE and LinearRing(ring).is_simple:
            yielded.append(ring)
            yield ring


def optimum(fine: Mesh, count: int) -> Mesh | None:
    """The cage of least area of all that were found."""
    best: Mesh | None = None
    for number, ring in enumerate(cycles(fine.vertices[fine.loops[0]], count)):
        try:
            cage = nested_cages(fine, [Mesh.from_loops([ring])], Settings(fallback=None)).levels[0].cage
        except NestedCagesError:
            continue
        best = cage if best is None or cage.area < best.area else best
        if number + 1 >= FINALISTS:
            break
    return best


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shapes", type=int, default=20, help="random shapes (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (%(default)s)")
    parser.add_argument("--write", type=Path, help="a JSON file for the shapes and their best known cages")
    options = parser.parse_args()
    records, ratios = [], []
    print(f"{'seed':>6}{'n':>4}{'m':>4}{'ours %':>10}{'best %':>10}{'ratio':>8}")
    for seed in range(options.seed, options.seed + options.shapes):
        fine = Mesh.from_loops([shape(seed)])
        for count in (count for count in COUNTS if count < len(fine.vertices)):
            ours = nested_cages(fine, [count]).levels[0].cage
            best = optimum(fine, count)
            best = ours if best is None or ours.area < best.area else best
            excess = [cage.area / fine.area - 1.0 for cage in (ours, best)]
            ratios.append(excess[0] / excess[1])
            outline, cage = (mesh.vertices[mesh.loops[0]].tolist() for mesh in (fine, best))
            records.append({"seed": seed, "shape": outline, "cage": cage, "excess": excess[1]})
            print(f"{seed:6d}{len(fine.vertices):4d}{count:4d}{100 * excess[0]:10.3f}{100 * excess[1]:10.3f}"
                  f"{ratios[-1]:8.4f}", flush=True)  # fmt: skip
    reached = np.mean(np.array(ratios) <= ALLOWED)
    print(
        f"\n{len(ratios)} cages: excess to the optimum, median {np.median(ratios):.4f}, upper quartile "
        f"{np.quantile(ratios, 0.75):.4f}, largest {max(ratios):.3f}; within 1 %: {reached:.0%}"
    )
    if options.write is not None:
        options.write.write_text(json.dumps(records), encoding="utf-8")
    return 0 if np.median(ratios) <= ALLOWED else 1


if __name__ == "__main__":
    sys.exit(main())
