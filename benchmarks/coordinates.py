"""Cage coordinates on every shape: errors at rest and under affine motions, least weights, time; a bent glyph by each.

    python benchmarks/coordinates.py --picture build/coordinates.png

`--data FOLDER` takes your own shapes, pairs of files `name_V.csv` and `name_E.csv`. Needs matplotlib.
"""

from __future__ import annotations

import time

import numpy as np

from bent import BENT, arguments, bend, draw, left_outside
from data import shape
from nestedcages_core import (
    Harmonic,
    MeanValue,
    Mesh,
    PiecewiseLinear,
    cage_coordinates,
    deform,
    nested_cages,
)

KINDS = {"mean value": MeanValue(), "harmonic": Harmonic(), "piecewise linear": PiecewiseLinear()}
MOTIONS = 20  # affine motions tried on each shape


def affine_error(weights: object, fine: Mesh, cage: Mesh) -> float:
    """Largest distance between points moved with their cage and points moved themselves, by the moved size."""
    rng = np.random.default_rng(0)
    worst = 0.0
    for _ in range(MOTIONS):
        matrix, shift = rng.normal(size=(2, 2)), fine.diagonal * rng.normal(size=2)
        expected = fine.vertices @ matrix.T + shift
        moved = deform(weights, cage.vertices @ matrix.T + shift)
        worst = max(worst, np.abs(moved - expected).max() / np.abs(expected).max())
    return worst


def main() -> None:
    given, names = arguments(__doc__)
    print(f"{'shape':12s} {'coordinates':18s} {'at rest':>9s} {'affine':>9s} {'least':>8s} {'seconds':>8s}")
    bent: dict[str, tuple[Mesh, Mesh]] = {}
    at_rest: Mesh | None = None
    for name in names:
        fine = shape(name, given.data)
        cage = nested_cages(fine, [given.vertices]).cages[0]
        at_rest = cage if name == BENT else at_rest
        for kind, coordinates in KINDS.items():
            began = time.process_time()
            weights = cage_coordinates(fine, cage, coordinates)
            seconds = time.process_time() - began
            rest = np.abs(deform(weights, cage) - fine.vertices).max() / fine.diagonal
            least = weights.min()
            print(
                f"{name:12s} {kind:18s} {rest:9.1e} {affine_error(weights, fine, cage):9.1e} {least:8.4f} "
                f"{seconds:8.2f}",
                flush=True,
            )
            if name == BENT:
                posed = cage.moved(bend(cage, fine.vertices.min(axis=0)))
                moved = fine.moved(deform(weights, posed))
                bent[f"{kind}, outside: {left_outside(moved, posed)}"] = (moved, posed)
    if given.picture and bent:
        draw({"at rest": (shape(BENT, given.data), at_rest), **bent}, given.picture)


if __name__ == "__main__":
    main()
