"""Augmenting Nested Cages with IPC (Gurditta & Jacobson 2022) as written, with its repairs one at a time."""

from __future__ import annotations

from .contact import PaperContact, Repairs
from .flow import PaperFlow
from .gradient_descent import GradientDescent
from .potential import PaperWeights
from .signed_distance_flow import SignedDistanceFlow

__all__ = ["GradientDescent", "PaperContact", "PaperFlow", "PaperWeights", "Repairs", "SignedDistanceFlow"]
