"""The plots of the comparison."""

from __future__ import annotations

import textwrap
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")

from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from PIL import Image

from comparison.measure import Measurement, Results
from data import Table1Row
from nestedcages_core import Mesh

FINE, COARSE, CAGE = "#f0c777", "#8a4b08", "#1f4e79"
DPI = 100
COLOURS = 96  # of a picture that is kept
FARTHEST, MARGIN = 1.5, 0.03  # diagonals: what lies farther out is cut off; space around a drawing


def draw(axes: Axes, mesh: Mesh, colour: str, *, filled: bool = False, style: str = "-", width: float = 1.0) -> None:
    """The outline of a mesh, or its solid."""
    for loop, sign in zip(mesh.loops, mesh.loop_signs, strict=True):
        closed = mesh.vertices[np.append(loop, loop[0])]
        if filled:
            axes.fill(closed[:, 0], closed[:, 1], color=colour if sign > 0 else "white", linewidth=0, zorder=1)
        else:
            axes.plot(closed[:, 0], closed[:, 1], style, color=colour, linewidth=width, zorder=3)


def panel(axes: Axes, result: Measurement, title: str) -> None:
    """Fine mesh, coarse mesh and cage of one run, in the units of the solvers."""
    fine = result.fine
    low, high = fine.vertices.min(axis=0), fine.vertices.max(axis=0)
    draw(axes, fine.moved((fine.vertices - 0.5 * (low + high)) / fine.diagonal), FINE, filled=True)
    if result.coarse is not None:
        draw(axes, result.coarse, COARSE, style="--", width=0.8)
    if result.cage is not None:
        draw(axes, result.cage, CAGE, width=1.2)
    outcome = f"{result.excess:.1f} %" if result.excess is not None else ""
    if not result.success:
        outcome = f"✗ {result.failed or 'not certified'}" + (f", {outcome}" if outcome else "")
    axes.set_title(f"{title}\n{outcome}", fontsize=7)
    axes.set_aspect("equal")
    axes.axis("off")
    shown = [(fine.vertices - 0.5 * (low + high)) / fine.diagonal]
    shown += [mesh.vertices for mesh in (result.coarse, result.cage) if mesh is not None]
    across = np.clip(np.concatenate(shown), -FARTHEST, FARTHEST)
    (left, bottom), (right, top) = across.min(axis=0), across.max(axis=0)
    axes.set_xlim(left - MARGIN, right + MARGIN)
    axes.set_ylim(bottom - MARGIN, top + MARGIN)


def gallery(results: Results, names: list[str], path: Path) -> None:
    """Rows of shapes, columns of methods; a picture is the size of its drawing."""
    rows = [shape for shape in results if any(name in results[shape] for name in names)]
    figure, grid = plt.subplots(len(rows), len(names), figsize=(2.0 * len(names), 2.1 * len(rows)), squeeze=False)
    for i, shape in enumerate(rows):
        for j, name in enumerate(names):
            panel(grid[i][j], results[shape][name], f"{wrapped(shape)}\n{name}" if j == 0 else name)
    _save(figure, path)


def wrapped(title: str) -> str:
    """The title in lines short enough for a panel."""
    return "\n".join(textwrap.wrap(title, 24))


def table1(results: Results, rows: tuple[Table1Row, ...], path: Path) -> None:
    """Excess and time over the number of fine vertices."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.4))
    sizes = [row.fine_vertices for row in rows]
    if all(row.reference_excess for row in rows):
        left.plot(sizes, [row.reference_excess for row in rows], "x--", color="black", label="the paper's C++ program")
        right.plot(
            sizes, [row.reference_seconds for row in rows], "x--", color="black", label="the paper's C++ program"
        )
    for name in next(iter(results.values())):
        found = [results[str(size)][name] for size in sizes]
        left.plot(sizes, [result.excess for result in found], "o-", markersize=3, label=name)
        right.plot(sizes, [result.total for result in found], "o-", markersize=3, label=name)
    for axes, title in ((left, "excess in per cent"), (right, "CPU seconds")):
        axes.set_xscale("log")
        axes.set_xticks(sizes, [str(size) for size in sizes], fontsize=7)
        axes.set_xticks([], minor=True)
        axes.set_xlabel("fine vertices")
        axes.set_title(title, fontsize=9)
        axes.grid(alpha=0.3)
    right.set_yscale("log")
    left.legend(fontsize=7)
    _save(figure, path)


def staircase(results: Results, path: Path) -> None:
    """Time and excess while the paper turns into ours; a cross where a run did not succeed."""
    names = list(next(iter(results.values())))
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.2), sharey=True)
    place = np.arange(len(names))[::-1]
    colours = plt.get_cmap("tab20").colors
    for k, (shape, found) in enumerate(results.items()):
        lost = [j for j, name in enumerate(names) if not found[name].success]
        seconds = [found[name].total for name in names]
        excess = [np.nan if found[name].excess is None else found[name].excess for name in names]
        for axes, values in ((left, seconds), (right, excess)):
            axes.plot(values, place, "o-", markersize=3, color=colours[k % len(colours)], label=shape)
            axes.plot([values[j] for j in lost], place[lost], "x", color="black", markersize=4, zorder=4)
    left.set_yticks(place, names, fontsize=7)
    left.set_xscale("log")
    left.set_title("CPU seconds (×: no success)", fontsize=9)
    right.set_title("excess in per cent", fontsize=9)
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, fontsize=7, loc="upper center", ncols=6, bbox_to_anchor=(0.5, 0.0))
    for axes in (left, right):
        axes.grid(alpha=0.3)
    _save(figure, path)


def starts(results: Results, path: Path) -> None:
    """Excess and time of every contact from every start, where it succeeded."""
    names = list(next(iter(results.values())))
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 3.8))
    place = np.arange(len(results))
    marks, colours = "os^Dv*", plt.get_cmap("tab10").colors
    for k, name in enumerate(names):
        found = [shape[name] for shape in results.values()]
        shift = place + 0.1 * (k - 0.5 * (len(names) - 1))
        style = {"color": colours[k % len(colours)], "label": name, "markersize": 4}
        left.plot(shift, [r.excess if r.success else np.nan for r in found], marks[k % len(marks)], **style)
        right.plot(shift, [r.total if r.success else np.nan for r in found], marks[k % len(marks)], **style)
    for axes, title in ((left, "excess in per cent"), (right, "CPU seconds")):
        axes.set_xticks(place, list(results), fontsize=6, rotation=20)
        axes.set_title(title, fontsize=9)
        axes.grid(alpha=0.3)
        axes.set_yscale("log")
    right.legend(fontsize=6, loc="center left", bbox_to_anchor=(1.0, 0.5))
    _save(figure, path)


def _save(figure: plt.Figure, path: Path) -> None:
    figure.tight_layout()
    figure.savefig(path, dpi=DPI, bbox_inches="tight")
    plt.close(figure)
    with Image.open(path) as picture:
        few = picture.convert("RGB").quantize(COLOURS)
    few.save(path, optimize=True)  # a quarter of the size
