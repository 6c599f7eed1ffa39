"""Reinflation as published (Gurditta & Jacobson 2022, section 3.2), with repairs as switches.

For each step of the flow, from the last to the first, a fixed number of descent steps lowers the energy. The fine mesh
may miss its target before the next one is set, and its original position in the end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..contact.base import ContactOutcome, OnStep, no_step
from ..contact.ipc import STIFFENING
from ..contact.pairs import Bodies
from ..energies import Area, CageEnergy, Energy
from ..geometry.arrays import FloatArray
from ..geometry.precision import MOST_ROUNDS
from ..parameters import check_flag, check_part, check_positive
from ..solver.newton import Solver
from .flow import PAPER_DIAGONAL
from .gradient_descent import GradientDescent
from .potential import PaperPotential, PaperWeights

PROGRAM_RANGE = 0.1
"""d̂ of the program, whatever the size of the meshes."""


@dataclass(frozen=True)
class Repairs:
    """Fixes to the paper's program, one by one. A third one is `GradientDescent(refuse_infinite=True)`."""

    parity: bool = False
    """E_cont by exact crossings, self-crossings of the cage included, instead of parity along rays."""
    exact_home: bool = False
    """Increase λ_R after the last target until the fine mesh can move straight to it without contact; then move it."""

    def __post_init__(self) -> None:
        check_flag(self, "parity", "exact_home")


@dataclass(frozen=True)
class PaperContact:
    """The paper's energy, its gradient descent and its loop over the flow's steps.

    Lengths are relative to the bounding-box diagonal of the fine mesh, unless `absolute`.
    """

    solver: Solver = field(default_factory=GradientDescent)
    """Minimises the energy."""
    energy: Energy = field(default_factory=Area)
    """E_cages."""
    d_hat: float = PROGRAM_RANGE / PAPER_DIAGONAL
    """Range of the barrier: in units of the input if `absolute`; by default that of the program on the annulus of
    Table 1."""
    weights: PaperWeights = field(default_factory=PaperWeights)
    """Weights of the terms of the energy."""
    repairs: Repairs = field(default_factory=Repairs)
    """Fixes to apply."""
    absolute: bool = False
    """Whether `d_hat` is a length in units of the input, as in the program."""

    def __post_init__(self) -> None:
        check_positive(self, "d_hat")
        check_flag(self, "absolute")
        check_part(self, "solver", "minimise", "ProjectedNewton()")
        check_part(self, "energy", "at", "Area()")

    def scaled(self, factor: float) -> PaperContact:
        """The same contact for meshes scaled by a factor."""
        return replace(self, d_hat=self.d_hat * factor) if self.absolute else self

    def potential(self, bodies: Bodies, energy: CageEnergy) -> PaperPotential:
        """The energy, which `reinflate` gives one target after the other."""
        return PaperPotential(bodies, energy, self.weights, self.d_hat, exact=self.repairs.parity)

    def reinflate(
        self, bodies: Bodies, x: FloatArray, path: Sequence[FloatArray], *, clearance: float, on_step: OnStep = no_step
    ) -> ContactOutcome:
        """Bring the fine mesh back; see :class:`nestedcages_core.contact.base.Contact`. It has no clearance.

        The linear motion between steps may pass through a contact.
        """
        energy = self.energy.at(bodies.coarse)
        objective = self.potential(bodies, energy)
        iterations = 0
        for place, target in enumerate(path):
            objective.energy, objective.target = energy.after(x[: bodies.m]), target
            solution = self.solver.minimise(objective, x, on_step)
            x = solution.x
            iterations += solution.iterations
            with np.errstate(over="ignore", invalid="ignore"):
                finite = np.isfinite(objective.value(x))
            if not finite:
                reason = f"the energy of flow step {len(path) - 1 - place} is infinite, and so is every step from there"
                return ContactOutcome(x, False, iterations, reason)
        if self.repairs.exact_home:
            objective.ends_at_target = True
            for _ in range(MOST_ROUNDS):
                objective.energy = energy.after(x[: bodies.m])
                if objective.finished(x):
                    x = np.concatenate([x[: bodies.m], path[-1]])
                    on_step(x)
                    return ContactOutcome(x, True, iterations)
                solution = self.solver.minimise(objective, x, on_step)
                x = solution.x
                iterations += solution.iterations
                objective.weights = replace(objective.weights, restoring=STIFFENING * objective.weights.restoring)
        short = np.hypot(*(path[-1] - x[bodies.m :]).T)
        worst = int(short.argmax())
        reached = not bool(short.any())
        reason = f"fine vertex {worst} rests {short[worst]:.1e} bounding-box diagonals short of its target"
        return ContactOutcome(x, reached, iterations, "" if reached else reason)
