"""How likely a part hangs on another one, and how likely it is the root: a weighted sum of the evidence.

Weights are logarithms of odds per unit, fitted to the characters of `benchmarks/cast` whose parents are known
(`python benchmarks/cast_weights.py`): a part chooses among those that it meets, as in multinomial logistic regression.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..geometry.arrays import FloatArray
from ..libraries import load_shapely
from .evidence import Evidence
from .parts import NEEDED_FOR, PuppetPart

ROOT_WEIGHTS = {
    "area": 1.92,
    "radius": 0.19,
    "meets": -1.89,
    "hidden": 2.25,
    "off_centre": -5.01,
    "within": 0.19,
    "limbs": 1.12,
    "between": 1.46,
    "names": 2.31,
}
"""Of the columns of `Evidence.of_roots`."""

LINK_WEIGHTS = {
    "touches": -1.3,
    "share": 1.78,
    "holds_parent": -1.18,
    "smaller": 0.89,
    "larger_than_detail": -0.61,
    "snug": 1.26,
    "at_side": 0.52,
    "at_parent_end": 0.24,
    "chain": 0.4,
    "detail_above": 0.29,
    "layers_below_detail": -1.7,
    "layers": -0.68,
    "thicker": 0.74,
    "thicker_than_detail": 0.73,
    "through_between": -1.78,
    "through": -1.24,
    "hidden": -0.72,
    "alike": -0.79,
    "inward": 0.91,
    "way": 1.56,
    "on_root": 0.91,
    "names": 3.0,
    "names_of_others": -0.55,
    "names_reversed": -1.38,
    "held": 2.58,
    "name_extends": 2.25,
    "labels": 0.71,
    "labels_of_others": -1.32,
    "group": 1.42,
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
