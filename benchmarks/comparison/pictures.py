"""The pictures: one for each conclusion, from the file of runs alone, and the paper's figures drawn again."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")

from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from comparison import methods
from comparison.conclusions import (
    APART,
    NEWTONS,
    RANGE_OF,
    after_tightening,
    seconds,
    shapes_from_all,
    spread,
    start_of,
)
from comparison.drawings import letter_a
from comparison.figures import Panes
from comparison.runs import Run, of, shared
from comparison.tables import FAMILIES
from nestedcages_core import Mesh, nested_cages

DPI = 100
COLOURS = dict(zip(FAMILIES, ("#1f4e79", "#c8553d", "#2a9d5c"), strict=True))
FINE, CAGE = "#f0c777", "#1f4e79"
METHOD_VERTICES = 24  # of the cage in the figure of the method
FARTHEST = 0.56  # diagonals from the middle: what lies farther out is cut off


def original(runs: Sequence[Run]) -> Figure:
    """Excess of 2022 over that of 2015 at two ranges, and times relative to 2015; all starts."""
    figure, axes = plt.subplots(1, 3, figsize=(12.0, 3.8))
    own, ratios = of(runs, "methods"), []
    for side, name in zip(axes, NEWTONS, strict=False):
        for family in FAMILIES:
            rows = shared([run for run in own if run.family == family], [methods.ORIGINAL, name])
            side.loglog([max(row[methods.ORIGINAL].excess or 0.0, 0.1) for row in rows],
                        [max(row[name].excess or 0.0, 0.1) for row in rows], "o", color=COLOURS[family], label=family,
                        markersize=4)  # fmt: skip
        ends = side.get_xlim()
        side.plot(ends, ends, color="grey", linewidth=0.8)
        side.set(xlabel="excess of 2015, %", ylabel=f"excess of 2022, %, d̂ = {RANGE_OF[name]:.2g}")
    axes[0].legend(fontsize=7)
    names = [methods.REPAIRED, *NEWTONS]
    for name in names:
        rows = shared(own, [methods.ORIGINAL, name])
        ratios.append([seconds(row[name]) / seconds(row[methods.ORIGINAL]) for row in rows])
    axes[2].boxplot(ratios, orientation="horizontal")
    axes[2].set_yticks([1, 2, 3], names)
    axes[2].set(xscale="log", xlabel="time, times that of 2015")
    return figure


def ranges(runs: Sequence[Run]) -> Figure:
    """Excess after reinflation over d̂ for both barriers, from each start."""
    figure, grid = plt.subplots(1, len(methods.STARTS), figsize=(12.0, 3.8), sharey=True)
    for axes, start in zip(grid, methods.STARTS, strict=True):
        rows = shared(of(runs, "contacts", start=start), methods.AT_RANGES)
        for name, colour in ((methods.IPC_2020, "#5aa9e6"), (methods.ENERGY_2022, "#7d5ba6")):
            found = [[row[methods.at(name, d)].excess for d in methods.RANGES] for row in rows]
            excess = np.array(found, np.float64).reshape(-1, len(methods.RANGES))
            low, middle, high = np.percentile(excess, [25.0, 50.0, 75.0], axis=0)
            axes.plot(methods.RANGES, middle, "o-", color=colour, label=name)
            axes.fill_between(methods.RANGES, low, high, color=colour, alpha=0.2, linewidth=0)
        axes.set(xscale="log", yscale="log", xlabel="range d̂ in diagonals", title=start)
    grid[0].set(ylabel="excess after reinflation, %")
    grid[0].legend(fontsize=8)
    return figure


def starts(runs: Sequence[Run]) -> Figure:
    """Largest over least excess after the tightening: of contacts from each start, and of starts; shapes sorted."""
    figure, axes = plt.subplots(figsize=(6.0, 3.8))
    rows = after_tightening(runs, FAMILIES)
    lines = {f"contacts, from {start}": [spread([run.tightened for run in row.values()]) for row in rows
                                         if start_of(row) == start] for start in methods.STARTS}  # fmt: skip
    lines["starts, median of contacts"] = [
        float(np.median([spread([row[name].tightened for row in of_shape]) for name in methods.CONTACTS]))
        for of_shape in shapes_from_all(rows)
    ]
    for (label, values), colour in zip(lines.items(), (*COLOURS.values(), "black"), strict=True):
        place = (np.arange(len(values)) + 0.5) / max(len(values), 1)
        axes.plot(100.0 * place, np.sort(values), color=colour, label=label)
    axes.axhline(APART, color="grey", linewidth=0.8)
    axes.set(yscale="log", xlabel="share of shapes, %", ylabel="largest over least excess")
    axes.legend(fontsize=7)
    return figure


def method() -> Figure:
    """The method on a letter, step by step."""
    level = nested_cages(letter_a(), [METHOD_VERTICES]).levels[0]
    inner, outer = level.reinflation.moving_steps, level.reinflation.cage_steps
    home = level.reinflation.tightening_start
    steps = {
        "1 start": (level.fine.vertices, level.coarse.vertices),
        "2 flow": (level.flow.steps[-1], level.coarse.vertices),
        "3 reinflation": (inner[max(1, home // 2)], outer[max(1, home // 2)]),
        "home": (inner[home], outer[home]),
        f"4 tightened: {100.0 * level.report.excess:.1f} %": (level.fine.vertices, outer[-1]),
    }
    figure, grid = plt.subplots(1, len(steps), figsize=(12.0, 2.8))
    low, high = level.cage.vertices.min(axis=0), level.cage.vertices.max(axis=0)
    for axes, (title, (fine, cage)) in zip(grid, steps.items(), strict=True):
        _pane(axes, title, level.fine.moved(fine), level.cage.moved(cage), 0.5 * (low + high), level.fine.diagonal)
    return figure


def panes(results: Sequence[Panes]) -> Figure:
    """Rows of figures; columns: start, flow and end by the program, and the end of ours."""
    figure, grid = plt.subplots(len(results), 4, figsize=(9.6, 2.5 * len(results)), squeeze=False)
    for row, found in zip(grid, results, strict=True):
        middle = "flow" if found.outcome[:7] != "outside" else "halfway through the flow"
        low = found.fine.vertices.min(axis=0)
        centre, size = 0.5 * (low + found.fine.vertices.max(axis=0)), found.fine.diagonal
        _pane(row[0], f"{found.figure.title}: start", found.fine, found.coarse, centre, size)
        _pane(row[1], middle, found.flowed, found.coarse, centre, size)
        _pane(row[2], f"end: {found.outcome}", found.ended, found.cage, centre, size)
        ours = found.ours
        title = f"ours: {ours.excess:.1f} %" if ours.success else f"ours: ✗ {ours.failed}"
        unit = found.fine.moved((found.fine.vertices - centre) / size)
        _pane(row[3], title, unit, ours.cage or ours.coarse or unit, np.zeros(2), 1.0)
    return figure


def _pane(axes: Axes, title: str, fine: Mesh, around: Mesh, centre: np.ndarray, size: float) -> None:
    """A fine mesh (filled) and what is around it, cut off far out."""
    _draw(axes, fine, FINE, filled=True)
    _draw(axes, around, CAGE)
    axes.set_title(title, fontsize=7)
    axes.set_aspect("equal")
    axes.axis("off")
    for limits, middle in ((axes.set_xlim, centre[0]), (axes.set_ylim, centre[1])):
        limits(middle - FARTHEST * size, middle + FARTHEST * size)


def _draw(axes: Axes, mesh: Mesh, colour: str, *, filled: bool = False, style: str = "-") -> None:
    for loop, sign in zip(mesh.loops, mesh.loop_signs, strict=True):
        closed = mesh.vertices[np.append(loop, loop[0])]
        if filled:
            axes.fill(closed[:, 0], closed[:, 1], color=colour if sign > 0 else "white", linewidth=0, zorder=1)
        else:
            axes.plot(closed[:, 0], closed[:, 1], style, color=colour, linewidth=1.0, zorder=3)


def save(figure: Figure, path: Path) -> None:
    """Write a picture and close it."""
    figure.tight_layout()
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
    plt.close(figure)
