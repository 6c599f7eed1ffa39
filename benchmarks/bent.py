"""What the benchmarks of drawings that follow their cages share: the options, the shapes, a bend and its picture."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from data import shape_names

BENT = "glyph_g"  # the shape of the picture
TURN = 0.5  # radians by which its top is turned against its bottom
STYLES = ({"color": "#27364b"}, {"color": "#d55e00", "marker": ".", "linewidth": 1})  # of drawing and cage


def arguments(description: str | None) -> tuple[argparse.Namespace, list[str]]:
    """The options, and the names of the shapes."""
    options = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--data", type=Path, help="folder of your own shapes (name_V.csv, name_E.csv)")
    options.add_argument("--vertices", type=int, default=32, help="vertices of the cages (default: 32)")
    options.add_argument("--picture", type=Path, help="file for a picture of a bent glyph")
    given = options.parse_args()
    return given, shape_names(given.data)


def bend(mesh: Any, about: np.ndarray) -> np.ndarray:
    """(n, 2) places of a mesh's vertices: the higher one is, the more it is turned about a point."""
    height = np.ptp(mesh.vertices[:, 1])
    turn = TURN * (mesh.vertices[:, 1] - about[1]) / height
    x, y = (mesh.vertices - about).T
    return about + np.stack((x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)), axis=1)


def left_outside(drawing: Any, cage: Any) -> int:
    """How many vertices of a drawing are not in the solid of its cage; the posed cage may cross itself."""
    from nestedcages_core.geometry.predicates import winding_number

    around = winding_number(drawing.vertices, cage.vertices, cage.vertices[cage.successor])
    return int((around == 0).sum())


def draw(poses: Mapping[str, tuple[Any, Any]], path: Path) -> None:
    """Drawings in their cages, (drawing, cage) by title, side by side; needs matplotlib."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(1, len(poses), figsize=(3.5 * len(poses), 5), layout="constrained", squeeze=False)
    for axes, (title, meshes) in zip(panels[0], poses.items(), strict=True):
        for mesh, style in zip(meshes, STYLES, strict=True):
            for loop in mesh.loops:
                axes.plot(*mesh.vertices[np.append(loop, loop[0])].T, **style)
        axes.set_title(title)
        axes.set_aspect("equal")
        axes.axis("off")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    print(f"Wrote {path}")
