"""Augmenting Nested Cages with IPC (Gurditta & Jacobson 2022) as published, with repairs one at a time.

Section 3.1: the flow (Algorithms 1 and 2). Section 3.2: reinflation, its energy and its gradient descent. Further work
that the paper names is in `benchmarks/paper`.
"""

from .contact import PaperContact, Repairs
from .flow import PaperFlow
from .gradient_descent import GradientDescent
from .potential import PaperPotential, PaperWeights
from .program import AUGMENTED_2022, AUGMENTED_2022_REPAIRED, ProgramResult, as_published

__all__ = [  # noqa: RUF022 - in the order of the paper
    "PaperFlow",  # section 3.1
    "PaperContact",  # section 3.2: the loop over the steps of the flow
    "PaperPotential",  # its energy
    "PaperWeights",  # the weights of its terms
    "GradientDescent",  # its solver
    "Repairs",  # fixes of its program
    "AUGMENTED_2022",  # all of it as settings
    "AUGMENTED_2022_REPAIRED",  # with the fixes
    "as_published",  # its program as a whole, from meshes to its last cage
    "ProgramResult",
]
