"""What the user chooses: what cages must be apart from tight, how they are made, and the core's settings of that."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, NamedTuple

import numpy as np
from bpy.types import Scene

from ..core import core
from ..errors import FloatArray
from .levels import Level, lengths, parse_levels

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


class Choice(NamedTuple):
    """One method. `kind`: the core's class, if its name is not the key's words together."""

    name: str
    description: str
    kind: str = ""


DECIMATIONS: Mapping[str, Choice] = {
    "ON_CURVE": Choice(
        "On the Curve",
        "Coarse meshes start on the drawing, which shrinks into them and pushes them out while it grows back",
        "LineCycles",
    ),
    "OUTSIDE": Choice(
        "Outside", "Coarse meshes start around the drawing, which need not shrink: the tightest cages", "LineCycles"
    ),
    "ARC_LENGTH": Choice(
        "Even Resampling", "Coarse vertices lie on the drawing at equal distances along it, on every level"
    ),
}

ENERGIES: Mapping[str, Choice] = {
    "AREA": Choice("Least Area", "Area at a local minimum: the tightest choice"),
    "SHAPE_KEEPING": Choice(
        "Keep Shape", "Tight, but keeps straight lines, horizontal and vertical edges, and symmetry"
    ),
    "INITIAL_DISPLACEMENT": Choice("Least Motion", "As close to the coarse mesh as possible"),
    "STEP_DISPLACEMENT": Choice("Least Step", "Moves as little as possible from each step to the next"),
    "BOUNDARY_ARAP": Choice(
        "Rigid Outline", "Bends and stretches the outline of the coarse mesh as little as possible", "BoundaryARAP"
    ),
    "INTERIOR_ARAP": Choice(
        "Rigid Inside", "Bends and stretches the inside of the coarse mesh as little as possible", "InteriorARAP"
    ),
}


def items(choices: Mapping[str, Choice]) -> list[tuple[str, str, str]]:
    """Choices as Blender lists them."""
    return [(key, choice.name, choice.description) for key, choice in choices.items()]


def _made(choices: Mapping[str, Choice], key: str) -> Any:
    """The core's object for a choice."""
    return getattr(core, choices[key].kind or key.title().replace("_", ""))()


@dataclass(frozen=True)
class Places:
    """Where it matters: weights (n,) of vertices, numbers of those to pin, ends of bones (k, 2), and notes."""

    weights: tuple[float, ...] = ()
    pins: tuple[int, ...] = ()
    joints: tuple[tuple[float, float], ...] = ()
    notes: tuple[core.Fault, ...] = ()


@dataclass(frozen=True)
class Options:
    """`levels`: vertex counts, shares of the drawing's vertices, distances and excesses, or `OWN`, finest first.
    `clearance`: a length of the scene, as all lengths are; if it is 0, a share of the drawing's diagonal; if both are,
    automatic. `show_flow`: whether the drawing shrinks further in the animation than it has to. `as_published`: whether
    the drawing shrinks and grows back as in Gurditta & Jacobson (2022), with repairs. Angles are in radians.
    `symmetry`, `directions`, `decimation`, `energy`: keys of `SYMMETRIES`, `DIRECTIONS`, `DECIMATIONS`, `ENERGIES`.
    """

    levels: tuple[Level, ...] = ()
    clearance: float = 0.0
    clearance_share: float = 0.0
    inside: bool = False
    show_flow: bool = False
    convex: bool = False
    grid: float = 0.0
    loops: Literal["auto", "keep", "one"] = "auto"
    symmetry: str = NONE
    symmetry_order: int = 2
    min_edge: float = 0.0
    min_angle: float = 0.0
    directions: str = NONE
    decimation: str = "ON_CURVE"
    energy: str = "AREA"
    as_published: bool = False

    @classmethod
    def of(cls, values: Any, scene: Scene) -> Options:
        """The options of settings. Raises: UserError if the levels cannot be read."""
        given = {field.name: getattr(values, field.name) for field in fields(cls)}
        given["levels"] = () if values.use_selected_as_levels else parse_levels(values.levels, lengths(scene))
        given["clearance_share"] *= 0.01
        return cls(**given)

    def methods(self) -> core.Settings:
        """The core's settings of the methods. If a coarse mesh fails, one around the drawing is next."""
        settings, energy = core.Settings(), _made(ENERGIES, self.energy)
        outside = core.LineCycles(on_curve=False)
        if self.as_published:
            settings = core.AUGMENTED_2022_REPAIRED
            contact: Any = settings.contact
            settings = replace(settings, contact=replace(contact, energy=energy))
        decimation = outside if self.decimation == "OUTSIDE" else _made(DECIMATIONS, self.decimation)
        return replace(settings, decimation=decimation, energy=energy, fallback=outside)

    def settings(self, fine: core.Mesh, scale: float, places: Places) -> core.Settings:
        """The core's settings for a drawing, without the clearance. Raises: NestedCagesError.

        scale: the scene's length of the drawing's unit.
        """
        return replace(
            self.methods(),
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

    def kinds(self, places: Places = Places()) -> list[str]:
        """What cages must be apart from tight, in words."""
        names = {
            "convex": self.convex,
            "on a grid": self.grid > 0.0,
            "symmetric": self.symmetry != NONE,
            "merged": self.loops == ONE,
            "weighted": bool(places.weights),
            "pinned": bool(places.pins or places.joints),
            "of few directions": self.directions != NONE,
            "limited in edges or angles": self.min_edge > 0.0 or self.min_angle > 0.0,
        }
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
