"""Grids from 1e-2 to 1e-6 of a shape's size: whether there is a cage, and its excess next to that of a free one."""

from __future__ import annotations

import time
from collections.abc import Mapping

import numpy as np

from nestedcages_core import Mesh, NestedCagesError, Settings, nested_cages, verify
from nestedcages_core.cache import forget
from nestedcages_core.geometry.lattice import Grid

from .table import Table, per_cent

PARTS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
"""Grids, as fractions of the diagonal; each is rounded to one digit, as people write them."""

COUNTS = (16, 32, 64)
"""Vertices of the cages."""

ROUNDED = 0.8
"""Clearance, in steps of the grid, of cages whose vertices are simply rounded afterwards: enough for it."""


def table(shapes: Mapping[str, Mesh]) -> Table:
    """Excess of cages on grids, and of cages that are tightened with room for rounding and then rounded."""
    made = Table(
        [
            "shape, vertices",
            "free",
            *(f"{part:g}" for part in PARTS),
            f"rounded, {PARTS[1]:g}",
            "seconds, free",
            "on grids",
        ],
        before=f"`python benchmarks/needs.py grids`: excess in per cent of cages on grids of {PARTS[0]:g} to "
        f"{PARTS[-1]:g} of the diagonal; the next column rounds the vertices of a cage that has {ROUNDED:g} steps of "
        f"room for it. CPU seconds, those on grids in the mean.",
    )
    asked = found = 0
    for name, fine in shapes.items():
        for count in COUNTS:
            forget()
            begin = time.process_time()
            free = nested_cages(fine, [count]).levels[0]
            seconds = time.process_time() - begin
            forget()
            cells, begin = [], time.process_time()
            for part in PARTS:
                asked += 1
                spacing = float(f"{part * fine.diagonal:.0e}")
                try:
                    level = nested_cages(fine, [count], Settings(grid=spacing)).levels[0]
                except NestedCagesError:
                    cells.append("none")
                    continue
                found += 1
                good = verify(level.cage, fine, level.report.wanted_clearance) and Grid(spacing).holds(
                    level.cage.vertices
                )
                made.good = made.good and bool(good)
                cells.append(per_cent(level.report.excess))
            on_grids = (time.process_time() - begin) / len(PARTS)
            rounded = simply_rounded(fine, count, float(f"{PARTS[1] * fine.diagonal:.0e}"))
            times = f"{seconds:.2f}", f"{on_grids:.2f}"
            made.rows.append([f"{name}, {count}", per_cent(free.report.excess), *cells, rounded, *times])
    made.after = f"Cages were found on {found} of {asked} grids."
    return made


def simply_rounded(fine: Mesh, count: int, spacing: float) -> str:
    """Excess of a cage with room for rounding, rounded; "fails" where that is no cage."""
    clearance = 1e-5 * fine.diagonal
    try:
        cage = nested_cages(fine, [count], Settings(clearance=clearance + ROUNDED * spacing)).levels[0].cage
    except NestedCagesError:
        return "fails"
    grid = Grid(spacing)
    rounded = cage.moved(grid.points(np.asarray(grid.places(cage.vertices))))
    certificate = verify(rounded, fine, clearance)
    return per_cent(certificate.excess) if certificate else "fails"
