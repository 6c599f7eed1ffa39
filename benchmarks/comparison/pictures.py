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
from comparison.conclusions import APART, after_tightening, spread
from comparison.measure import Measurement
from comparison.runs import Run, of, shared
from comparison.tables import FAMILIES
from nestedcages_core import Mesh

DPI = 100
COLOURS = dict(zip(FAMILIES, ("#1f4e79", "#c8553d", "#2a9d5c"), strict=True))
FINE, COARSE, CAGE = "#f0c777", "#8a4b08", "#1f4e79"
FARTHEST, MARGIN = 1.5, 0.03  # diagonals: what lies farther out is cut off; space around a drawing


def original(runs: Sequence[Run]) -> Figure:
    """Excess of 2022 over that of 2015, and times relative to 2015."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.8))
    names = [methods.ORIGINAL, methods.REPAIRED, methods.NEWTON]
    ratios: dict[str, list[float]] = {name: [] for name in names[1:]}
    for family in FAMILIES:
        rows = shared(of(runs, "methods", family), names)
        left.loglog([max(row[names[0]].excess or 0.0, 0.1) for row in rows],
                    [max(row[names[1]].excess or 0.0, 0.1) for row in rows], "o", color=COLOURS[family], label=family,
                    markersize=4)  # fmt: skip
        for name in names[1:]:
            ratios[name] += [(row[name].seconds or 1e-4) / (row[names[0]].seconds or 1e-4) for row in rows]
    ends = left.get_xlim()
    left.plot(ends, ends, color="grey", linewidth=0.8)
    left.set(xlabel="excess of 2015, %", ylabel="excess of 2022 repaired, %")
    left.legend(fontsize=7)
    right.boxplot(list(ratios.values()), orientation="horizontal")
    right.set_yticks([1, 2], list(ratios))
    right.set(xscale="log", xlabel="time, times that of 2015")
    return figure


def ranges(runs: Sequence[Run]) -> Figure:
    """Excess after reinflation over d̂ for both barriers; El Topo for comparison."""
    rows = shared(of(runs, "ranges"), list(methods.AT_RANGES))
    figure, axes = plt.subplots(figsize=(6.0, 3.8))
    for name, colour in ((methods.IPC_2020, "#5aa9e6"), (methods.ENERGY_2022, "#7d5ba6")):
        excess = np.array([[row[f"{name}, {d:g}"].excess for d in methods.RANGES] for row in rows]).reshape(-1, 4)
        low, middle, high = np.percentile(excess, [25.0, 50.0, 75.0], axis=0)
        axes.plot(methods.RANGES, middle, "o-", color=colour, label=name)
        axes.fill_between(methods.RANGES, low, high, color=colour, alpha=0.2, linewidth=0)
    known = [run.excess for run in of(runs, "contacts") if run.method == "El Topo" and run.success and run.excess]
    axes.axhline(float(np.median(known)) if known else 0.0, color="#c8553d", linestyle="--", label="El Topo, median")
    axes.set(xscale="log", yscale="log", xlabel="range d̂ in diagonals", ylabel="excess after reinflation, %")
    axes.legend(fontsize=8)
    return figure


def tightened(runs: Sequence[Run]) -> Figure:
    """Largest over least excess of the contacts before and after the tightening, shapes sorted."""
    figure, axes = plt.subplots(figsize=(6.0, 3.8))
    names = list(methods.CONTACTS)
    for family in FAMILIES:
        rows = after_tightening(runs, (family,))
        for style, values in (
            (":", [spread([row[name].excess for name in names]) for row in rows]),
            ("-", [spread([row[name].tightened for name in names]) for row in rows]),
        ):
            place = (np.arange(len(values)) + 0.5) / max(len(values), 1)
            label = f"{family}, {'tightened' if style == '-' else 'reinflation alone'}"
            axes.plot(100.0 * place, np.sort(values), style, color=COLOURS[family], label=label)
    axes.axhline(APART, color="grey", linewidth=0.8)
    axes.set(yscale="log", xlabel="share of shapes, %", ylabel="largest over least excess")
    axes.legend(fontsize=7)
    return figure


def panes(results: dict[str, dict[str, Measurement]]) -> Figure:
    """Rows of methods, columns of drawings: fine mesh (filled), coarse mesh (dashed), cage."""
    names = list(next(iter(results.values())))
    figure, grid = plt.subplots(len(names), len(results), figsize=(2.1 * len(results), 2.2 * len(names)), squeeze=False)
    for column, (drawing, found) in zip(grid.T, results.items(), strict=True):
        for axes, name in zip(column, names, strict=True):
            _pane(axes, found[name], f"{drawing}\n{name}" if name == names[0] else name)
    return figure


def _pane(axes: Axes, result: Measurement, title: str) -> None:
    fine = result.fine
    low, high = fine.vertices.min(axis=0), fine.vertices.max(axis=0)
    home = fine.moved((fine.vertices - 0.5 * (low + high)) / fine.diagonal)
    shown = home if result.shrunk is None or result.cage is not None else result.shrunk
    _draw(axes, shown, FINE, filled=True)
    for mesh, colour, style in ((result.coarse, COARSE, "--"), (result.cage, CAGE, "-")):
        if mesh is not None:
            _draw(axes, mesh, colour, style=style)
    outcome = f"{result.excess:.1f} %" if result.certified else ""
    if not result.success:
        short = f"rests {result.short:.0e} short" if result.certified and result.short else ""
        outcome = f"{outcome}, {short}" if short else f"✗ {result.failed or 'not certified'}"
    axes.set_title(f"{title}\n{outcome}", fontsize=7)
    axes.set_aspect("equal")
    axes.axis("off")
    known = [mesh.vertices for mesh in (home, result.coarse, result.cage) if mesh is not None]
    across = np.clip(np.concatenate(known), -FARTHEST, FARTHEST)
    (left, bottom), (right, top) = across.min(axis=0) - MARGIN, across.max(axis=0) + MARGIN
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)


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
