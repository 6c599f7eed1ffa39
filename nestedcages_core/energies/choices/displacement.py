"""Displacement of the cage from the coarse mesh, or from the previous step (Sacht et al. 2015, section 4.3)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...geometry.arrays import FloatArray
from ...geometry.mesh import Mesh
from ..springs import Springs


@dataclass(frozen=True)
class InitialDisplacement:
    """½ Σ w |c - c₀|² / L from the coarse mesh c₀; w: boundary length of a vertex, L: mean coarse edge length.

    At a displacement of L the force per boundary length equals the pressure of the area.
    """

    def at(self, coarse: Mesh) -> Springs:
        """The displacement from the coarse mesh."""
        return Springs(np.arange(len(coarse.vertices)), coarse.vertices, _weights(coarse))


@dataclass(frozen=True)
class StepDisplacement:
    """½ Σ w |c - c₀|² / L from the cage c₀ at the start of the step: the cage moves no more than it must."""

    def at(self, coarse: Mesh) -> FollowingSprings:
        """The displacement from the coarse mesh, until a step starts elsewhere."""
        return FollowingSprings(np.arange(len(coarse.vertices)), coarse.vertices, _weights(coarse))


class FollowingSprings(Springs):
    """Springs to where the vertices are at the start of each step."""

    def after(self, cage: FloatArray) -> FollowingSprings:
        """The displacement from the start of the next step."""
        return replace(self, place=cage)


def _weights(coarse: Mesh) -> FloatArray:
    """(m,) boundary length of each vertex over the mean edge length."""
    lengths = coarse.edge_lengths
    weights: FloatArray = 0.5 * (lengths + lengths[coarse.predecessor]) / float(lengths.mean())
    return weights
