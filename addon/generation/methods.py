"""The chosen methods, and the settings of the core that they make.

Settings that are `AUTOMATIC` become what the chosen contact was designed for. Settings that do not apply to any chosen
method are rejected.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from ..core import core
from ..errors import UserError
from .choices import AUTOMATIC, CONTACTS, MERGING, REPAIRS, SETTINGS, Choice


@dataclass(frozen=True)
class Methods:
    """A choice for each of `SETTINGS`, by key, and what else makes a method.

    `repairs`: keys of `REPAIRS`. `tighten`: whether the cage is optimised once the drawing is back. `starts`: number
    of coarse meshes to start from. `fall_back`: whether to start from the outer hull if a coarse mesh fails.
    """

    decimation: str = "ON_CURVE"
    energy: str = "AREA"
    contact: str = AUTOMATIC
    expansion_energy: str = AUTOMATIC
    flow: str = AUTOMATIC
    quadrature: str = AUTOMATIC
    solver: str = AUTOMATIC
    step_filter: str = AUTOMATIC
    broad_phase: str = AUTOMATIC
    repairs: frozenset[str] = frozenset(key for key, _, _ in REPAIRS)
    tighten: bool = True
    starts: int = 2
    fall_back: bool = True

    def with_partners(self) -> Methods:
        """The same with automatic settings replaced by what the contact was designed for."""
        partners = CONTACTS[self.contact].partners
        chosen: dict[str, Any] = {
            name: partners.get(name, setting.automatic[0])
            for name, setting in SETTINGS.items()
            if setting.automatic is not None and getattr(self, name) == AUTOMATIC
        }
        return replace(self, **chosen)

    def check(self) -> None:
        """Raises: UserError for a setting that does not apply to the chosen methods."""
        for name, setting in SETTINGS.items():
            if setting.automatic is not None and getattr(self, name) != AUTOMATIC and not self.has_use_for(name):
                raise UserError(
                    f"'{setting.name}' does not apply to the chosen methods: set it to Automatic, or choose "
                    f"{', '.join(_users(name))}"
                )

    def has_use_for(self, name: str) -> bool:
        """Whether a setting applies to the chosen methods."""
        full = self.with_partners()
        return name not in USED_BY_METHODS or any(name in full._choice(other).uses for other in SETTINGS)

    def part(self, name: str) -> Any:
        """The core's object for one of the settings, none of which is automatic."""
        return self._choice(name).make(self)

    def keeps_loops(self) -> bool:
        """Whether every cage has a loop for each loop of the drawing."""
        return self.decimation not in MERGING

    def expansion(self) -> Any:
        """The core's energy of the cage while the drawing grows back."""
        return self.part("energy" if self.expansion_energy == "SAME" else "expansion_energy")

    def settings(self) -> core.Settings:
        """The core's ``Settings``."""
        chosen = self.with_partners()
        return core.Settings(
            **{name: chosen.part(name) for name in OF_THE_CORE},
            tightening=core.Tightening() if self.tighten else core.Tightening(iterations=0),
            starts=self.starts,
            fallback=core.OuterHull() if self.fall_back else None,
        )

    def _choice(self, name: str) -> Choice:
        return SETTINGS[name].choices[getattr(self, name)]


USED_BY_METHODS = frozenset(
    name for setting in SETTINGS.values() for choice in setting.choices.values() for name in choice.uses
)
"""Settings that apply to some methods only."""

OF_THE_CORE = ("decimation", "energy", "contact", "flow")
"""Settings that are fields of the core's ``Settings``; all others are parts of these."""


def _users(name: str) -> list[str]:
    """Names of the methods that a setting applies to, with their kinds."""
    return [
        f"{setting.name} › {choice.name}"
        for setting in SETTINGS.values()
        for choice in setting.choices.values()
        if name in choice.uses
    ]
