"""One step: the cage of a drawing after the drawing has moved."""

from __future__ import annotations

import numpy as np

from ..geometry.mesh import Mesh
from ..hierarchy import Settings
from ..hierarchy.settings import type_name
from ..level.steps import as_stored
from ..level.units import SolverUnits
from ..needs.grid.need import StoredNumbers
from ..verification import verify
from .following import Follower


def followed(cage: Mesh, before: Mesh, after: Mesh, clearance: float, settings: Settings | None = None) -> Mesh | None:
    """The cage of a pose moved to another pose and tightened there; None if the motion is blocked.

    before, after: the same topology; cage: one of ``before``; clearance: a length, in the input's units. The
    result is certified by `verify`, on the numbers of ``settings.stored``. To certify the instants in between too, see
    `animated_cages`.
    """
    settings = settings if settings is not None else Settings()
    stored, largest = type_name(settings.stored), float(np.abs(after.vertices).max())
    units = SolverUnits.of(after, 0.0 if stored is None else StoredNumbers(stored, largest).room)
    follower = Follower.of(cage, before, units, clearance, settings)
    cages = follower.next(*(units.points(mesh.vertices) for mesh in (cage, before, after)))
    if cages is None:
        return None
    moved = cage.moved(as_stored(units.to_input(cages[-1]), stored))
    return moved if verify(moved, after, clearance).holds else None
