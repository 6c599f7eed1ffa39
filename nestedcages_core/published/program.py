"""The paper's method as settings, and its program as a whole: from a fine and a coarse mesh to its last cage.

`nested_cages` with `AUGMENTED_2022` ends with an error, since the fine mesh never quite returns; `as_published` gives
the cage that the program shows all the same, uncertified. The settings have no fallback and no tightening.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

from ..contact.pairs import Bodies
from ..geometry.arrays import FloatArray
from ..geometry.mesh import Mesh
from ..levels import Settings
from ..tightening import Tightening
from .contact import PROGRAM_RANGE, PaperContact, Repairs
from .flow import PROGRAM_STEP, PaperFlow
from .gradient_descent import GradientDescent

FLOW, CONTACT = PaperFlow(step=PROGRAM_STEP, absolute=True), PaperContact(d_hat=PROGRAM_RANGE, absolute=True)
"""The parts of the program, with its absolute lengths."""

AUGMENTED_2022 = Settings(fallback=None, flow=FLOW, contact=CONTACT, tightening=Tightening(iterations=0))
"""The flow, barriers and gradient descent of the program; with its lengths, results depend on the drawing's units."""

AUGMENTED_2022_REPAIRED = replace(
    AUGMENTED_2022,
    flow=replace(FLOW, exact_parity=True),
    contact=replace(
        CONTACT, solver=GradientDescent(refuse_infinite=True), repairs=Repairs(parity=True, exact_home=True)
    ),
)
"""The same with fixes, without which the fine mesh never fully returns: exact tests, finite energies, exact return."""


@dataclass(frozen=True, eq=False)
class ProgramResult:
    """Where the program ends."""

    cage: Mesh
    """Not certified: `verify` says whether it encloses the fine mesh."""
    returned: FloatArray
    """(n, 2) the fine mesh at the end."""
    short: float
    """Largest distance of a fine vertex from its position, in units of the input."""
    flow_steps: FloatArray
    """(J + 1, n, 2) the fine mesh after each step of the flow."""
    seconds: tuple[float, float]
    """CPU seconds of flow and reinflation."""


def as_published(fine: Mesh, coarse: Mesh) -> ProgramResult:
    """Flow and reinflation in units of the input, with absolute lengths, as the program runs.

    Parameters
    ----------
    fine : Mesh
        The drawing.
    coarse : Mesh
        The cage to start from.

    Returns
    -------
    ProgramResult
        The last cage, which is not certified.

    Raises
    ------
    FlowError
        After 100 steps of the flow, where the program goes on from an infinite energy.
    """
    began = time.process_time()
    steps = FLOW.run(fine, coarse).steps
    flowed = time.process_time()
    bodies, x = Bodies.of(coarse, fine), np.concatenate([coarse.vertices, steps[-1]])
    if len(steps) > 1:
        x = CONTACT.reinflate(bodies, x, list(steps[-2::-1]), clearance=0.0).x
    seconds = flowed - began, time.process_time() - flowed
    returned = x[bodies.m :]
    short = float(np.hypot(*(returned - fine.vertices).T).max())
    return ProgramResult(coarse.moved(x[: bodies.m]), returned, short, steps, seconds)
