"""What a moving cage keeps at every pose: the constraints of the settings, about the drawing as it is there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..constraints.numbers import ROOMS
from ..errors import Fault
from ..geometry.broad_phase import ClosestEdge
from ..geometry.mesh import Mesh
from ..levels import Settings
from ..levels.constraints import constraints_of
from ..levels.plan import Plan


@dataclass(frozen=True, eq=False)
class Promises:
    """The settings of a motion: a symmetry has its place, and pins move with the outline."""

    settings: Settings
    plan: Plan
    """That of the first pose."""
    pins: ClosestEdge
    """(P,) where they are on the edges of the drawing."""
    notes: tuple[Fault, ...] = ()

    @classmethod
    def of(cls, settings: Settings, first: Mesh) -> Promises:
        """The promises about a drawing, from its first pose. Raises NestingError."""
        constraints, importance, notes = constraints_of(settings, first, 1)
        plan = Plan.of(first, constraints, importance)
        close = first.edge_search.closest(np.empty((0, 2)) if importance is None else importance.pins)
        return cls(replace(settings, symmetry=plan.group), plan, close, notes)

    @property
    def room(self) -> float:
        """Length that rounding to a grid may take from a clearance."""
        grid = self.settings.grid
        return 0.0 if grid is None else ROOMS[0] * grid

    def settings_at(self, pose: Mesh) -> Settings:
        """The settings with pins where they are at a pose."""
        if len(self.pins.edge) == 0:
            return self.settings
        places = self.pins.between(pose.vertices, pose.edge_ends)
        return replace(self.settings, pins=places.tolist(), joints=())

    def plan_at(self, pose: Mesh) -> Plan:
        """The plan of a pose. Raises NestingError."""
        constraints, importance, _ = constraints_of(self.settings_at(pose), pose, 1)
        return Plan.of(pose, constraints, importance)

    def of_next_level(self, cage: Mesh) -> Settings:
        """The settings of the level around a cage of the first pose: weights and pins go to its closest vertices."""
        settings, first = self.settings, self.plan.fine
        if settings.weights is not None:
            given = np.asarray(settings.weights, np.float64)
            weights = first.edge_search.closest(cage.vertices).between(given, given[first.successor])
            settings = replace(settings, weights=weights if weights.any() else None)
        places = self.pins.between(first.vertices, first.edge_ends)
        nearest = [int(np.hypot(*(cage.vertices - place).T).argmin()) for place in places]
        return replace(settings, pins=tuple(dict.fromkeys(nearest)), joints=())
