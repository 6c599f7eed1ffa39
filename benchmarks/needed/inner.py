"""Inner cages next to GEOS's inner polygon hull with as many vertices as that reached."""

from __future__ import annotations

import time
from collections.abc import Mapping

import numpy as np

from nestedcages_core import Mesh, NestedCagesError, inner_cages, verify
from nestedcages_core.cache import forget
from peers import inner_polygon_hull

from .table import Table, per_cent

COUNTS = (16, 32, 64)
"""Vertices that are asked for."""

CLEARANCE_POINTS = 0.03
"""Percentage points added to both losses in a ratio: what the clearance costs; GEOS's hulls touch the shape."""


def table(shapes: Mapping[str, Mesh]) -> Table:
    """Area lost by cages inside."""
    made = Table(
        [
            "shape",
            "asked for",
            "ours, lost",
            "GEOS, vertices",
            "lost",
            "verdict",
            "ours with as many",
            "seconds",
            "GEOS",
        ],
        before="`python benchmarks/needs.py inner`: area lost, in per cent, by cages inside; then by GEOS's polygon "
        "hull with isOuter false, with the most vertices up to those asked for, and by ours with as many. CPU seconds; "
        "those of GEOS are for a search over its fraction of vertices.",
    )
    ratios = []
    for name, fine in shapes.items():
        for count in COUNTS:
            forget()
            begin = time.process_time()
            ours = lost(fine, count, made)
            seconds = time.process_time() - begin
            peer = inner_polygon_hull(fine, count)
            cells = [ours]
            if peer is None:
                cells += ["–", "–", "–", "–", f"{seconds:.2f}", "–"]
            else:
                alike = lost(fine, peer.vertices, made)
                if alike != "none":
                    ratios.append((float(alike) + CLEARANCE_POINTS) / (CLEARANCE_POINTS - 100.0 * peer.excess))
                cells += [str(peer.vertices), f"{-peer.excess:.2f}", peer.verdict, alike]
                cells += [f"{seconds:.2f}", f"{peer.seconds:.2f}"]
            made.rows.append([name, str(count), *cells])
    if ratios:
        made.after = (
            f"With as many vertices, ours lose {np.median(ratios):.2f} times the area of GEOS's polygon hulls, in "
            f"the median of {len(ratios)}, and at most {max(ratios):.2f} times."
        )
    return made


def lost(fine: Mesh, count: int, made: Table) -> str:
    """Area lost by our cage; "none" where there is none."""
    try:
        level = inner_cages(fine, [count]).levels[0]
    except NestedCagesError:
        return "none"
    made.good = made.good and bool(verify(fine, level.cage, level.report.wanted_clearance))
    return per_cent(-level.report.excess)
