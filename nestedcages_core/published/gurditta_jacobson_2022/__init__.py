"""Augmenting Nested Cages with IPC (Gurditta & Jacobson 2022) as published, with repairs one at a time.

Section 3.1: the flow (Algorithms 1 and 2). Section 3.2: reinflation, its energy and its gradient descent.
"""

from .contact import PROGRAM_RANGE, PaperContact, Repairs
from .flow import PROGRAM_STEP, PaperFlow
from .gradient_descent import GradientDescent
from .pair_search import AllPairs, UniformGrid
from .potential import PaperWeights
from .program import ProgramResult, as_published
from .quadrature import EvenSamples, GaussLegendre, Midpoint, QuadraticFallOff, RandomSamples
from .settings import AUGMENTED_2022, AUGMENTED_2022_REPAIRED
from .signed_distance_flow import SignedDistanceFlow
from .step_filter import NoFilter, SmallestDistance, TimeOfImpact

__all__ = [  # noqa: RUF022 - in the order of the paper
    "PaperFlow",  # section 3.1 as its program runs it, with parity tests
    "SignedDistanceFlow",  # section 3.1 with exact signs and a choice of quadratures
    "QuadraticFallOff",  # these: samples along the edges, and their weights (Algorithm 2)
    "Midpoint",
    "GaussLegendre",
    "EvenSamples",
    "RandomSamples",  # section 5
    "PaperContact",  # section 3.2: the loop over the steps of the flow
    "PaperWeights",  # its weights of the terms of the energy
    "GradientDescent",  # its solver
    "AllPairs",  # its search for pairs, or a faster one
    "UniformGrid",
    "NoFilter",  # its bound on steps, or others
    "SmallestDistance",
    "TimeOfImpact",
    "Repairs",  # fixes of its program
    "AUGMENTED_2022",  # all of it as settings
    "AUGMENTED_2022_REPAIRED",  # with the fixes
    "as_published",  # its program as a whole, from meshes to its last cage
    "ProgramResult",
    "PROGRAM_STEP",  # the absolute lengths of its program
    "PROGRAM_RANGE",
]
