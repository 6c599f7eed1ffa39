"""Symmetric cages next to free ones, around shapes that are united with their images."""

from __future__ import annotations

import time
from collections.abc import Mapping

import numpy as np

from nestedcages_core import Mesh, Mirror, NestedCagesError, Rotation, Settings, nested_cages, verify
from nestedcages_core.cache import forget
from nestedcages_core.geometry.group import Orbits
from nestedcages_core.geometry.solids import overlay

from .table import Table, per_cent

COUNTS = (12, 18, 36, 60)
"""Vertices of the cages: multiples of all orders."""

SYMMETRIES = {"mirror": Mirror(None), "order 3": Rotation(None, 3)}
"""Through the middle of each shape."""

NEARLY = 1.03
"""Multiple of the free excess up to which a symmetric one counts as no worse: local optima scatter as much."""


def table(shapes: Mapping[str, Mesh]) -> Table:
    """Excess of free and of symmetric cages."""
    made = Table(
        ["shape", "symmetry", *(f"{count} vertices" for count in COUNTS), "seconds"],
        before="`python benchmarks/needs.py symmetry`: excess in per cent of free cages and, after the slash, of "
        "symmetric ones around the same shape, which is united with its images first; CPU seconds of a free and of a "
        "symmetric cage in the mean.",
    )
    ratios: list[float] = []
    for name, shape in shapes.items():
        for kind, symmetry in SYMMETRIES.items():
            placed = symmetry.placed(shape)
            images = [Mesh(placed.image(shape.vertices, k), shape.edges) for k in range(placed.order)]
            fine = overlay(images)
            cells, spent = [], np.zeros(2)
            for count in COUNTS:
                excess = []
                for k, settings in enumerate((Settings(), Settings(symmetry=placed))):
                    forget()
                    begin = time.process_time()
                    try:
                        level = nested_cages(fine, [count], settings).levels[0]
                    except NestedCagesError:
                        break
                    spent[k] += time.process_time() - begin
                    cage = level.cage
                    made.good = made.good and bool(verify(cage, fine)) and len(cage.vertices) == count
                    excess.append(level.report.excess)
                if len(excess) < 2:
                    cells.append("–")
                    continue
                orbits = Orbits.of(cage.vertices, cage.successor, placed, 1e-9 * cage.diagonal)
                alike = orbits is not None and np.array_equal(orbits.symmetrised(cage.vertices), cage.vertices)
                made.good = made.good and alike
                ratios.append(excess[1] / excess[0])
                cells.append(" / ".join(map(per_cent, excess)))
            tried = sum(cell != "–" for cell in cells)
            if tried == 0:
                continue
            made.rows.append([name, kind, *cells, f"{spent[0] / tried:.2f} / {spent[1] / tried:.2f}"])
    made.after = (
        f"In {sum(ratio <= NEARLY for ratio in ratios)} of {len(ratios)} the symmetric cage has at most "
        f"{NEARLY:g} times the excess of the free one, in {sum(ratio < 1.0 for ratio in ratios)} less; the median is "
        f"{np.median(ratios):.3f} times, the most {max(ratios):.2f} times."
    )
    return made
