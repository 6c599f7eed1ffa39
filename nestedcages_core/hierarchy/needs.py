"""The needs that settings ask for; each is imported only when it is."""

from __future__ import annotations

from dataclasses import replace

from ..errors import Fault
from ..geometry.group import Symmetry, mirror_axis
from ..geometry.mesh import Mesh
from ..level.plan import Need
from .settings import Settings, type_name


def _preferring_symmetry(settings: Settings, about: Mesh) -> Settings:
    """The settings with a decimation that takes the mirror of a drawing where that costs little."""
    preferring = getattr(settings.decimation, "preferring", None)
    axis = None if preferring is None else mirror_axis(about)
    if axis is None or preferring is None:
        return settings
    from ..needs.symmetry import Mirror

    point, direction = (tuple(each.tolist()) for each in axis)
    return replace(settings, decimation=preferring(Mirror(point, direction)))


def needs_of(settings: Settings, about: Mesh) -> tuple[Settings, list[Need], tuple[Fault, ...]]:
    """The needs of a run, methods that serve them, and notes. Raises NestingError for methods that cannot.

    about: the mesh that weights, pins and a symmetry to be found refer to. Discrete facts come first: numbers, then the
    group, whose place may depend on them.
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
    elif not (settings.has_priorities or settings.convex or settings.constraints) and numbers is None:
        settings = _preferring_symmetry(settings, about)
    if settings.has_priorities:
        from ..needs.priorities.need import Priorities

        places, limits = (settings.pins, settings.joints), (settings.min_edge, settings.min_angle)
        priorities = Priorities.of(about, group, settings.weights, places, limits)
        settings = priorities.applied(settings)
        needs.append(priorities)
    if settings.constraints:
        obeying = getattr(settings.decimation, "obeying", None)
        if obeying is not None:
            settings = replace(settings, decimation=obeying(tuple(settings.constraints)))
    if group is not None:
        needs.append(Symmetric(group))
    if settings.convex:
        from ..needs.convex.need import Convex

        needs.append(Convex())
    if numbers is not None:
        needs.append(numbers)
    return settings, needs, remarks
