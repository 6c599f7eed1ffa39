"""The plots of the comparison."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np

mpl.use("Agg")

from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter
from PIL import Image

from comparison.measure import Measurement, Results

if TYPE_CHECKING:
    from comparison.experiments.sweeps import Point, Sweep
from data import Table1Row
from nestedcages_core import Mesh

FINE, COARSE, CAGE = "#f0c777", "#8a4b08", "#1f4e79"
DPI = 100
CONTACT_COLOURS = {
    "IPC": "#1f4e79",
    "IPC 2020": "#5aa9e6",
    "sequential QP": "#2a9d5c",
    "velocity filter": "#e0a100",
    "El Topo": "#c8553d",
    "paper's energy, Newton": "#7d5ba6",
}
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


def panel(axes: Axes, result: Measurement, title: str, told: str | None = None) -> None:
    """Fine mesh, at the end of the flow if there is no cage, coarse mesh and cage of one run, in the units of the
    solvers; told: what is said of it in place of its outcome."""
    fine = result.fine
    low, high = fine.vertices.min(axis=0), fine.vertices.max(axis=0)
    home = fine.moved((fine.vertices - 0.5 * (low + high)) / fine.diagonal)
    draw(axes, home if result.shrunk is None or result.cage is not None else result.shrunk, FINE, filled=True)
    if result.coarse is not None:
        draw(axes, result.coarse, COARSE, style="--", width=0.8)
    if result.cage is not None:
        draw(axes, result.cage, CAGE, width=1.2)
    outcome = f"{result.excess:.1f} %" if result.excess is not None else ""
    if not result.success:
        outcome = f"✗ {result.failed or 'not certified'}" + (f", {outcome}" if outcome else "")
    axes.set_title(f"{title}\n{outcome if told is None else told}", fontsize=7)
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


def contacts(results: Results, path: Path) -> None:
    """Medians and quartiles of excess over time of every contact, on the shapes that all of a variant solve."""
    from comparison.experiments import contacts as experiment

    variants = (experiment.DESCENT, experiment.CLEARING, experiment.TIGHTENED)
    figure, grid = plt.subplots(1, len(variants), figsize=(11.0, 3.6), sharey=True)
    for axes, variant in zip(grid, variants, strict=True):
        rows = experiment.solved_by_all(results, variant)
        for name in experiment.contacts_with(variant):
            own = [row[name] for row in rows]
            if not own:
                continue
            seconds = np.percentile([experiment.time_of(run) for run in own], (25, 50, 75))
            excess = np.percentile([run.excess or 0.0 for run in own], (25, 50, 75))
            lost = 1.0 - experiment.successes(results, name, variant)
            axes.errorbar(
                1e3 * seconds[1], excess[1],
                xerr=[[1e3 * (seconds[1] - seconds[0])], [1e3 * (seconds[2] - seconds[1])]],
                yerr=[[excess[1] - excess[0]], [excess[2] - excess[1]]],
                fmt="o", color=CONTACT_COLOURS[name], markersize=5, linewidth=1, label=name,
            )  # fmt: skip
            axes.annotate(f"{lost:.1%}", (1e3 * seconds[1], excess[1]), xytext=(4, 4), textcoords="offset points",
                          fontsize=6, color=CONTACT_COLOURS[name])  # fmt: skip
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_title(f"{variant}, {len(rows)} shapes", fontsize=9)
        axes.set_xlabel("reinflation, ms", fontsize=8)
        axes.grid(alpha=0.3, which="both")
    grid[0].set_ylabel("excess in per cent (numbers: failures)", fontsize=8)
    handles, labels = grid[-1].get_legend_handles_labels()
    figure.legend(handles, labels, fontsize=7, loc="upper center", ncols=6, bbox_to_anchor=(0.5, 0.0))
    _save(figure, path)


def sweeps(made: dict[str, Point], each: Sequence[Sweep], path: Path) -> None:
    """A panel for every contact: curves of excess over time, one for each of its parameters."""
    names = list(dict.fromkeys(sweep.contact for sweep in each))
    figure, grid = plt.subplots(2, 3, figsize=(11.0, 6.4), sharex=True, sharey=True)
    for axes, name in zip(grid.flat, names, strict=True):
        for place, sweep in enumerate(one for one in each if one.contact == name):
            found = [made[sweep.label(value)] for value in sweep.values if sweep.label(value) in made]
            colour = plt.get_cmap("tab10").colors[place]
            axes.plot([p.seconds for p in found], [p.above for p in found], "o-", markersize=3, linewidth=1,
                      color=colour, label=sweep.parameter)  # fmt: skip
            axes.scatter([p.seconds for p in found], [p.above for p in found], s=[900.0 * p.failures for p in found],
                         facecolors="none", edgecolors=colour, linewidths=0.8)  # fmt: skip
        default = made.get(f"{name}, default")
        if default is not None:
            axes.plot(default.seconds, default.above, "*", color="black", markersize=10, zorder=5)
        axes.set_title(name, fontsize=9)
        axes.set_xscale("log")
        axes.set_yscale("symlog", linthresh=1.0)
        axes.grid(alpha=0.3)
        axes.legend(fontsize=6)
    for axes in grid[-1]:
        axes.set_xlabel("reinflation, s", fontsize=8)
    for axes in grid[:, 0]:
        axes.set_ylabel("points above the tightest", fontsize=8)
    _save(figure, path)


def front(made: dict[str, Point], best: Sequence[str], path: Path) -> None:
    """Every setting of every contact, and those that no other beats."""
    figure, axes = plt.subplots(figsize=(7.5, 4.4))
    for name, colour in CONTACT_COLOURS.items():
        own = [point for point in made.values() if point.label.startswith(f"{name}, ")]
        axes.scatter([p.seconds for p in own], [p.above for p in own], s=14, color=colour, label=name)
        axes.scatter([p.seconds for p in own], [p.above for p in own], s=[900.0 * p.failures for p in own],
                     facecolors="none", edgecolors=colour, linewidths=0.8)  # fmt: skip
        default = made.get(f"{name}, default")
        if default is not None:
            axes.plot(default.seconds, default.above, "*", color=colour, markeredgecolor="black", markersize=12)
    chosen = [made[label] for label in best]
    axes.plot([p.seconds for p in chosen], [p.above for p in chosen], "s", markersize=9, markerfacecolor="none",
              markeredgecolor="black", linestyle="none", label="not beaten")  # fmt: skip
    axes.set_xscale("log")
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set_ylim(bottom=-0.1)
    axes.set_xlabel("reinflation, s", fontsize=8)
    axes.set_ylabel("points above the tightest", fontsize=8)
    axes.set_title("stars: defaults; rings: share of failures", fontsize=9)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7)
    _save(figure, path)


def scaling(results: Results, names: Sequence[str], path: Path) -> None:
    """Seconds and megabytes over fine vertices, at the fixed ratio of coarse ones."""
    from comparison.experiments.scaling import series

    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6))
    for name in names:
        runs = series(results, name)
        sizes = [len(run.fine.vertices) for run in runs]
        style = {"color": CONTACT_COLOURS[name], "markersize": 4, "label": name}
        left.plot(sizes, [run.seconds["reinflation"] for run in runs], "o-", **style)
        right.plot(sizes, [max(run.megabytes, 0.1) for run in runs], "o-", **style)
    for axes, title in ((left, "reinflation, CPU seconds"), (right, "peak memory added, MB")):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("fine vertices", fontsize=8)
        axes.set_title(title, fontsize=9)
        axes.grid(alpha=0.3)
    left.legend(fontsize=6)
    _save(figure, path)


def panes(results: Results, path: Path) -> None:
    """A row for each figure: input, end of the flow and result of the paper repaired, then the results of others."""
    methods = list(next(iter(results.values())))
    columns = ["input", f"flow: {methods[0]}", methods[0], f"flow: {methods[-1]}", methods[-1], *methods[1:-1]]
    figure, grid = plt.subplots(
        len(results), len(columns), figsize=(1.9 * len(columns), 2.0 * len(results)), squeeze=False
    )
    for axes_row, (name, runs) in zip(grid, results.items(), strict=True):
        first, last = runs[methods[0]], runs[methods[-1]]
        panel(axes_row[0], Measurement(first.fine, coarse=last.coarse), wrapped(name), told="input")
        for axes, run, method in ((axes_row[1], first, methods[0]), (axes_row[3], last, methods[-1])):
            shown = Measurement(run.fine, coarse=run.coarse, shrunk=run.shrunk)
            stuck = "✗ does not get inside" if run.failed == "flow" else f"{run.flow_steps} steps"
            panel(axes, shown, f"flow of\n{method}", told=stuck)
        for axes, method in zip((axes_row[2], axes_row[4], *axes_row[5:]), (methods[0], methods[-1], *methods[1:-1]),
                                strict=True):  # fmt: skip
            panel(axes, runs[method], method)
    _save(figure, path)


def _save(figure: plt.Figure, path: Path) -> None:
    figure.tight_layout()
    figure.savefig(path, dpi=DPI, bbox_inches="tight")
    plt.close(figure)
    with Image.open(path) as picture:
        few = picture.convert("RGB").quantize(COLOURS)
    few.save(path, optimize=True)  # a quarter of the size
