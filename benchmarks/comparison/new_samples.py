"""The flow with other sample points at every step, as Gurditta & Jacobson (2022) suggest in section 5."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nestedcages_core import FlowResult, Mesh, SignedDistanceFlow
from nestedcages_core.geometry.quadrature import EdgeRule
from nestedcages_core.tasks import Stage

SEED = 0


@dataclass(frozen=True)
class NewSamplesFlow:
    """The flow down the signed distance with new samples each time."""

    samples: int = 4
    """Per edge, one at random in each of so many equal parts."""

    def run(self, fine: Mesh, coarse: Mesh) -> Stage[float, FlowResult]:
        """As :class:`nestedcages_core.SignedDistanceFlow`; the same samples in every run."""
        return SignedDistanceFlow(quadrature=_NewSamples(self.samples)).run(fine, coarse)


class _NewSamples:
    """A rule that is another one every time it is asked for."""

    def __init__(self, samples: int) -> None:
        self.samples = samples
        self.random = np.random.default_rng(SEED)

    @property
    def rule(self) -> EdgeRule:
        """(Q,) t at random in each of Q parts of the edge, weighted by the hat function of the vertex."""
        parameters = (np.arange(self.samples) + self.random.random(self.samples)) / self.samples
        weights = 1.0 - parameters
        return EdgeRule(parameters, weights / weights.sum())
