"""The needs and constraints that settings ask for; each is imported only when it is."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ..errors import Fault
from ..geometry.group import Symmetry, mirror_axis
from ..geometry.mesh import Mesh
from ..level.plan import Need
from .settings import Settings, type_name

if TYPE_CHECKING:
    from ..constraints.base import Constraint


def _preferring_symmetry(settings: Settings, about: Mesh) -> Settings:
    """The settings with a decimation that takes the mirror of a drawing where that costs little."""
    preferring = getattr(settings.decimation, "preferring", None)
    axis = None if preferring is None else mirror_axis(about)
    if axis is None or preferring is None:
        return settings
    from ..geometry.symmetry import Mirror

    point, direction = (tuple(each.tolist()) for each in axis)
    return replace(settings, decimation=preferring(Mirror(point, direction)))


def constraints_of(settings: Settings, about: Mesh, side: int) -> tuple[Constraint, ...]:
    """What cages around a drawing, or inside it, keep: limits are wishes. Raises NestingError."""
    constraints = list(settings.constraints)
    if settings.min_edge is not None:
        from ..constraints.least_edge import LeastEdge

        constraints.append(LeastEdge(settings.min_edge, must=False))
    if settings.min_angle is not None:
        from ..constraints.least_angle import LeastAngle

        constraints.append(LeastAngle(settings.min_angle, must=False))
    return tuple(constraint.of(about, side) for constraint in constraints)


def needs_of(
    settings: Settings, about: Mesh, constraints: tuple[Constraint, ...] = ()
) -> tuple[Settings, list[Need], tuple[Fault, ...]]:
    """The needs of a run, methods that serve them, and notes. Raises NestingError for methods that cannot.

    about: the mesh that weights, pins and a symmetry to be found refer to; constraints: those that lines keep too.
    Discrete facts come first: numbers, then the group, whose place may depend on them.
    """
    if settings.convex:
        from ..needs.convex.need import around_hulls

        settings = around_hulls(settings)
    needs: list[Need] = []
    group: Symmetry | None = None
    remarks: tuple[Fault, ...] = ()
    numbers = None
    if settings.grid is not None or settings.stored is not None:
        from ..needs.grid.need import OnNumbers

        numbers = OnNumbers.of(about, settings.grid, type_name(settings.stored))
    if settings.symmetry is not None:
        from ..needs.symmetry.need import Symmetric, found_for, keeping, on_lattice

        group, remarks = found_for(settings.symmetry, about)
        if group is not None and settings.grid is not None and numbers is not None:
            group, moved = on_lattice(group, numbers.numbers, about)
            remarks += moved
        if group is not None:
            settings = keeping(settings, group)
    elif not (settings.has_priorities or settings.convex or constraints) and numbers is None:
        settings = _preferring_symmetry(settings, about)
    if settings.has_priorities:
        from ..needs.priorities.need import Priorities

        priorities = Priorities.of(about, group, settings.weights, (settings.pins, settings.joints))
        settings = priorities.applied(settings)
        needs.append(priorities)
    obeying = getattr(settings.decimation, "obeying", None)
    if constraints and obeying is not None:
        settings = replace(settings, decimation=obeying(constraints))
    if group is not None:
        needs.append(Symmetric(group))
    if settings.convex:
        from ..needs.convex.need import Convex

        needs.append(Convex())
    if numbers is not None:
        needs.append(numbers)
    return settings, needs, remarks
