"""R, which pulls the fine mesh to its next target."""

from __future__ import annotations

from dataclasses import dataclass

from ..geometry.arrays import FloatArray
from ..geometry.vectors import inner


@dataclass(frozen=True, eq=False)
class Restoring:
    """R = ½ Σ w_i |f_i - target_i|² (Gurditta & Jacobson 2022, section 3.2), weighted per boundary length."""

    target: FloatArray
    """(n, 2) positions that the fine vertices are pulled to."""
    weight: FloatArray
    """(n,) boundary length of each vertex."""

    def value(self, fine: FloatArray) -> float:
        """R at the fine vertices (n, 2), a length³."""
        away = fine - self.target
        return 0.5 * inner(self.weight, (away * away).sum(axis=1))

    def gradient(self, fine: FloatArray) -> FloatArray:
        """(n, 2). The Hessian is diagonal, with ``weight`` for both coordinates of a vertex."""
        return self.weight[:, None] * (fine - self.target)
