"""What the pictures of the stories share: meshes as filled areas and lines, with matplotlib."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline

from nestedcages_core import Mesh

BUILD = Path(__file__).resolve().parent.parent / "build" / "stories"

INK, BODY, QUIET = "#27364b", "#c3cfdf", "#8796ab"
# Lines after Okabe and Ito, also for the colour-blind.
BLUE, GREEN, ORANGE, RED, PURPLE = "#0072b2", "#009e73", "#e69f00", "#d55e00", "#cc79a7"
LEVELS = (BLUE, GREEN, ORANGE, RED, PURPLE)


def arguments(description: str) -> argparse.Namespace:
    """The options that every story has."""
    options = argparse.ArgumentParser(description=description)
    options.add_argument("--output", type=Path, default=BUILD, help="folder for the files (default: build/stories)")
    options.add_argument("--small", action="store_true", help="a small form that takes a second or two")
    given = options.parse_args()
    given.output.mkdir(parents=True, exist_ok=True)
    return given


def patch(mesh: Mesh, **style: Any) -> PathPatch:
    """A mesh as a patch, holes left open."""
    points, codes = [], []
    for loop in mesh.loops:
        points.append(mesh.vertices[np.append(loop, loop[0])])
        codes += [Outline.MOVETO, *[Outline.LINETO] * (len(loop) - 1), Outline.CLOSEPOLY]
    return PathPatch(Outline(np.concatenate(points), codes), **style)


def fill(axes: plt.Axes, mesh: Mesh, colour: str, alpha: float = 1.0) -> None:
    axes.add_patch(patch(mesh, facecolor=colour, edgecolor="none", alpha=alpha))


def line(axes: plt.Axes, mesh: Mesh, colour: str, width: float = 1.5, dots: float = 0.0) -> None:
    """The loops, with their vertices as dots of a size in points."""
    axes.add_patch(patch(mesh, facecolor="none", edgecolor=colour, linewidth=width, joinstyle="round"))
    if dots:
        axes.plot(*mesh.vertices.T, ".", color=colour, markersize=dots, markeredgewidth=0.0, zorder=1)


def panels(count: int, *, width: float = 5.0, height: float = 5.0, rows: int = 1) -> tuple[plt.Figure, list[plt.Axes]]:
    """Panels of a size side by side, in rows, without frames."""
    columns = -(-count // rows)
    size = (width * columns, height * rows)
    figure, axes = plt.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained")
    for each in axes.flat:
        each.set_aspect("equal")
        each.axis("off")
    return figure, list(axes.flat)[:count]


def save(figure: plt.Figure, path: Path) -> None:
    """Write the picture and say so."""
    for axes in figure.axes:
        if axes.get_autoscale_on():
            axes.autoscale_view()
    figure.savefig(path, dpi=110, bbox_inches="tight", pad_inches=0.15)
    plt.close(figure)
    print(f"Wrote {path}")
