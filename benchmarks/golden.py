"""Results of several hundred requests as hashes, for moves of code that should change no bit.

    python benchmarks/golden.py > before.txt
    python benchmarks/golden.py --against before.txt

One line a request: shape, request, a digest of all numbers of cage and steps, and the excess of the outermost level or
the code of the error. With `--against`, what differs from a file written before on the same machine, and the ratio of
areas of the cages; exit status 1 if anything does.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

import clone  # noqa: F401
from nestedcages_core import (
    IPC,
    ArcLength,
    Found,
    InitialDisplacement,
    Mesh,
    NestedCagesError,
    OuterHull,
    Settings,
    Within,
    animated_cages,
    inner_cages,
    nested_cages,
)
from nestedcages_core.cache import forget
from random_shapes import random_shape

FIRST_SEED = 870_000
SHAPES = 46
VERTICES = (12, 400)
"""Least and most vertices of a shape."""


def own_mesh(fine: Mesh, count: int) -> Mesh:
    """A coarse mesh as a user would hand it in: looser than a cage, and not around all of the shape."""
    coarse = OuterHull().decimate(fine, count)
    centre = coarse.vertices.mean(axis=0)
    return Mesh(centre + (coarse.vertices - centre) * 0.97, coarse.edges)


def swayed(fine: Mesh) -> np.ndarray:
    """(4, n, 2): the shape sheared to one side."""
    middle = fine.vertices.mean(axis=0)
    offset = (fine.vertices - middle)[:, 1:] * [1.0, 0.0]
    return np.stack([fine.vertices + 0.1 * step * offset for step in range(4)])


def plain(**options: object) -> Callable[[Mesh, int], object]:
    return lambda fine, count: nested_cages(fine, count, Settings.of(None, **options)).levels


def sized(name: str, fraction: float) -> Callable[[Mesh, int], object]:
    """A setting that is this fraction of the diagonal."""
    return lambda fine, count: nested_cages(fine, count, Settings.of(None, **{name: fraction * fine.diagonal})).levels


REQUESTS: dict[str, Callable[[Mesh, int], object]] = {
    "plain": plain(),
    "twice as many": lambda fine, count: nested_cages(fine, 2 * count).levels,
    "two levels": lambda fine, count: nested_cages(fine, [3 * count, count]).levels,
    "clearance": sized("clearance", 0.004),
    "inside": lambda fine, count: inner_cages(fine, count).levels,
    "least edge": sized("min_edge", 0.02),
    "grid": sized("grid", 0.01),
    "stored": plain(stored=np.float32),
    "convex": plain(convex=True),
    "symmetry": plain(symmetry=Found()),
    "merge": sized("merge", 0.05),
    "within": lambda fine, _: nested_cages(fine, Within(distance=0.02 * fine.diagonal)).levels,
    "excess": lambda fine, _: nested_cages(fine, Within(excess=0.3)).levels,
    "own mesh": lambda fine, count: nested_cages(fine, own_mesh(fine, count)).levels,
    "arc length": plain(decimation=ArcLength()),
    "hull": plain(decimation=OuterHull()),
    "IPC": plain(contact=IPC()),
    "displacement": plain(energy=InitialDisplacement()),
    "pins": lambda fine, count: nested_cages(fine, count, pins=[0, len(fine.vertices) // 2]).levels,
    "weights": lambda fine, count: nested_cages(fine, count, weights=np.linspace(0.5, 2.0, len(fine.vertices))).levels,
    "moving": lambda fine, count: animated_cages(fine, swayed(fine), count).levels,
}
ON_ALL = {"plain", "clearance", "twice as many"}
"""Requests that every shape gets; of the others each gets some in turn."""

EACH = 7


def requests() -> Iterator[tuple[str, str, Mesh, int]]:
    """(shape, request, mesh, count)."""
    others, turn, seed, shapes = [name for name in REQUESTS if name not in ON_ALL], 0, FIRST_SEED, 0
    while shapes < SHAPES:
        seed += 1
        drawn = random_shape(seed)
        if drawn is None or not VERTICES[0] <= len(drawn[1].vertices) <= VERTICES[1]:
            continue
        shapes += 1
        kind, fine = drawn
        count = min(max(12, 4 * len(fine.loops)), len(fine.vertices))
        for name in (*sorted(ON_ALL), *(others[(turn + place) % len(others)] for place in range(EACH))):
            yield f"{kind}-{seed}", name.replace(" ", "-"), fine, count
        turn += EACH


def outcome(request: Callable[[Mesh, int], object], fine: Mesh, count: int) -> tuple[str, str]:
    """(digest, excess), or (code, "-") of an error."""
    forget()
    try:
        levels = request(fine, count)
    except NestedCagesError as error:
        return error.code, "-"
    digest = hashlib.sha256()
    for level in levels:  # type: ignore[attr-defined]
        steps = level.reinflation if hasattr(level, "reinflation") else level
        cage = level.cage.vertices if isinstance(level.cage, Mesh) else level.cage_steps[-1]
        for array in (cage, steps.cage_steps, steps.fine_steps):
            digest.update(np.ascontiguousarray(array).tobytes())
    area = Mesh(cage, levels[-1].cage.edges).area  # type: ignore[index]
    return digest.hexdigest()[:12], f"{area / fine.area:.9f}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--against", type=Path, help="what this printed before")
    parser.add_argument("--only", nargs="*", help="only these requests, such as plain or least-edge")
    options = parser.parse_args()
    before = {}
    if options.against:
        rows = (line.split() for line in options.against.read_text(encoding="utf-8").splitlines())
        before = {(shape, name): (digest, ratio) for shape, name, digest, ratio in rows}
    differing = total = 0
    for shape, name, fine, count in requests():
        if options.only and name not in options.only:
            continue
        digest, ratio = outcome(REQUESTS[name.replace("-", " ")], fine, count)
        total += 1
        if not options.against:
            print(shape, name, digest, ratio, flush=True)
        elif before.get((shape, name)) != (digest, ratio):
            differing += 1
            old_digest, old = before.get((shape, name), ("none", "-"))
            change = f"area {float(ratio) / float(old):.6f}" if "-" not in (ratio, old) else f"{old_digest} -> {digest}"
            print(f"{shape:20} {name:15} {change}", flush=True)
    if options.against:
        print(f"{differing} of {total} differ")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
