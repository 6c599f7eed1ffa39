"""Our drawings of figures 1 to 5 by the paper's method as written and repaired, by others, and by ours."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from common import FAILED, Options, table
from nestedcages_core import FlowError, Mesh, as_published, verify
from paper.methods import DESCENT, SIMPLE_2022, WHOLE, figures, measured, of_2022

PROGRAM = {
    "figure 1": ("A_guy_fine", "A_guy_coarse", 18.638),
    "figure 2": ("octagon_hole_hand", "square_hole_hand", 41.770),
}
"""The paper's own meshes, and the excess in per cent of the last cage of its C++ program."""


def mesh(folder: Path, name: str) -> Mesh:
    """A mesh of the paper's program: a row of NAME_V.csv for each vertex, and of NAME_E.csv for each edge."""
    vertices, edges = (np.loadtxt(folder / f"{name}_{part}.csv", delimiter=",") for part in "VE")
    return Mesh(vertices, edges.astype(int))


def check(options: Options) -> str:
    """The method as written next to the paper's program, on the meshes of the paper."""
    if options.meshes is None:
        return "The paper's own meshes are not here: --meshes FOLDER says where."
    rows = []
    for figure, (fine_name, coarse_name, recorded) in PROGRAM.items():
        fine, coarse = mesh(options.meshes, fine_name), mesh(options.meshes, coarse_name)
        excess = 100.0 * (as_published(fine, coarse).cage.area / fine.area - 1.0)
        same = abs(excess - recorded) < 1e-3
        rows.append((figure, f"{excess:.3f}", f"{recorded:.3f}", "good" if same else FAILED))
    return table(("excess in per cent", "as_published", "C++ program", ""), rows)


def written(fine: Mesh, coarse: Mesh) -> str:
    """The method as written, which never returns exactly: the fine mesh ends so many diagonals short."""
    try:
        result = as_published(fine, coarse)
    except FlowError:
        return "flow"
    if not np.isfinite(result.cage.vertices).all():
        return "infinite"
    short = f"{result.short / fine.diagonal:.0e} short"
    certificate = verify(result.cage, fine, 0.0, same_loops=False)
    return f"{100.0 * certificate.excess:.1f} %, {short}" if certificate.holds else f"does not enclose, {short}"


def run(options: Options) -> str:
    drawn = dict(list(figures().items())[: 2 if options.quick else None])
    rows = []
    if not options.quick:
        rows.append(("2022 as written", *(written(*pair) for pair in drawn.values())))
    methods = {**WHOLE} if options.quick else {"2022 repaired": of_2022(DESCENT), **WHOLE}
    for name, settings in methods.items():
        rows.append((name, *(told(settings, *pair) for pair in drawn.values())))
    simple = (told(SIMPLE_2022, fine, len(coarse.vertices)) for fine, coarse in drawn.values())
    rows.append(("simple cages 2022", *simple))
    return f"Excess and CPU seconds, or the stage that fails\n{table(('method', *drawn), rows)}"


def told(settings: object, fine: Mesh, coarse: Mesh | int) -> str:
    one = measured(settings, fine, coarse, 30.0)
    return f"fails: {one.failed}" if one.failed else f"{one.excess:.1f} %, {one.seconds:.2f} s"
