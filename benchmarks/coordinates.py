"""Cage coordinates on every shape: errors at rest and under affine motions, least weights, time; a bent glyph by each.

    python benchmarks/coordinates.py --data ../shared/data/shapes --picture build/coordinates.png

The shapes are pairs of files `name_V.csv` and `name_E.csv`. The picture needs matplotlib.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from data import read_shape  # noqa: E402
from nestedcages_core import (  # noqa: E402
    Harmonic,
    MeanValue,
    Mesh,
    PiecewiseLinear,
    cage_coordinates,
    deform,
    nested_cages,
)

SHAPES = ROOT.parent / "shared" / "data" / "shapes"
KINDS = {"mean value": MeanValue(), "harmonic": Harmonic(), "piecewise linear": PiecewiseLinear()}
MOTIONS = 20  # affine motions tried on each shape
BENT = "glyph_g"  # the shape of the picture
TURN = 0.5  # radians by which its top is turned against its bottom


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


def bend(mesh: Mesh, about: np.ndarray) -> np.ndarray:
    """The higher a vertex, the more it is turned about a point."""
    height = np.ptp(mesh.vertices[:, 1])
    turn = TURN * (mesh.vertices[:, 1] - about[1]) / height
    x, y = (mesh.vertices - about).T
    return about + np.stack((x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)), axis=1)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--data", type=Path, default=SHAPES, help="folder of the shapes")
    options.add_argument("--vertices", type=int, default=32, help="vertices of the cages (default: 32)")
    options.add_argument("--picture", type=Path, help="file for a picture of a bent glyph")
    given = options.parse_args()
    names = sorted(path.name.removesuffix("_V.csv") for path in given.data.glob("*_V.csv"))
    if not names:
        options.error(f"{given.data} has no shapes")
    print(f"{'shape':12s} {'coordinates':18s} {'at rest':>9s} {'affine':>9s} {'least':>8s} {'seconds':>8s}")
    for name in names:
        fine = read_shape(given.data, name)
        cage = nested_cages(fine, [given.vertices]).cages[0]
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
    if given.picture:
        draw(read_shape(given.data, BENT), given.vertices, given.picture)


def draw(fine: Mesh, vertices: int, path: Path) -> None:
    """The bent glyph by each kind of coordinates."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    cage = nested_cages(fine, [vertices]).cages[0]
    foot = fine.vertices.min(axis=0)
    figure, panels = plt.subplots(1, 1 + len(KINDS), figsize=(14, 5), layout="constrained")
    poses = {"at rest": (fine, cage)}
    for kind, coordinates in KINDS.items():
        posed = cage.moved(bend(cage, foot))
        poses[kind] = (fine.moved(deform(cage_coordinates(fine, cage, coordinates), posed)), posed)
    styles = ({"color": "#27364b"}, {"color": "#d55e00", "marker": ".", "linewidth": 1})
    for axes, (title, meshes) in zip(panels, poses.items(), strict=True):
        for mesh, style in zip(meshes, styles, strict=True):
            for loop in mesh.loops:
                axes.plot(*mesh.vertices[np.append(loop, loop[0])].T, **style)
        axes.set_title(title)
        axes.set_aspect("equal")
        axes.axis("off")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    print(f"Wrote {path}")


if __name__ == "__main__":
    main()
