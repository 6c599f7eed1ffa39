"""The energy of Gurditta & Jacobson (2022) with what they name as further work: steps that end before the first impact,
and pairs in a list that is rebuilt when something has moved far.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from nestedcages_core import PaperContact
from nestedcages_core.contact.ccd import largest_safe_step
from nestedcages_core.contact.pairs import Bodies, CandidateList, Pairs
from nestedcages_core.published import PaperPotential


class FilteredPotential(PaperPotential):
    """The energy; no step is longer than to the first impact."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self.candidates = CandidateList(self.bodies)

    def near(self, x: np.ndarray, motion: float = 0.0) -> Pairs:
        return self.candidates.within(x, self.d_hat + 2.0 * motion, self.d_hat)

    def largest_step(self, x: np.ndarray, direction: np.ndarray) -> float:
        pairs = self.near(x, float(np.hypot(*direction.T).max()))
        return largest_safe_step(pairs, x, direction, pairs.measure(x).distance)


@dataclass(frozen=True)
class ContactByNewton(PaperContact):
    """The paper's loop over the steps of the flow, for projected Newton."""

    def potential(self, bodies: Bodies, energy: Any) -> PaperPotential:
        return FilteredPotential(bodies, energy, self.weights, self.d_hat, exact=self.repairs.parity)
