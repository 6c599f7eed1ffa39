"""The methods of a level, each an object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ..contact import Contact
from ..decimation import Decimation, LineCycles
from ..energies import Area, Energy
from ..errors import NestedCagesError
from ..flow import FlowMethod, TwoSidedFlow
from ..parameters import has_method
from ..tightening import Tightening

DEFAULT_CLEARANCE = 1e-5
"""Clearance when none is given, as a fraction of the bounding-box diagonal of the fine mesh."""

METHODS = {
    "decimation": ("decimate", "LineCycles()"),
    "fallback": ("decimate", "LineCycles()"),
    "flow": ("run", "TwoSidedFlow()"),
    "energy": ("at", "Area()"),
    "tightening": ("run", "Tightening()"),
}
"""The method that each choice must have, and an example."""


@dataclass(frozen=True)
class LevelSettings:
    """The settings that the builder of a level works with. `Settings` describes them, and adds what runs are told."""

    clearance: float | None = None
    decimation: Decimation = field(default_factory=LineCycles)
    fallback: Decimation | None = field(default_factory=lambda: LineCycles(on_curve=False))
    flow: FlowMethod = field(default_factory=TwoSidedFlow)
    energy: Energy = field(default_factory=Area)
    contact: Contact | Sequence[Contact] | None = None
    tightening: Tightening = field(default_factory=Tightening)

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
