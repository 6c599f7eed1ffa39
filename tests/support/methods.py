"""A user's own methods: they work as those of the package, and then do something wrong."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from nestedcages_core import Area, Constraint, Fault, FlowResult, Mesh, SequentialQP, Tightening, TwoSidedFlow

Further = Callable[[np.ndarray], list[np.ndarray]]


def nothing(_: np.ndarray) -> list[np.ndarray]:
    return []


@dataclass(frozen=True)
class Continued(Tightening):
    """A tightening that takes further steps at its end, and may be told another clearance; at first it does neither.

    It notes the clearances that it is asked for.
    """

    further: Further = nothing
    share: float = 1.0
    first: int = 0
    """Runs that go well before."""
    asked: list[float] = field(default_factory=list, compare=False)

    def run(
        self, bodies: Any, cage: np.ndarray, fine: np.ndarray, *, clearance: float, energy: Any, on_step: Any
    ) -> Any:
        self.asked.append(clearance)
        works = len(self.asked) <= self.first
        share = 1.0 if works else self.share
        steps = [cage]

        def noting(step: np.ndarray) -> None:
            steps.append(step)
            on_step(step)

        outcome = super().run(bodies, cage, fine, clearance=share * clearance, energy=energy, on_step=noting)
        for step in [] if works else self.further(steps[-1]):
            on_step(step)
        return outcome


@dataclass(frozen=True)
class Detouring(Tightening):
    """A tightening that turns the cage over and back again before it does its work."""

    def run(self, bodies: Any, cage: np.ndarray, fine: np.ndarray, *, on_step: Any, **options: Any) -> Any:
        on_step(cage * np.array([-1.0, 1.0]))
        on_step(cage)
        return super().run(bodies, cage, fine, on_step=on_step, **options)


@dataclass(frozen=True)
class Elsewhere(SequentialQP):
    """A contact whose last step is changed, and that says that it reached its target."""

    change: Callable[[np.ndarray, int], np.ndarray] = lambda x, m: x

    def reinflate(self, bodies: Any, x: np.ndarray, path: Any, *, on_step: Any, **options: Any) -> Any:
        outcome = super().reinflate(bodies, x, path, on_step=on_step, **options)
        ended = self.change(outcome.x.copy(), bodies.m)
        on_step(ended)
        return outcome._replace(x=ended, reached_target=True)


@dataclass(frozen=True)
class GivingUp(SequentialQP):
    """A contact that takes one step and stops."""

    def reinflate(self, bodies: Any, x: np.ndarray, path: Any, **options: Any) -> Any:
        outcome = super().reinflate(bodies, x, path, **options)
        return outcome._replace(reached_target=False, reason="it had enough")


@dataclass(frozen=True)
class Pretending(TwoSidedFlow):
    """A flow with a change to its steps."""

    change: Callable[[np.ndarray], np.ndarray] = lambda steps: steps

    def run(self, fine: Mesh, coarse: Mesh, **options: Any) -> Any:
        found = super().run(fine, coarse, **options)
        return FlowResult(self.change(found.steps), found.iterations, found.stage)


@dataclass(frozen=True)
class Offering:
    """A decimation that offers given coarse meshes."""

    meshes: tuple[Mesh, ...]

    def decimate(self, fine: Mesh, count: Any, *, clearance: float = 0.0) -> Mesh:
        return self.meshes[0]


@dataclass(frozen=True)
class Misleading(Area):
    """An area whose derivatives are wrong."""

    factor: float = -1.0

    def gradient(self, vertices: np.ndarray, successor: np.ndarray) -> np.ndarray:
        return self.factor * super().gradient(vertices, successor)


@dataclass(frozen=True)
class Refusing(Constraint):
    """A constraint that every cage misses."""

    must: bool = True

    def fault(self, cage: Mesh, fine: Mesh) -> Fault:
        return Fault("No cage is good enough.", "constraint.missed")


class Moved(Constraint):
    """A constraint that moves a vertex of each cage a little, after what makes cages symmetric."""

    def snapped(self, coarse: Mesh, steps: np.ndarray, side: int) -> np.ndarray:
        moved = steps.copy()
        moved[1:, 0] *= 1.0 + 1e-10
        return moved
