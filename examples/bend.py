"""A drawing that follows its cage: the same pose by three kinds of coordinates.

Run as ``python examples/bend.py``; reads examples/letter_a.svg.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from nestedcages_core import (
    Harmonic,
    MeanValue,
    Mesh,
    PiecewiseLinear,
    cage_coordinates,
    deform,
    nested_cages,
    read_svg,
)
from plot import BODY, INK, QUIET, RED, arguments, fill, line, panels, save

DRAWING = Path(__file__).resolve().parent / "letter_a.svg"
COUNT, LEAN = 18, 0.7  # vertices of the cage; radians at the top
KINDS = {"mean value": MeanValue(), "harmonic": Harmonic(), "linear on triangles": PiecewiseLinear()}


def leaning(cage: Mesh) -> np.ndarray:
    """A pose of the cage: the higher a vertex, the more it is turned about the feet."""
    low, high = cage.vertices.min(axis=0), cage.vertices.max(axis=0)
    foot = np.array([0.5 * (low[0] + high[0]), high[1]])  # drawings count y downwards
    turn = LEAN * (high[1] - cage.vertices[:, 1]) / (high[1] - low[1])
    x, y = (cage.vertices - foot).T
    return foot + np.stack((x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)), axis=1)


def main() -> None:
    given = arguments(__doc__)
    fine = read_svg(DRAWING)
    cage = nested_cages(fine, [COUNT]).cages[0]
    posed = leaning(cage)
    kinds = {"mean value": KINDS["mean value"]} if given.small else KINDS
    figure, axes = panels(1 + len(kinds), width=3.4, height=4.4)
    fill(axes[0], fine, BODY)
    line(axes[0], fine, INK, 0.8)
    line(axes[0], cage, RED, 1.5, 6.0)
    axes[0].set_title(f"at rest in {COUNT} vertices")
    for each, (name, kind) in zip(axes[1:], kinds.items(), strict=True):
        weights = cage_coordinates(fine, cage, kind)
        rest = np.abs(deform(weights, cage) - fine.vertices).max() / fine.diagonal
        least = weights.min()
        print(f"{name:20s} least weight {least:8.4f}, error at rest {rest:.1e} of the size")
        line(each, cage.moved(posed), QUIET, 1.2, 5.0)
        moved = fine.moved(deform(weights, posed))
        fill(each, moved, BODY)
        line(each, moved, INK, 0.8)
        each.set_title(f"{name}, weights from {least:.2f}")
    for each in axes:
        each.autoscale_view()
        each.invert_yaxis()
    save(figure, given.output / "bend.png")


if __name__ == "__main__":
    main()
