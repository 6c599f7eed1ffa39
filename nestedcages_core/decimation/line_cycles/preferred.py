"""Symmetric cycles around drawings that happen to be symmetric."""

from __future__ import annotations

from dataclasses import replace

from ...geometry.arrays import FloatArray
from ...geometry.loops import Loops
from ...geometry.mesh import Mesh
from ...geometry.precision import NEGLIGIBLE
from ...geometry.vectors import norm
from ...tasks import Stage
from ..alike import AsymmetricError, symmetrised
from ..request import Request
from .around import Around
from .loop_search import NoCyclesError


def symmetric_mesh(
    request: Request, outline: Loops, shift: FloatArray | float, most: float
) -> Stage[float, Mesh | None]:
    """The mesh of the best cycles with the preferred symmetry; None if they cross, or have more than an area.

    shift: of lines, in diameters.
    """
    symmetry = request.kept.preferred
    try:
        alike = symmetrised(outline, symmetry)
        if norm(alike.vertices - outline.vertices).max() > NEGLIGIBLE * outline.diameter:
            return None
        around = Around(replace(request, kept=replace(request.kept, symmetry=symmetry)), alike, shift)
        area, mesh = yield from around.run(1.0)
    except (AsymmetricError, NoCyclesError):
        return None
    return mesh if around.rounds == 0 and area <= most else None
