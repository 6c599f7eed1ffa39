"""How likely a part hangs on another one, and how likely it is the root: a weighted sum of the evidence.

Weights are logarithms of odds per unit, fitted to the characters of `benchmarks/cast` whose parents are known
(`python benchmarks/run.py puppet_weights`): a part chooses among those that it meets, as in multinomial logistic
regression.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...geometry.arrays import FloatArray
from ...libraries import load_shapely
from ..part import NEEDED_FOR, PuppetPart
from .evidence import Evidence

ROOT_WEIGHTS = {
    "area": 1.98,
    "radius": 0.22,
    "meets": -2.21,
    "hidden": 2.39,
    "off_centre": -4.58,
    "within": 0.46,
    "limbs": 1.14,
    "between": 1.45,
    "names": 3.14,
}
"""Of the columns of `Evidence.of_roots`."""

LINK_WEIGHTS = {
    "touches": -1.19,
    "share": 1.82,
    "holds_parent": -1.08,
    "smaller": 0.89,
    "larger_than_detail": -0.73,
    "snug": 1.23,
    "at_side": 0.54,
    "at_parent_end": 0.33,
    "chain": 0.27,
    "detail_above": 0.08,
    "layers_below_detail": -1.51,
    "layers": -0.56,
    "thicker": 0.74,
    "thicker_than_detail": 1.11,
    "through_between": -1.68,
    "through": -1.26,
    "hidden": -0.75,
    "alike": -0.91,
    "inward": 0.79,
    "way": 1.61,
    "on_root": 1.02,
    "names": 2.91,
    "names_of_others": -0.71,
    "names_reversed": -1.75,
    "held": 2.59,
    "name_extends": 2.16,
    "name_follows": -0.34,
    "labels": 1.02,
    "labels_of_others": -1.71,
    "group": 1.6,
}
"""Of the columns of `Evidence.of_links`."""

UNCONNECTED = -40.0
"""Logarithm of the odds of parts that do not meet, less their distance in diagonals of the drawing."""


def weighed(columns: Mapping[str, FloatArray], weights: Mapping[str, float]) -> FloatArray:
    """The weighted sum of some columns."""
    return np.asarray(sum(weight * columns[name] for name, weight in weights.items()))


class Scores:
    """Logarithms of probabilities."""

    def __init__(self, parts: Sequence[PuppetPart]) -> None:
        self.evidence = Evidence(parts)
        self.of_root = _normalised(weighed(self.evidence.of_roots(), ROOT_WEIGHTS)[None])[0]
        """(n,) that a part is the root."""
        shapely = load_shapely(NEEDED_FOR)
        solids = np.array([part.solid for part in parts])
        self._apart = UNCONNECTED - shapely.distance(solids[:, None], solids[None]) / self.evidence.size

    def of_links(self, root: int) -> FloatArray:
        """(n, n) that a part hangs on another one, if one is the root; rows are children."""
        odds = self._apart.copy()
        if self.evidence.pairs:
            odds[tuple(np.array(self.evidence.pairs).T)] = weighed(self.evidence.of_links(root), LINK_WEIGHTS)
        np.fill_diagonal(odds, 2.0 * UNCONNECTED)  # allowed only where there is no other part
        return _normalised(odds)


def _normalised(odds: FloatArray) -> FloatArray:
    """Odds less the logarithm of the sum of their exponentials, row by row."""
    most = odds.max(axis=1, keepdims=True)
    return np.asarray(odds - most - np.log(np.exp(odds - most).sum(axis=1, keepdims=True)))
