"""What cages must be apart from tight: on a grid, convex, symmetric, finer where it matters."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from ..core import core
from ..errors import FloatArray

AUTO, KEEP, ONE = "auto", "keep", "one"
LOOPS = (
    (AUTO, "As Needed", "Holes are filled and parts share a loop where that is tighter with few vertices"),
    (KEEP, "All", "Every part and hole has a loop of its own, with at least three vertices"),
    (ONE, "One", "A silhouette: one loop around everything"),
)
NONE, FOUND, MIRROR_X, MIRROR_Y, ROTATION = "NONE", "FOUND", "MIRROR_X", "MIRROR_Y", "ROTATION"
SYMMETRIES = (
    (NONE, "None", "Both sides may differ"),
    (FOUND, "Found", "The mirror that the drawing has, or else its rotation, detected automatically"),
    (
        MIRROR_X,
        "Mirror X",
        "Left and right alike, across the y axis of the object or, if that is not there, the middle",
    ),
    (
        MIRROR_Y,
        "Mirror Y",
        "Top and bottom alike, across the x axis of the object or, if that is not there, the middle",
    ),
    (ROTATION, "Rotation", "All sectors alike, around the object's origin or, if that is not there, the middle"),
)
AXES, TRANSIT = "AXES", "TRANSIT"
DIRECTIONS = (
    (NONE, "Any", "Edges have any direction"),
    (AXES, "Along Axes", "Edges are horizontal and vertical, as in tiles and pixel art"),
    (TRANSIT, "Along Axes and Diagonals", "Edges are horizontal, vertical or diagonal, as in transit maps"),
)
# Angles of the directions in degrees, from the horizontal of the drawing.
DEGREES = {AXES: (0.0, 90.0), TRANSIT: (0.0, 45.0, 90.0, 135.0)}
# Distance from the middle of a drawing, as a fraction of its size, at which the object's origin counts as the middle.
CENTRED = 1e-3


@dataclass(frozen=True)
class Places:
    """Where it matters: weights (n,) of vertices, numbers of those to pin, ends of bones (k, 2), and notes."""

    weights: tuple[float, ...] = ()
    pins: tuple[int, ...] = ()
    joints: tuple[tuple[float, float], ...] = ()
    notes: tuple[core.Fault, ...] = ()


@dataclass(frozen=True)
class Rules:
    """Lengths are those of the scene, angles in radians; 0 is none. `symmetry`: a key of `SYMMETRIES`."""

    convex: bool = False
    grid: float = 0.0
    loops: Literal["auto", "keep", "one"] = "auto"
    symmetry: str = NONE
    symmetry_order: int = 2
    min_edge: float = 0.0
    min_angle: float = 0.0
    directions: str = NONE

    def settings(self, settings: core.Settings, fine: core.Mesh, scale: float, places: Places) -> core.Settings:
        """The core's settings with these rules for a drawing. Raises: NestedCagesError.

        scale: the scene's length of the drawing's unit.
        """
        return replace(
            settings,
            convex=self.convex,
            grid=self.grid / scale or None,
            loops=self.loops,
            symmetry=self._symmetry(fine),
            weights=places.weights or None,
            pins=places.pins,
            joints=places.joints,
            min_edge=self.min_edge / scale or None,
            min_angle=float(np.degrees(self.min_angle)) or None,
            constraints=() if self.directions == NONE else (core.AxisAligned(DEGREES[self.directions]),),
        )

    def kinds(self, places: Places | None = None) -> list[str]:
        """What cages are by these rules, in words."""
        names = {"convex": self.convex, "on a grid": self.grid > 0.0, "symmetric": self.symmetry != NONE}
        names |= {"merged": self.loops == ONE}
        if places is not None:
            names |= {"weighted": bool(places.weights), "pinned": bool(places.pins or places.joints)}
        names |= {"of few directions": self.directions != NONE}
        names |= {"limited in edges or angles": self.min_edge > 0.0 or self.min_angle > 0.0}
        return [name for name, holds in names.items() if holds]

    def _symmetry(self, fine: core.Mesh) -> Any:
        if self.symmetry == NONE:
            return None
        if self.symmetry == FOUND:
            return core.DetectSymmetry()
        x, y = _middle(fine)
        if self.symmetry == ROTATION:
            return core.Rotation((x, y), self.symmetry_order)
        return core.Mirror((x, y), (0.0, 1.0) if self.symmetry == MIRROR_X else (1.0, 0.0))


def _middle(fine: core.Mesh) -> FloatArray:
    """The middle of a drawing (2,), or in each direction the object's origin where that is as good."""
    middle: FloatArray = 0.5 * (fine.vertices.min(axis=0) + fine.vertices.max(axis=0))
    return np.where(np.abs(middle) <= CENTRED * fine.diagonal, 0.0, middle)
