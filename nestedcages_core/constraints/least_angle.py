"""A least angle between neighbouring edges of the cage."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..errors import Fault, invalid_setting, note
from ..geometry.mesh import Mesh
from .angles import BoundAngle, angles_of
from .base import Bound, Constraint, Units


@dataclass(frozen=True)
class LeastAngle(Constraint):
    """No angle between neighbouring edges is sharper than this, inside or outside."""

    degrees: float
    """Above 0 and below 60, which no triangle exceeds."""
    must: bool = field(default=True, kw_only=True)

    def __post_init__(self) -> None:
        if not isinstance(self.degrees, int | float | np.number) or not 0.0 < float(self.degrees) < 60.0:
            raise invalid_setting(f"min_angle must be above 0 and below 60 degrees, not {self.degrees!r}.")

    @property
    def turn_limits(self) -> tuple[float, float]:
        """The angle."""
        return 0.0, self.degrees

    def bound(self, coarse: Mesh, fine: Mesh, units: Units) -> Bound:
        """Rows of three vertices."""
        return BoundAngle.of(coarse, self.degrees)

    def fault(self, cage: Mesh, fine: Mesh) -> Fault | None:
        """The sharpest angle, to round-off."""
        angles = angles_of(cage)
        k = int(np.argmin(angles))
        if angles[k] >= self.degrees:
            return None
        wanted, given = self.degrees, float(angles[k])
        if not self.must:
            return note("note.angle", wanted=wanted, given=given)
        x, y = cage.vertices[k].tolist()
        return Fault(
            f"The angle at ({x:.6g}, {y:.6g}) has {given:.4g}°; at least {wanted:.4g}° is asked for: ask for less, or "
            "for another number of vertices.",
            "angle.sharp",
            wanted=wanted,
            given=given,
            place=(x, y),
        )
