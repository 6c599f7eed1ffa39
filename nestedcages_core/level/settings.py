"""The methods of a level, each an object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ..contact import Contact
from ..decimation import Decimation, LineCycles, OuterHull
from ..energies import Area, Energy
from ..errors import NestedCagesError
from ..flow import FlowMethod, TwoSidedFlow
from ..parameters import has_method
from ..tightening import Tightening

DEFAULT_CLEARANCE = 1e-5
"""Clearance when none is given, as a fraction of the bounding-box diagonal of the fine mesh."""

METHODS = {
    "decimation": ("decimate", "OuterHull()"),
    "fallback": ("decimate", "OuterHull()"),
    "flow": ("run", "TwoSidedFlow()"),
    "energy": ("at", "Area()"),
    "tightening": ("run", "Tightening()"),
}
"""The method that each choice must have, and an example."""


@dataclass(frozen=True)
class LevelSettings:
    """The settings that the builder of a level works with; `Settings` adds what runs and needs are told."""

    clearance: float | None = None
    """Smallest allowed distance between cage and fine mesh, in the input's units. None: 1e-5 of the fine mesh's
    bounding-box diagonal, reduced where gaps of the fine mesh are too narrow for it."""
    decimation: Decimation = field(default_factory=LineCycles)
    """Turns a vertex count into a coarse mesh."""
    fallback: Decimation | None = field(default_factory=OuterHull)
    """Decimation to start from if the flow or the reinflation fails; None: raise an error (docs/ablation.md: the hull
    as fallback)."""
    flow: FlowMethod = field(default_factory=TwoSidedFlow)
    """Brings the fine mesh inside the coarse one."""
    energy: Energy = field(default_factory=Area)
    """What the cage minimises during tightening."""
    contact: Contact | Sequence[Contact] | None = None
    """Resolves contact during reinflation; of several, each starts over where the one before is blocked. None:
    sequential QPs; then IPC, where the coarse mesh is the user's own."""
    tightening: Tightening = field(default_factory=Tightening)
    """Brings the cage to its optimum once the fine mesh is back."""

    def __post_init__(self) -> None:
        if self.clearance is not None and not is_length(self.clearance):
            raise NestedCagesError(
                f"The clearance must be a finite length of at least 0, not {self.clearance!r}; leave it out for the "
                f"default.",
                code="setting.invalid",
            )
        for name, (method, example) in METHODS.items():
            chosen = getattr(self, name)
            if not has_method(chosen, method) and not (chosen is None and name == "fallback"):
                what = name.replace("_", " ")
                raise NestedCagesError(
                    f"The {what} must be an object such as {example}, not {chosen!r}.", code="setting.invalid"
                )
        contact: object = self.contact
        several = contact if isinstance(contact, Sequence) and not isinstance(contact, str) else [contact]
        if contact is not None and not (several and all(has_method(each, "reinflate") for each in several)):
            raise NestedCagesError(
                f"The contact must be an object such as IPC(), or several of them in a list, not {contact!r}; leave it "
                "out for the default.",
                code="setting.invalid",
            )


def is_length(value: object) -> bool:
    """Whether a value is a finite number of at least 0."""
    try:
        return isinstance(value, int | float | np.number) and 0.0 <= float(value) < np.inf
    except OverflowError:
        return False
