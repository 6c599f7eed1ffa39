"""The axis of a mirror that a mesh has, vertex by vertex: cheap enough to look for in every drawing."""

from __future__ import annotations

import numpy as np

from .all_pairs import nearest
from .arrays import FloatArray
from .mesh import Mesh
from .precision import NEGLIGIBLE, ROUND_OFF
from .vectors import norm

MAX_TRIED = 4
"""Number of axes that are tried."""


def mirror_axis(mesh: Mesh) -> tuple[FloatArray, FloatArray] | None:
    """A point (2,) and a direction (2,) of an axis; None where there is none.

    The distances of the vertices of the largest loop from its centre read the same backwards from some vertex on: then
    their circular convolution with themselves is the sum of their squares.
    """
    loop = mesh.loops[int(np.abs(mesh.loop_areas).argmax())]
    points = mesh.vertices[loop]
    centre = points.mean(axis=0)
    away = norm(points - centre)
    spectrum = np.fft.rfft(away)
    sums, whole = np.fft.irfft(spectrum * spectrum, len(away)), float(away @ away)
    tolerance = NEGLIGIBLE * mesh.diagonal
    for total in np.argsort(-sums)[:MAX_TRIED].tolist():
        if sums[total] < (1.0 - ROUND_OFF) * whole:
            return None
        partner = points[(total - np.arange(len(points))) % len(points)]
        across = partner - points
        longest = across[norm(across).argmax()]
        direction = np.array([-longest[1], longest[0]]) / np.hypot(*longest)
        middle = 0.5 * (points + partner) - centre
        if np.abs(middle @ longest).max() > tolerance * np.hypot(*longest):
            continue
        if np.abs(across @ direction).max() <= tolerance and _maps(mesh, centre, direction, tolerance):
            return centre, direction
    return None


def _maps(mesh: Mesh, point: FloatArray, direction: FloatArray, tolerance: float) -> bool:
    """Whether the images of all vertices are vertices."""
    if len(mesh.loops) == 1:
        return True
    off = mesh.vertices - point
    image = point + 2.0 * (off @ direction)[:, None] * direction - off
    distance, _ = nearest(image, mesh.vertices)
    return bool((distance <= tolerance).all())
