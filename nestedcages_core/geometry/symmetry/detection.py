"""Finding a symmetry: mirrors through the centre of a shape first, then rotations around it."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from ...parameters import check_positive
from ..arrays import FloatArray
from ..group import HAND_DRAWN, Symmetry, rounded
from ..mesh import Mesh
from ..precision import MOST_ROUNDS, ROUND_OFF
from .maps import Mirror, Rotation

SAMPLES = 400
"""Minimum number of points along the outline whose images are compared with it."""

ANGLES = 90
"""Number of directions of mirrors that are tried: 2° apart."""

MAX_FITTED = 6
"""Number of best directions that are fitted."""

HIGHEST_ORDER = 12
"""Highest order of rotations that is tried."""


AS_GOOD = 1.05
"""Factor on the difference up to which a vertical or horizontal mirror is preferred to a fitted one."""


@dataclass(frozen=True)
class DetectSymmetry:
    """The symmetry of the drawing, found automatically: a mirror if there is one, else rotations of the highest
    order."""

    tolerance: float = HAND_DRAWN
    """Largest distance between the outline and its image, as a fraction of the diagonal: hand drawings are only nearly
    symmetric."""

    def __post_init__(self) -> None:
        check_positive(self, "tolerance")

    def of(self, mesh: Mesh) -> tuple[Symmetry | None, float]:
        """The symmetry of a mesh, and the largest distance between outline and image; None if none is good enough."""
        search = _SymmetrySearch(mesh)
        limit = self.tolerance * mesh.diagonal
        for found, difference in (search.mirror(limit), search.rotation(limit)):
            if found is not None:
                return found, difference
        return None, float("inf")


class _SymmetrySearch:
    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        self.edges = mesh.edge_search
        spacing = float(mesh.edge_lengths.sum()) / SAMPLES
        pieces = np.maximum(1, np.ceil(mesh.edge_lengths / spacing)).astype(np.int64)
        begin = np.cumsum(pieces) - pieces
        share = (np.arange(pieces.sum()) - np.repeat(begin, pieces)) / np.repeat(pieces, pieces)
        start = np.repeat(mesh.vertices, pieces, axis=0)
        self.points: FloatArray = start + share[:, None] * (np.repeat(mesh.edge_ends, pieces, axis=0) - start)
        weight = np.repeat(mesh.edge_lengths / pieces, pieces)
        self.centre: FloatArray = weight @ self.points / weight.sum()
        self.few = self.points[:: max(1, len(self.points) // SAMPLES)]
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        self.middle = rounded(0.5 * (low + high), mesh.diagonal)

    def difference(self, symmetry: Symmetry) -> float:
        """Largest distance between the outline and its image."""
        return float(self.edges.closest(symmetry.image(self.points)).distance.max())

    def mirror(self, limit: float) -> tuple[Mirror | None, float]:
        """The mirror with the smallest difference, if that is within the limit."""
        exact = [
            Mirror((float(self.middle[0]), float(self.centre[1])), (0.0, 1.0)),
            Mirror((float(self.centre[0]), float(self.middle[1])), (1.0, 0.0)),
        ]
        differences = [self.difference(mirror) for mirror in exact]
        if min(differences) <= ROUND_OFF * self.mesh.diagonal:
            best = int(np.argmin([d > ROUND_OFF * self.mesh.diagonal for d in differences]))
            return exact[best], differences[best]
        turns = pi * np.arange(ANGLES) / ANGLES
        means = np.array([self._mean(self._at(turn)) for turn in turns])
        minima = (means <= np.roll(means, 1)) & (means <= np.roll(means, -1))
        chosen = np.flatnonzero(minima)[np.argsort(means[minima])][:MAX_FITTED]
        found = [self._fitted(self._at(float(turns[k]))) for k in chosen]
        rated = [(self.difference(mirror), mirror) for mirror in found]
        difference, mirror = min(rated, key=lambda pair: pair[0])
        for candidate, off in zip(exact, differences, strict=True):
            if off <= AS_GOOD * difference:
                difference, mirror = off, candidate
                break
        return (mirror, difference) if difference <= limit else (None, difference)

    def rotation(self, limit: float) -> tuple[Rotation | None, float]:
        """Rotations of the highest order within the limit."""
        for order in range(HIGHEST_ORDER, 1, -1):
            turned = Rotation((float(self.centre[0]), float(self.centre[1])), order)
            difference = self.difference(turned)
            if difference <= limit:
                return turned, difference
        return None, float("inf")

    def _at(self, turn: float) -> Mirror:
        return Mirror((float(self.centre[0]), float(self.centre[1])), (cos(turn), sin(turn)))

    def _mean(self, mirror: Mirror) -> float:
        return float(self.edges.closest(mirror.image(self.few)).distance.mean())

    def _fitted(self, mirror: Mirror) -> Mirror:
        """The mirror that takes points closest to the points of the outline which are closest to their images."""
        best, least = mirror, self._mean(mirror)
        for _ in range(MOST_ROUNDS):
            target = self.edges.nearest(mirror.image(self.few))
            a, b = self.few - self.few.mean(axis=0), target - target.mean(axis=0)
            # maximise Σ b · M a over mirrors M = (c s; s -c)
            turn = 0.5 * np.arctan2(
                (b[:, 1] * a[:, 0] + b[:, 0] * a[:, 1]).sum(), (b[:, 0] * a[:, 0] - b[:, 1] * a[:, 1]).sum()
            )
            middle = 0.5 * (self.few.mean(axis=0) + target.mean(axis=0))
            mirror = Mirror((float(middle[0]), float(middle[1])), (cos(turn), sin(turn)))
            mean = self._mean(mirror)
            if mean >= least:
                break
            best, least = mirror, mean
        return best
