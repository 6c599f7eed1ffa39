"""The interface of flows, their result, and obstacles to them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

from ..errors import Fault, FlowError
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..progress import Tick, no_tick


@dataclass(frozen=True)
class Obstacle:
    """Why the fine mesh is not inside the coarse one, as parts of a sentence; the place is in units of the mesh."""

    cause: str
    place: tuple[float, float] | None = None
    remedy: str = "change the coarse mesh there or let it be generated"

    code: str = "flow.stuck"

    @classmethod
    def at(cls, place: FloatArray, cause: str, *parts: str) -> Obstacle:
        """An obstacle at a place (2,)."""
        return cls(cause, (float(place[0]), float(place[1])), *parts)

    def fault(self, scale: float = 1.0, shift: tuple[float, float] = (0.0, 0.0)) -> Fault:
        """The whole sentence, with the place converted to scale · place + shift."""
        if self.place is None:
            return Fault(f"{self.cause}; {self.remedy}.", self.code)
        x, y = (scale * coordinate + offset for coordinate, offset in zip(self.place, shift, strict=True))
        return Fault(f"{self.cause} near ({x:.6g}, {y:.6g}); {self.remedy}.", self.code, place=(x, y))


@dataclass(frozen=True, eq=False)
class FlowResult:
    """The path of the fine mesh into the coarse one."""

    steps: FloatArray = field(repr=False)
    """(J + 1, n, 2) positions; step 0 is the fine mesh, step J is certified inside unless there is an obstacle."""
    iterations: int
    """Iterations of all stages, rejected steps included."""
    stage: str
    """The stage that succeeded, or the one that failed."""
    obstacle: Obstacle | None = None
    """What blocks the last step; None if it is inside."""


class FlowMethod(Protocol):
    """Brings the fine mesh strictly inside the coarse one, which stays in place."""

    def run(self, fine: Mesh, coarse: Mesh, *, tick: Tick = no_tick) -> FlowResult:
        """Move the fine mesh step by step to a certified position inside the coarse one.

        Parameters
        ----------
        fine, coarse : Mesh
            Both in units of the bounding-box diagonal of the fine mesh.
        tick : callable
            Called with the fraction done while it works.

        Returns
        -------
        FlowResult

        Raises
        ------
        FlowError
            With the place and the cause, and the FlowResult so far as ``partial``.
        """


def stuck(result: FlowResult) -> FlowError:
    """The error of a flow that did not get inside."""
    assert result.obstacle is not None
    return FlowError(result.obstacle.fault(), partial=result)
