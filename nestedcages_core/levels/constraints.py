"""The constraints that settings ask for; each is imported only when it is."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..errors import Fault, NestingError
from ..geometry.arrays import FloatArray
from ..geometry.group import Symmetry
from ..geometry.mesh import Mesh
from .settings import DEFAULT_CLEARANCE, Settings, type_name
from .units import SolverUnits

if TYPE_CHECKING:
    from ..constraints.base import Constraint
    from ..decimation.importance import Importance


class Asked(NamedTuple):
    """What cages keep, and where vertices matter."""

    constraints: tuple[Constraint, ...]
    importance: Importance | None = None
    notes: tuple[Fault, ...] = ()
    """What was found in the drawing."""

    @property
    def group(self) -> Symmetry | None:
        """The symmetry of the cages."""
        return next((each.group for each in self.constraints if each.group is not None), None)


def constraints_of(settings: Settings, about: Mesh, side: int) -> Asked:
    """What cages around a drawing, or inside it, keep; limits and pins are wishes. Raises NestingError.

    about: the mesh that weights, pins and a symmetry to be found refer to. Discrete facts come first: numbers, then the
    group, whose place may depend on them.
    """
    kept: list[Constraint] = []
    notes: tuple[Fault, ...] = ()
    numbers = None
    if settings.grid is not None or settings.stored is not None:
        from ..constraints.numbers import Numbers

        numbers = Numbers.about(about, settings.grid, type_name(settings.stored))
    if settings.symmetry is not None:
        from ..constraints.symmetric import symmetric

        alike, notes = symmetric(settings.symmetry, about, numbers)
        kept += [] if alike is None else [replace(alike, keeps=side < 0 or settings.loops == "keep")]
    group = kept[0].group if kept else None
    if settings.convex:
        from ..constraints.convex import Convex

        kept.append(Convex(group, 2.0 * (settings.clearance or 0.0), settings.loops != "keep"))
    if numbers is not None:
        kept = [*(each.rounded(numbers) for each in kept), numbers]
    importance = _importance(settings, about, group) if settings.has_priorities else None
    if importance is not None and len(importance.pins):
        from ..constraints.pins import Pins

        clearance = settings.clearance
        kept.append(Pins(importance.pins, DEFAULT_CLEARANCE * about.diagonal if clearance is None else clearance, side))
    if settings.constraints:
        from ..constraints.checked import checked

        kept += [checked(each, about, side, SolverUnits.of(about)) for each in settings.constraints]
    if sum(each.group is not None for each in kept) > 1:
        raise NestingError("Cages have one symmetry at most; leave out the others.", code="setting.conflict")
    if settings.min_edge is not None:
        from ..constraints.edges_and_angles import LeastEdge

        kept.append(LeastEdge(settings.min_edge, must=False).of(about, side))
    if settings.min_angle is not None:
        from ..constraints.edges_and_angles import LeastAngle

        kept.append(LeastAngle(settings.min_angle, must=False))
    return Asked(tuple(kept), importance, notes)


def _importance(settings: Settings, about: Mesh, group: Symmetry | None) -> Importance:
    """Weights, and places that keep a vertex. Raises NestingError if they do not fit the drawing."""
    from ..constraints.pins import pinned_places
    from ..decimation.importance import Importance

    weights: FloatArray | None = None if settings.weights is None else np.asarray(settings.weights, np.float64)
    if weights is not None and len(weights) != len(about.vertices):
        raise NestingError(
            f"There are {len(weights)} weights, but the mesh has {len(about.vertices)} vertices.",
            code="priorities.mismatch",
            given=len(weights),
            available=len(about.vertices),
        )
    return Importance(about, weights, pinned_places(settings.pins, settings.joints, about, group), group)
