"""The program of Gurditta & Jacobson 2022 from a fine and a coarse mesh to its last cage, uncertified.

`nested_cages` with the settings of this method ends with an error, since the fine mesh never quite returns. This is
the cage that the program shows all the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nestedcages_core import Mesh, PaperContact, PaperFlow
from nestedcages_core.contact.pairs import Bodies
from nestedcages_core.geometry.arrays import FloatArray
from nestedcages_core.published.gurditta_jacobson_2022 import PROGRAM_RANGE, PROGRAM_STEP
from nestedcages_core.tasks import drain


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


def as_published(
    fine: Mesh,
    coarse: Mesh,
) -> ProgramResult:
    """Flow and reinflation in units of the input, with absolute lengths, as the program runs.

    Raises: FlowError after 100 steps of the flow, where the program goes on from an infinite energy.
    """
    flow, contact = PaperFlow(step=PROGRAM_STEP, absolute=True), PaperContact(d_hat=PROGRAM_RANGE, absolute=True)
    steps = drain(flow.run(fine, coarse)).steps
    bodies, start = Bodies.of(coarse, fine), np.concatenate([coarse.vertices, steps[-1]])
    x = drain(contact.reinflate(bodies, start, list(steps[-2::-1]), clearance=0.0)).x if len(steps) > 1 else start
    cage, returned = x[: bodies.m], x[bodies.m :]
    short = float(np.hypot(*(returned - fine.vertices).T).max())
    return ProgramResult(coarse.moved(cage), returned, short, steps)
