"""Symmetric outlines: their orbits, and edges divided alike."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import NestingError
from ..geometry.arrays import FloatArray
from ..geometry.group import Symmetry
from ..geometry.loops import Loops
from ..geometry.vectors import norm

if TYPE_CHECKING:
    from ..geometry.group import Orbits

SYMMETRY_TOLERANCE = 1e-3
"""Distance between a vertex and the image of its partner, in diameters, up to which they count as symmetric. Offsets in
narrow gaps, where rounding decides what touches, may differ by their whole length."""


class AsymmetricError(NestingError):
    """An outline that is not symmetric."""


def approximate_orbits(outline: Loops, symmetry: Symmetry) -> Orbits:
    """The orbits of an outline. Raises AsymmetricError."""
    from ..geometry.group import Orbits  # most cages have no symmetry

    orbits = Orbits.of(outline.vertices, outline.successor, symmetry, SYMMETRY_TOLERANCE * outline.diameter)
    if orbits is None:
        raise AsymmetricError(
            f"No symmetric cage was found: where gaps are narrow, an offset of the outline does not have {symmetry}; "
            "leave out the symmetry, or widen the gaps.",
            code="symmetry.not_found",
        )
    return orbits


def symmetrised(outline: Loops, symmetry: Symmetry | None) -> Loops:
    """An outline that is symmetric up to a tolerance, made exactly symmetric. Raises AsymmetricError."""
    if symmetry is None:
        return outline
    return outline.moved(approximate_orbits(outline, symmetry).symmetrised(outline.vertices))


def padded_alike(outline: Loops, total: int, symmetry: Symmetry) -> list[FloatArray]:
    """The loops (k, 2) of a symmetric outline with edges divided evenly, images alike, up to `total` vertices.

    May have fewer vertices where edges come in orbits. Raises AsymmetricError.
    """
    successor = outline.successor
    steps = outline.vertices[successor] - outline.vertices
    _, orbit, sizes = np.unique(
        approximate_orbits(outline, symmetry).edge_orbit(successor), return_inverse=True, return_counts=True
    )
    lengths = np.zeros(len(sizes))
    lengths[orbit] = norm(steps)
    pieces, missing = np.ones(len(sizes), np.int64), total - len(outline.vertices)
    while (sizes <= missing).any():
        spacing = np.where((sizes <= missing) & ((sizes > 1) | (missing % symmetry.order > 0)), lengths / pieces, -1.0)
        chosen = int(np.argmax(spacing))
        if spacing[chosen] < 0.0:
            chosen = int(np.argmax(np.where(sizes <= missing, lengths / pieces, -1.0)))
        pieces[chosen] += 1
        missing -= int(sizes[chosen])
    of_edge = pieces[orbit]
    begin = np.cumsum(of_edge) - of_edge
    fraction = (np.arange(of_edge.sum()) - np.repeat(begin, of_edge)) / np.repeat(of_edge, of_edge)
    vertices = np.repeat(outline.vertices, of_edge, axis=0) + fraction[:, None] * np.repeat(steps, of_edge, axis=0)
    padded = Loops.of(vertices, np.add.reduceat(of_edge, outline.begins))
    return symmetrised(padded, symmetry).split()
