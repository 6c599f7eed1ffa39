"""Starts with exact symmetry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..decimation import Start
from ..errors import NestingError
from ..geometry.arrays import FloatArray
from ..geometry.group import Orbits, Symmetry, orbits_of
from ..solver.elimination import Elimination


@dataclass(frozen=True, eq=False)
class Alike:
    """A coarse mesh with exact symmetry, and which of its vertices are images."""

    start: Start
    orbits: Orbits
    images: Elimination

    def symmetrised(self, steps: FloatArray) -> FloatArray:
        """Steps (K, m, 2) of the cage in the input's units with exact symmetry."""
        return np.stack([self.orbits.symmetrised(step) for step in steps])


def made_alike(start: Start, symmetry: Symmetry, side: int) -> Alike:
    """A start with exact symmetry, for a cage on a side of the fine mesh. Raises NestingError."""
    coarse = start.coarse
    orbits = orbits_of(coarse, symmetry)
    if orbits is None:
        raise NestingError(
            f"The coarse mesh does not have {symmetry}; give a mesh whose vertices are images of each other, or a "
            "vertex count.",
            code="symmetry.not_found",
        )
    on_curve = start.on_curve
    if on_curve is not None and orbits_of(on_curve, symmetry) is None:
        on_curve = None
    exact = coarse.moved(orbits.symmetrised(coarse.vertices)).validated()
    return Alike(
        start._replace(coarse=exact, on_curve=on_curve),
        orbits,
        Elimination.of_images(orbits, coarse.loop_order.walked(side).successor),
    )


def symmetric_starts(starts: list[Start], symmetry: Symmetry, side: int) -> list[Start]:
    """Those that can be made symmetric. Raises the error of the first one if none can."""
    found: list[Start] = []
    errors: list[NestingError] = []
    for start in starts:
        try:
            found.append(made_alike(start, symmetry, side).start)
        except NestingError as error:
            errors.append(error)
    if not found:
        raise errors[0]
    return found
