"""R, the pull on the fine mesh towards its next step on the way home."""

from __future__ import annotations

from dataclasses import dataclass

from ..geometry.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Restoring:
    """R = ½ Σ w_i |f_i - target_i|² (Gurditta & Jacobson 2022, section 3.2), weighted per length of boundary."""

    target: FloatArray
    """(n, 2) positions that the fine vertices are pulled to."""
    weight: FloatArray
    """(n,) boundary length that each vertex stands for."""

    def value(self, fine: FloatArray) -> float:
        """R at the fine vertices (n, 2); unit: length³."""
        away = fine - self.target
        return 0.5 * float(self.weight @ (away * away).sum(axis=1))

    def gradient(self, fine: FloatArray) -> FloatArray:
        """(n, 2); the Hessian is diagonal, with ``weight`` on both coordinates of each vertex."""
        return self.weight[:, None] * (fine - self.target)
