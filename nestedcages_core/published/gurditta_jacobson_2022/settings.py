"""The paper's method as settings: one definition for the add-on's preset, the benchmarks and scripts.

They have no fallback and no tightening.
"""

from dataclasses import replace

from ...hierarchy import Settings
from ...tightening import Tightening
from .contact import PROGRAM_RANGE, PaperContact, Repairs
from .flow import PROGRAM_STEP, PaperFlow
from .gradient_descent import GradientDescent

PROGRAM_FLOW, PROGRAM_CONTACT = (
    PaperFlow(step=PROGRAM_STEP, absolute=True),
    PaperContact(d_hat=PROGRAM_RANGE, absolute=True),
)
"""The parts of the program, with its absolute lengths."""

AUGMENTED_2022 = Settings(
    fallback=None,
    flow=PROGRAM_FLOW,
    contact=PROGRAM_CONTACT,
    tightening=Tightening(iterations=0),
)
"""Gurditta & Jacobson (2022) as written: its program's flow, barriers and gradient descent, with the program's absolute
lengths, so that the result depends on the units of the drawing."""

AUGMENTED_2022_REPAIRED = replace(
    AUGMENTED_2022,
    flow=replace(PROGRAM_FLOW, exact_parity=True),
    contact=replace(
        PROGRAM_CONTACT, solver=GradientDescent(refuse_infinite=True),
        repairs=Repairs(parity=True, exact_home=True),
    ),
)  # fmt: skip
"""The same with fixes of its program, without which the fine mesh never fully returns: exact tests, finite energies and
exact return. Lengths stay those of the program."""
