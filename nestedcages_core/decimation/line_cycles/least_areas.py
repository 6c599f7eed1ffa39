"""What each number of lines around each loop costs, crossings aside, without choosing any."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ...geometry.arrays import FloatArray
from ...geometry.mesh import Mesh
from ...geometry.precision import ROUND_OFF
from ...tasks import Stage
from ..base import Kept
from ..hull.narrow_gaps import HULL_OFFSET, without_gaps
from ..request import Request
from .around import Around


def least_areas(
    fine: Mesh, total: int, kept: Kept, loops: Collection[int], clearance: float
) -> Stage[float, dict[int, FloatArray]]:
    """For some loops of a mesh, by number, the least area (K,) that cycles of 0, 1, … lines around it add to it.

    total: vertices that all loops have together, at least three each; kept: what lines keep, without symmetries.
    Infinite where no cycle was found; loops that have none at all are left out.
    """
    request = Request.of(fine, total, kept=kept)
    outline = without_gaps(request.outline, ROUND_OFF * request.outline.diameter)
    shift = np.full(len(outline.sizes), max(HULL_OFFSET, clearance / outline.diameter))
    for rule in kept.rules:
        if (of_loops := rule.distances(fine)) is not None:
            shift = np.maximum(shift, of_loops[request.loop_order] / outline.diameter)
    number = {int(loop): k for k, loop in enumerate(request.loop_order)}
    found = yield from Around(request, outline, shift, [number[k] for k in loops]).least_areas()
    return {int(request.loop_order[k]): areas for k, areas in found.items()}
