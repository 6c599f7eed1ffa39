"""One step: the cage of a drawing after the drawing has moved."""

from __future__ import annotations

from ..geometry.mesh import Mesh
from ..hierarchy import Settings
from ..level.units import SolverUnits
from ..verification import verify
from .following import Follower
from .promises import Promises


def followed(cage: Mesh, before: Mesh, after: Mesh, clearance: float, settings: Settings | None = None) -> Mesh | None:
    """The cage of a pose moved to another pose and tightened there; None if the motion is blocked.

    before, after: the same topology; cage: one of ``before``; clearance: a length, in the input's units. The
    result is certified by `verify`, on the numbers of ``settings.stored``. To certify the instants in between too, see
    `animated_cages`.
    """
    promises = Promises.of(settings if settings is not None else Settings(), after)
    units = SolverUnits.of(after, 0.0 if promises.plan.numbers is None else promises.plan.numbers.room)
    follower = Follower.of(cage, before, units, clearance, promises)
    cages = follower.next(*(units.points(mesh.vertices) for mesh in (cage, before, after)))
    if cages is None:
        return None
    moved = cage.moved(follower.stored(cages[-1]))
    return moved if verify(moved, after, clearance).holds else None
