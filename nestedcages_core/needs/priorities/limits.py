"""Penalties for edges that are too short and angles that are too sharp; zero where there are none."""

from __future__ import annotations

from math import radians
from typing import Any, cast

import numpy as np

from ...energies.choices.element_energy import BoundElementEnergy, Corners, ElementEnergy
from ...geometry.mesh import Mesh

LENGTH_MARGIN = 0.05
"""Fraction added to the least length, since penalties compete with the area."""

LENGTH_STIFFNESS = 4.0
"""Stiffness of a short edge times its least length: the pull of the area, at most a few hundredths of the diagonal in
units of it, uses up less than the margin."""

ANGLE_MARGIN = 3.0
"""Degrees added to the least angle, for the same reason."""

ANGLE_STIFFNESS = 20.0
"""Stiffness of a sharp angle in squared mean edge lengths, for the same reason."""


def short_edges(coarse: Mesh, least: float, pull: float = 1.0) -> BoundElementEnergy:
    """½ k Σ max(0, l - |b - a|)² over the edges a → b, with l slightly above the least length.

    pull: how often the pull of the area is multiplied, where it is weighted.
    """
    length = (1.0 + LENGTH_MARGIN) * least
    stiffness = LENGTH_STIFFNESS * pull / length

    def penalty(now: Corners, rest: Corners) -> Any:
        short = np.maximum(length - (now[1] - now[0]).length(), 0.0)
        return 0.5 * stiffness * short * short

    return ElementEnergy.per_edge(penalty).at(coarse)


def sharp_angles(coarse: Mesh, least: float, pull: float = 1.0) -> BoundElementEnergy:
    """½ k Σ max(0, β - α)² over the angles α between edges, with β slightly above the least angle.

    least: an angle in degrees, measured inside or outside, whichever is smaller. pull: as for short edges.
    """
    angle = radians(least + ANGLE_MARGIN)
    stiffness = ANGLE_STIFFNESS * pull * float(coarse.edge_lengths.mean()) ** 2

    def penalty(now: Corners, rest: Corners) -> Any:
        before, after = now[0] - now[1], now[2] - now[1]
        turn, along = cast(Any, before.cross(after)), cast(Any, before.dot(after))
        sharp = np.maximum(angle - np.arctan2(np.abs(turn), along), 0.0)
        return 0.5 * stiffness * sharp * sharp

    return ElementEnergy.per_turn(penalty).at(coarse)
