"""The available methods: name, description, and the object of the core; and those that are chosen, as its settings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from ..core import core


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
class Methods:
    """`decimation`, `energy`: keys of `DECIMATIONS` and `ENERGIES`. `as_published`: whether the drawing shrinks and
    grows back as in Gurditta & Jacobson (2022), with repairs. If a coarse mesh fails, one around the drawing is next.
    """

    decimation: str = "ON_CURVE"
    energy: str = "AREA"
    as_published: bool = False

    def settings(self) -> core.Settings:
        """The core's ``Settings``."""
        settings, energy = core.Settings(), _made(ENERGIES, self.energy)
        outside = core.LineCycles(on_curve=False)
        if self.as_published:
            settings = core.AUGMENTED_2022_REPAIRED
            contact: Any = settings.contact
            settings = replace(settings, contact=replace(contact, energy=energy))
        return replace(
            settings,
            decimation=outside if self.decimation == "OUTSIDE" else _made(DECIMATIONS, self.decimation),
            energy=energy,
            fallback=outside,
        )
