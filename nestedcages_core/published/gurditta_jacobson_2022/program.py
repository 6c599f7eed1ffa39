"""The program of Gurditta & Jacobson 2022 as a whole: from a fine and a coarse mesh to its last cage, uncertified.

`nested_cages` with the settings of this method ends with an error, since the fine mesh never quite returns. This is
the cage that the program shows all the same.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from ...contact.pairs import Bodies
from ...geometry.arrays import FloatArray
from ...geometry.mesh import Mesh
from .settings import PROGRAM_CONTACT, PROGRAM_FLOW


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

    Raises: FlowError after 100 steps of the flow, where the program goes on from an infinite energy.
    """
    began = time.process_time()
    steps = PROGRAM_FLOW.run(fine, coarse).steps
    flowed = time.process_time()
    bodies, start = Bodies.of(coarse, fine), np.concatenate([coarse.vertices, steps[-1]])
    x = PROGRAM_CONTACT.reinflate(bodies, start, list(steps[-2::-1]), clearance=0.0).x if len(steps) > 1 else start
    ended = time.process_time()
    cage, returned = x[: bodies.m], x[bodies.m :]
    short = float(np.hypot(*(returned - fine.vertices).T).max())
    return ProgramResult(coarse.moved(cage), returned, short, steps, (flowed - began, ended - flowed))
