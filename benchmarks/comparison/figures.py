"""Figures 1 to 5 of the paper again, in its three panes: start, flow, end; by its program and by ours."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from comparison import methods
from comparison.drawings import drawings
from comparison.measure import Measurement, measure
from data import read_shape
from nestedcages_core import FlowError, Mesh, as_published, verify


@dataclass(frozen=True)
class Figure:
    """One figure of the paper."""

    title: str
    said: str
    """What the paper says of it."""
    drawing: str
    """Our drawing of its meshes."""
    meshes: tuple[str, str] = ("", "")
    """Its own, as far as they come with its program."""


FIGURES = (
    Figure("1, 2: the A", "“the result of the flow step is in the centre, and the reinflated fine mesh with nested "
           "cage is on the right”", "letter A, 45 + 6 in 32 + 3", ("A_guy_fine", "A_guy_coarse")),
    Figure("3", "“another example of a successful nested cage”", "figure 3: disc with a hole in a pentagon"),
    Figure("4", "“nested cages can be generated when the fundamental group of the coarse mesh is a subgroup of the "
           "fundamental group of the fine mesh”", "figure 4: disc with two holes, one covered"),
    Figure("5", "“the flow step may fail for very coarse meshes”", "figure 5: pentagon with a hole in a triangle"),
)  # fmt: skip


@dataclass(frozen=True)
class Panes:
    """A figure drawn again: three panes of the program, and the end of ours."""

    figure: Figure
    fine: Mesh
    coarse: Mesh
    flowed: Mesh
    """The fine mesh at the end of the flow, or halfway where the flow fails."""
    ended: Mesh
    """The fine mesh at the end."""
    cage: Mesh
    outcome: str
    ours: Measurement


def results(folder: Path | None = None) -> list[Panes]:
    """All figures; of the paper's own meshes in a folder where it has them."""
    return [panes(figure, folder) for figure in FIGURES]


def panes(figure: Figure, folder: Path | None = None) -> Panes:
    """A figure by the program as published, with absolute lengths, and by ours with IPC."""
    if folder is not None and figure.meshes[0]:
        fine, coarse = (read_shape(folder, name) for name in figure.meshes)
    else:
        fine, coarse = drawings()[figure.drawing]
    ours = measure(methods.TIGHT, fine, coarse, 1)
    try:
        result = as_published(fine, coarse)
    except FlowError as error:
        steps = error.partial.steps
        flowed, ended = fine.moved(steps[len(steps) // 2]), fine.moved(steps[-1])
        return Panes(
            figure, fine, coarse, flowed, ended, coarse, f"outside after {len(steps) - 1} steps of the flow", ours
        )
    certificate = verify(result.cage, fine, same_loops=coarse.has_loops_like(fine))
    excess = f"{100.0 * certificate.excess:.1f} %"
    short = f"{result.short / fine.diagonal:.0e} diagonals short"
    outcome = f"{excess}, {short}" if certificate.holds else f"does not enclose, {short}"
    if not np.isfinite(result.cage.vertices).all():
        outcome = "infinite"
    flowed, ended = fine.moved(result.flow_steps[-1]), fine.moved(result.returned)
    return Panes(figure, fine, coarse, flowed, ended, result.cage, outcome, ours)
